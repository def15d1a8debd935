"""Prestress of shapes that `solve` found: their own rest lengths balance them, to a tolerance."""

import re

import numpy as np
import pytest

import cgff_cli

ALL = "xyz"
TWELVE = {
    "law": "hooke",
    "nodes": {
        **{"p": [0, 0, 0], "q": [1, 0, 0], "r": [1, 1, 0], "s": [0, 1, 0]},
        **{"A": [-1, 0, 0.5], "B": [2, 0, -0.5], "C": [-1, 1, -0.5], "D": [2, 1, 0.5]},
        **{"E": [0, -1, 0.5], "F": [1, -1, -0.5], "G": [0, 2, -0.5], "H": [1, 2, 0.5]},
    },
    "elements": {
        "net": {
            **{"kind": "cable", "EA": 1000, "rest_length": 0.98, "weight": 0.01},
            "pairs": ["pq", "qr", "rs", "sp", "Ap", "Bq", "Cs", "Dr", "Ep", "Fq", "Gs", "Hr"],
        }
    },
    "supports": dict.fromkeys("ABCDEFGH", ALL),
}
TWELVE["elements"]["net"]["pairs"] = [list(pair) for pair in TWELVE["elements"]["net"]["pairs"]]

SCENES = {
    "twelve cables": cgff_cli.from_dict(TWELVE),
    "heavy net": cgff_cli.new("net", side=8, weight=0.01),
    "net under snow": cgff_cli.new("net", side=10, snow=0.2),
    "heavy net under snow": cgff_cli.new("net", side=6, weight=0.01, snow=0.02),
}


def solved(scene, tolerance=1e-10):
    """Return the result, and the scene with its shape as the start."""
    result = cgff_cli.solve(scene, tolerance=tolerance)
    return result, scene.with_coordinates(result.coordinates)


def moved(scene, by):
    """Return a scene whose free nodes are off by up to `by` in every direction."""
    X = scene.coordinates + np.random.default_rng(1).uniform(-by, by, scene.coordinates.shape)
    held = list(scene.supports)
    X[held] = scene.coordinates[held]
    return scene.with_coordinates(X)


def out_of_balance(scene, forces):
    """Return the largest component of forces, loads and weight that add up at a free node, by a loop."""
    total = np.zeros(scene.coordinates.shape)
    for row, load in scene.loads.items():
        total[row] += load
    pairs = np.concatenate([group.pairs for group in scene.groups])
    lengths = np.concatenate([group.rest_length for group in scene.groups])
    weights = np.zeros(len(pairs)) if scene.weights is None else scene.weights * lengths
    for (i, j), force, weight in zip(pairs, forces, weights, strict=True):
        along = scene.coordinates[j] - scene.coordinates[i]
        pull = force * along / np.linalg.norm(along)
        total[i] += pull
        total[j] -= pull
        total[[i, j], 2] -= weight / 2.0
    free = [row for row in range(len(total)) if row not in scene.supports]
    return np.abs(total[free]).max()


@pytest.mark.parametrize("tolerance", [1e-10, 1e-14])
@pytest.mark.parametrize("name", SCENES)
def test_a_shape_that_solve_found_is_held_by_the_rest_lengths_that_found_it(name, tolerance):
    result, shape = solved(SCENES[name], tolerance)
    found = cgff_cli.prestress(shape)
    assert found.feasible, found.reason
    assert found.forces == pytest.approx(result.forces, rel=1e-4)
    assert out_of_balance(found.scene, found.forces) <= 1e-10 * np.abs(found.forces).max()
    assert found.scene.coordinates.tolist() == result.coordinates.tolist()
    again = cgff_cli.solve(found.scene)
    assert (again.counts["iterations"], again.verdict) == (0, "converged")


@pytest.mark.parametrize("name", [name for name in SCENES if name != "twelve cables"])
def test_the_force_that_it_has_can_be_asked_for_and_no_other(name):
    result, shape = solved(SCENES[name], 1e-14)
    group = shape.groups[0]
    force = float(np.abs(result.forces[: len(group.EA)]).max())
    assert cgff_cli.prestress(shape, force={group.name: force}).feasible
    found = cgff_cli.prestress(shape, force={group.name: 1.01 * force})
    assert found.feasible is False
    assert f"the greatest force in '{group.name}' is " in found.reason


def test_that_a_force_cannot_be_is_not_said_where_what_is_out_of_balance_may_forbid_it():
    result, exact = solved(SCENES["heavy net"], 1e-14)  # whose softest forces are known 1.6e7 times worse
    force = float(np.abs(result.forces[: len(exact.groups[0].EA)]).max())
    shape = moved(exact, 3e-11)
    assert cgff_cli.prestress(shape).feasible
    found = cgff_cli.prestress(shape, force={"along_x": force})
    assert found.feasible is None
    assert "`cgff solve --tolerance 1e-14` finds them to rounding" in found.reason


@pytest.mark.parametrize("name", ["heavy net", "net under snow"])
@pytest.mark.parametrize("options", [{}, {"force": {"along_x": 20.0}}])
def test_off_by_more_than_a_solve_leaves_it_is_undecided_and_the_tolerance_advised_decides(name, options):
    shape = moved(solved(SCENES[name], 1e-14)[1], 1e-9)
    found = cgff_cli.prestress(shape, **options)
    assert found.feasible is None
    advised = re.search("a tolerance of (.*) moves them to where it balances", found.reason)
    if not options:
        near = cgff_cli.prestress(shape, tolerance=float(advised[1]))
        assert near.feasible
        assert near.max_node_motion < 2e-9
        assert cgff_cli.solve(near.scene).counts["iterations"] == 0


def test_off_by_far_more_it_is_impossible_by_a_motion_against_which_loads_alone_do_work():
    shape = moved(solved(SCENES["net under snow"], 1e-14)[1], 1e-6)
    found = cgff_cli.prestress(shape)
    assert found.feasible is False
    v = np.array(list(found.certificate.values()))
    pairs = np.concatenate([group.pairs for group in shape.groups])
    along = shape.coordinates[pairs[:, 1]] - shape.coordinates[pairs[:, 0]]
    lengthened = ((v[pairs[:, 1]] - v[pairs[:, 0]]) * along).sum(axis=1) / np.linalg.norm(along, axis=1)
    work = sum(v[row] @ load for row, load in shape.loads.items())
    assert work < 0.0
    assert lengthened.min() > 1e-6 * work


def test_a_large_net_is_held_too(monkeypatch):
    monkeypatch.setattr("cgff_cli.mechanics.connectivity.DENSE_ENTRIES", 0)
    monkeypatch.setattr("cgff_cli.analysis.self_stress.DENSE", 0)
    for name in ("heavy net", "net under snow"):
        result, shape = solved(SCENES[name])
        found = cgff_cli.prestress(shape)
        assert found.feasible, found.reason
        assert found.rank_gap is None
        assert found.forces == pytest.approx(result.forces, rel=1e-4)
        assert cgff_cli.solve(found.scene).counts["iterations"] == 0
