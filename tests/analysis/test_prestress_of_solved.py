"""Prestress of shapes that a solve came to: what balances as a solve means it by default is held."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.scene import Scene
from tests.analysis.test_prestress import moved, wheel

CROSSED = """\
law: hooke
nodes:
  {p: [0, 0, 0], q: [1, 0, 0], r: [1, 1, 0], s: [0, 1, 0], A: [-1, 0, .5], B: [2, 0, -.5], C: [-1, 1, -.5],
   D: [2, 1, .5], E: [0, -1, .5], F: [1, -1, -.5], G: [0, 2, -.5], H: [1, 2, .5]}
elements:
  net: {kind: cable, EA: 1000, rest_length: 0.98, weight: 0.01, pairs: [[p, q], [q, r], [r, s], [s, p],
    [A, p], [B, q], [C, s], [D, r], [E, p], [F, q], [G, s], [H, r]]}
supports: {A: xyz, B: xyz, C: xyz, D: xyz, E: xyz, F: xyz, G: xyz, H: xyz}
"""
NETS = {
    "weight": {"side": 8, "weight": 0.01},
    "weight, larger": {"side": 12, "weight": 0.01},
    "snow": {"side": 12, "snow": 0.2},
    "light ropes": {"side": 7, "weight": 1e-4},
}


@cache
def solved(name: str, tolerance: float = 1e-10) -> Scene:
    """Return a scene at the shape that a solve came to, its own rest lengths forgotten by nobody."""
    scene = cgff_cli.loads(CROSSED) if name == "crossed" else cgff_cli.new("net", **NETS[name])
    result = cgff_cli.solve(scene, tolerance=tolerance)
    assert not result.slack.any()
    return scene.with_coordinates(result.coordinates)


@pytest.mark.parametrize("tolerance", [1e-10, 1e-14])
@pytest.mark.parametrize("name", ["crossed", *NETS])
def test_a_shape_that_a_solve_came_to_is_held(name: str, tolerance: float):
    found = cgff_cli.prestress(solved(name, tolerance))
    assert found.feasible, found.reason
    assert (found.forces > 0.0).all()
    again = cgff_cli.solve(found.scene)
    assert (again.verdict, again.counts["iterations"]) == ("converged", 0)
    assert again.forces == pytest.approx(found.forces, rel=1e-6)


def test_where_rounding_hides_the_answer_it_is_the_rest_lengths_that_hold_the_shape_with_a_word():
    scene = solved("light ropes")
    found = cgff_cli.prestress(scene)
    assert found.rest_lengths == pytest.approx(np.concatenate([group.rest_length for group in scene.groups]))
    assert any(said.startswith("the rest lengths are the scene's own") for said in found.warnings)
    lengths = np.concatenate([0.9 * group.rest_length for group in scene.groups])
    for other in (scene.with_rest_lengths(lengths), replace(scene, groups=without_rest_lengths(scene))):
        assert cgff_cli.prestress(other).feasible is None


def without_rest_lengths(scene: Scene):
    return tuple(replace(group, rest_length=np.full(len(group.EA), np.nan)) for group in scene.groups)


def test_what_one_answer_holds_no_other_denies():
    scene = solved("crossed")
    most = float(np.abs(cgff_cli.prestress(scene).forces).max())
    assert cgff_cli.prestress(scene, force={"net": most}).feasible
    denied = cgff_cli.prestress(scene, force={"net": 0.5 * most})
    assert denied.feasible is False
    assert f"the greatest force in 'net' is at least {most:.6g}, and no self-stress" in denied.reason


@pytest.mark.parametrize(("off", "held"), [(2e-11, True), (2e-10, True), (5e-10, None), (1e-9, None)])
def test_coordinates_off_by_more_than_a_solve_leaves_are_neither_held_nor_denied(
    off: float, held: bool | None
):
    found = cgff_cli.prestress(moved(wheel(3), off, 1))
    assert found.feasible is held
    if held:
        assert cgff_cli.solve(found.scene).residual["relative"] <= 1e-10
    else:
        assert "`cgff solve --tolerance 1e-14` finds them to rounding, or a tolerance of 1e-8" in found.reason
