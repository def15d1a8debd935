"""Adaptive force densities, and the double singular value decomposition, against closed forms."""

from math import pi, sin

import numpy as np
import pytest

import cgff_cli
from cgff_cli.rivals.afdm import _placed
from cgff_cli.study.record import Method
from tests.rivals.test_fdm import RIGHT, densities, in_two_groups
from tests.shapes import STRUCTURES

METHODS = ("afdm", "dsvd")


def found(scene: "cgff_cli.Scene", name: str) -> Method:
    return cgff_cli.compare(scene, [name], repeat=1).methods[1]


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("sides", [3, 4, 5, 8])
def test_an_n_prism_has_its_closed_form(name: str, sides: int):
    scene = cgff_cli.new("prism", sides=sides, noise=0.1, seed=1)
    method = found(scene, name)
    q = densities(scene, method)
    assert np.abs(q["sides"] - 0.5 / sin(pi / sides)).max() < RIGHT
    assert np.abs(q["verticals"] - 1.0).max() < RIGHT
    assert method.alignment == "affine"
    assert method.max_node_difference < RIGHT


@pytest.mark.parametrize("name", METHODS)
def test_the_octahedron_has_struts_of_minus_three_halves(name: str):
    scene = cgff_cli.load(STRUCTURES / "octahedron.yaml")
    q = densities(scene, found(scene, name))
    (cables,) = (own for group, own in q.items() if group != "struts")
    assert cables == pytest.approx(2.0 / 3.0, abs=RIGHT)


@pytest.mark.parametrize("name", METHODS)
def test_a_crossed_square_has_equal_and_opposite_force_densities(name: str):
    scene = in_two_groups(cgff_cli.load(STRUCTURES / "x-module.yaml"))
    method = found(scene, name)
    q = densities(scene, method)
    assert q["cable"] == pytest.approx(1.0, abs=RIGHT)
    assert method.verdict == "other_equilibrium"  # that of the scene's rest lengths has others


@pytest.mark.parametrize("name", METHODS)
def test_what_has_no_form_is_told_why(name: str):
    scene = cgff_cli.from_dict(
        {
            "law": "hooke",
            "nodes": {"a": [0, 0], "b": [1, 0], "c": [0.5, 1]},
            "elements": {
                "bars": {"kind": "cable", "EA": 1, "rest_length": 1, "pairs": [["a", "b"], ["b", "c"]]}
            },
        }
    )
    method = found(scene, name)
    assert method.verdict == "failed"
    assert "with one force density per group" in method.message


@pytest.mark.parametrize("name", METHODS)
def test_where_supports_hold_a_structure_schek_stands_for_it(name: str):
    found = cgff_cli.compare(cgff_cli.load(STRUCTURES / "cable-net.yaml"), [name], repeat=1)
    assert [method.name for method in found.methods] == ["cgff", "schek"]


def test_few_nodes_keep_their_places_and_the_others_follow():
    rng = np.random.default_rng(2)
    null, X = np.column_stack([np.ones(7), rng.normal(size=(7, 3))]), rng.normal(size=(7, 3))
    placed = _placed(null, X)
    kept = np.abs(placed - X).max(axis=1) < 1e-12
    assert kept.sum() == 4
    assert np.linalg.lstsq(null, placed, rcond=None)[1] == pytest.approx(0.0, abs=1e-20)
