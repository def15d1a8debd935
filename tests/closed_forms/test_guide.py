"""The guide scenes, mast, roof, spine and dome, against hand calculations and loops without matrices."""

from dataclasses import replace
from math import radians, sin
from pathlib import Path

import numpy as np
import pytest
from scipy.optimize import fsolve

import cgff_cli
from cgff_cli.cases import solve_cases
from cgff_cli.structure import from_scene
from tests.bodies import forces_by_loop
from tests.shapes import STRUCTURES

GUIDE = ("mast", "roof", "spine", "dome")


def load(name: str) -> "cgff_cli.Scene":
    return cgff_cli.load(STRUCTURES / f"{name}.yaml")


def by_case(name: str) -> dict[str, "cgff_cli.Result"]:
    """Return the results of all cases of a guide scene, and that without."""
    scene = load(name)
    return {own.source.case: own for own in solve_cases(scene, ["dead", *scene.cases])}


@pytest.mark.parametrize("name", GUIDE)
def test_a_guide_scene_stands_in_every_case_and_carries_all_its_loads(name: str):
    for result in by_case(name).values():
        assert result.converged
        assert result.analysis["stability"] == "stable"
        total = np.sum(list(result.loads.values()), axis=0) + np.sum(list(result.reactions.values()), axis=0)
        assert np.abs(total).max() < 1e-8 * result.residual["reference_force"]


@pytest.mark.parametrize("name", GUIDE)
def test_a_guide_scene_has_the_answer_that_another_program_finds(name: str):
    for result in by_case(name).values():
        s = result.structure
        assert (
            np.abs(forces_by_loop(s, result.coordinates)[s.free]).max()
            < 1e-8 * result.residual["reference_force"]
        )


def test_a_spine_solved_by_finite_differences_comes_to_rest_in_the_same_place():
    scene = load("spine")
    s, result = from_scene(scene), cgff_cli.solve(scene)

    def left_over(x: np.ndarray) -> np.ndarray:
        X = s.coordinates.copy()
        X[s.free] = x
        return forces_by_loop(s, X)[s.free]

    found, _, flag, _ = fsolve(left_over, s.coordinates[s.free], full_output=True, xtol=1e-12)
    assert flag == 1
    assert found == pytest.approx(result.coordinates[s.free], abs=1e-7)


def test_wind_moves_the_mast_as_far_as_its_ropes_let_it_by_hand():
    results = by_case("mast")
    stiffness = 1.5 * 24000.0 / 15.0 * (9.0 / 15.0) ** 2
    moved = results["wind"].nodes["top"][0] - results["dead"].nodes["top"][0]
    assert moved == pytest.approx(1.5 / stiffness, rel=2e-4)
    gained = results["wind"].forces[1] - results["dead"].forces[1]
    assert gained == pytest.approx(24000.0 / 15.0 * 0.6 * 1.5 / stiffness, rel=1e-3)
    assert results["wind_across"].nodes["top"][1] == pytest.approx(moved, rel=1e-3)


def test_the_mast_carries_its_ropes_and_half_of_all_weight_by_hand():
    dead = by_case("mast")["dead"]
    assert dead.forces[0] == pytest.approx(-37.014, abs=2e-3)
    assert dead.coordinates == pytest.approx(load("mast").coordinates, abs=1e-6)


def test_the_roof_is_in_balance_under_its_pretension_alone():
    scene = load("roof")
    bare = replace(scene, loads={}, groups=tuple(replace(own, weight=None) for own in scene.groups))
    result = cgff_cli.solve(bare)
    assert result.max_displacement < 1e-9
    assert result.groups["ties"]["force"] == pytest.approx([8.0, 8.0], rel=1e-7)
    horizontal = [abs(result.reactions[node][0]) for node in ("t0", "t10", "b0", "b10")]
    assert horizontal == pytest.approx([150.0, 150.0, 200.0, 200.0], rel=1e-9)


@pytest.mark.parametrize("case", ["dead", "snow", "wind", "uls_snow", "uls_wind"])
def test_half_of_the_roof_does_not_turn_about_its_middle(case: str):
    result = by_case("roof")[case]
    nodes, left = result.nodes, [f"{rope}{i}" for rope in "tb" for i in range(5)]
    pushes = [(name, own[name]) for own in (result.loads, result.reactions) for name in left if name in own]
    cut = [own for own in result.elements if (own["start"], own["end"]) in (("t4", "t5"), ("b4", "b5"))]
    for own in cut:
        along = np.subtract(nodes[own["end"]], nodes[own["start"]]) / own["length"]
        pushes.append((own["start"], along * own["force"]))
    turns = []
    for name, F in pushes:
        arm = np.subtract(nodes[name], nodes["t5"])
        turns.append(arm[0] * F[1] - arm[1] * F[0])
    assert sum(turns) == pytest.approx(0.0, abs=1e-9 * np.abs(turns).sum())


def test_the_spine_stands_on_its_weight_by_hand():
    up = sum(own[2] for own in by_case("spine")["dead"].reactions.values())
    assert up == pytest.approx(17.699, abs=1e-3)
    assert sum(own[2] for own in by_case("spine")["tool"].reactions.values()) == pytest.approx(
        19.299, abs=1e-3
    )


def test_the_dome_is_what_prestress_makes_of_its_geometry(tmp_path: Path):
    dome = load("dome")
    geometry = dome.with_rest_lengths(np.full(dome.element_count, np.nan))
    again = cgff_cli.prestress(geometry, by_group=True, force={"hoop_2": 250.0})
    own = np.concatenate([group.rest_length for group in dome.groups])
    assert again.rest_lengths == pytest.approx(own, rel=1e-12)


def test_the_dome_stands_as_drawn_and_its_hoop_presses_as_by_hand():
    dead = by_case("dome")["dead"]
    assert dead.counts["iterations"] == 0
    assert dead.groups["hoop_2"]["force"] == pytest.approx([250.0, 250.0], rel=1e-9)
    rows = [row for row, own in enumerate(dead.elements) if own["group"] == "diagonals_2"]
    own = dead.elements[rows[0]]
    run = np.linalg.norm(np.subtract(dead.nodes[own["end"]], dead.nodes[own["start"]])[:2])
    assert own["force"] * run / own["length"] == pytest.approx(2.0 * 250.0 * sin(radians(22.5)), rel=1e-9)
