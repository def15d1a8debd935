"""What a unit of rest length does: against closed forms, and differences of two solves."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest

import cgff_cli
from cgff_cli.mechanics import connectivity
from cgff_cli.scene.select import chosen_rows
from tests.analysis.scenes import CORNERS
from tests.bodies import scene
from tests.shapes import aligned
from tests.solvers.scenes import shipped, truss

STEP = 1e-4
ONE = " (one element is written A,B, by its nodes)"


def by_differences(body, of, at):
    """Return motions and changes of forces per unit, from solves with rest lengths a step more and less."""
    rest = np.concatenate([group.rest_length for group in body.groups])
    ends = []
    for step in (STEP, -STEP):
        changed = rest.copy()
        changed[chosen_rows(body, of)] += step
        near = replace(body.with_rest_lengths(changed), coordinates=at)
        ends.append(cgff_cli.solve(near, tolerance=1e-13, analysis="never"))
    X = [end.coordinates if body.supports else aligned(end.coordinates, at) for end in ends]
    return (X[0] - X[1]) / (2.0 * STEP), (ends[0].forces - ends[1].forces) / (2.0 * STEP)


CASES = [
    ("prism", "verticals"),
    ("prism", "n1,n4"),
    ("octahedron", "struts"),
    ("bracket", "tie"),
    ("cable-net", "hog_middle"),
    ("x-module", "n3,n1"),
    ("hexagon", "struts"),
    ("tower", "end_rings"),
    ("net", "along_x"),
    ("catenary", "links"),
]


@pytest.mark.parametrize("sparse", [False, True])
@pytest.mark.parametrize(("name", "of"), CASES)
def test_it_is_the_limit_of_differences_of_solves(name, of, sparse, monkeypatch):
    families = {"tower": {"stages": 3, "law": "hooke"}, "net": {"side": 5}, "catenary": {"links": 10}}
    body = cgff_cli.new(name, **families[name]) if name in families else shipped(name)
    if sparse:
        monkeypatch.setattr(connectivity, "DENSE_ENTRIES", 0)
    result = cgff_cli.solve(body, tolerance=1e-13, analysis="never")
    found = result.sensitivity(of)
    moves, changes = by_differences(body, of, result.coordinates)
    assert found.reason == ""
    assert found.coordinates == pytest.approx(moves, abs=2e-6 * np.abs(moves).max())
    assert found.forces == pytest.approx(changes, abs=2e-6 * np.abs(changes).max())


def test_a_top_rises_as_its_struts_grow_without_a_load():
    # Height sqrt(l0^2 - 1) of the von Mises truss: dh / dl0 = l0 / h, and no force.
    result = cgff_cli.solve(truss(0.6), tolerance=1e-13)
    both = [result.sensitivity(of) for of in ("e0", "e1")]
    assert sum(own.coordinates[2] for own in both) == pytest.approx([0.0, 1.2 / sqrt(0.44)])
    assert both[0].forces == pytest.approx([0.0, 0.0], abs=1e-9)


def test_a_bar_between_walls_only_changes_its_force():
    bar = scene(CORNERS[:2], [(0, 1, "strut", 10.0, 2.0)], {0: "xy", 1: "xy"}, law="hooke")
    found = cgff_cli.solve(bar).sensitivity("n0,n1")
    assert not found.coordinates.any()
    assert found.forces == pytest.approx([-10.0 / 2.0])  # t = EA (l - l0) / l0


def test_sparse_factors_tell_of_a_slender_tower_what_dense_ones_do(monkeypatch):
    tower = cgff_cli.new("tower", stages=20)
    result = cgff_cli.solve(tower, tolerance=1e-13, analysis="never")
    dense = result.sensitivity("n3_1,n4_1")
    monkeypatch.setattr(connectivity, "DENSE_ENTRIES", 0)
    sparse = cgff_cli.analyse(replace(tower, coordinates=result.coordinates)).given.sensitivity("n3_1,n4_1")
    assert sparse.forces == pytest.approx(dense.forces, abs=1e-9 * np.abs(dense.forces).max())
    size = np.abs(dense.coordinates).max()
    assert sparse.coordinates == pytest.approx(dense.coordinates, abs=1e-8 * size)


@pytest.mark.parametrize("sparse", [False, True])
def test_a_stiff_bar_beside_costs_a_soft_spring_no_digits(sparse, monkeypatch):
    if sparse:
        monkeypatch.setattr(connectivity, "DENSE_ENTRIES", 0)
    points = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.0, 1.0), (1.0, 1.0)]
    springs = [(0, 1, "strut", 1e-6, 1.0), (1, 2, "strut", 1e-6, 1.0), (3, 4, "strut", 1e3, 1.0)]
    found = cgff_cli.analyse(scene(points, springs, {0: "xy", 1: "y", 2: "xy", 3: "xy", 4: "y"}))
    own = found.given.sensitivity("e0")
    assert own.coordinates[1] == pytest.approx([0.5, 0.0], rel=1e-9)
    assert own.forces == pytest.approx([-5e-7, -5e-7, 0.0], rel=1e-9)


@pytest.mark.parametrize("sparse", [False, True])
def test_a_node_moves_only_where_it_is_free(sparse, monkeypatch):
    if sparse:
        monkeypatch.setattr(connectivity, "DENSE_ENTRIES", 0)
    # A strut from a pin to a node that slides upright at x = 1: h^2 = l0^2 - 1, no force.
    strut = scene([(0.0, 0.0), (1.0, 1.0)], [(0, 1, "strut", 10.0, sqrt(2.0))], {0: "xy", 1: "x"})
    found = cgff_cli.solve(strut, tolerance=1e-13).sensitivity("e0")
    assert found.coordinates == pytest.approx(np.array([[0.0, 0.0], [0.0, sqrt(2.0)]]))


def test_a_slack_cable_does_nothing_and_one_about_to_be_is_not_told():
    slack = scene([(0.0, 0.0), (0.5, 0.0)], [(0, 1, "cable", 1.0, 1.0)], {0: "xy", 1: "xy"})
    assert not cgff_cli.solve(slack).sensitivity("e0").forces.any()
    brink = scene([(0.0, 0.0), (1.0, 0.0)], [(0, 1, "cable", 1.0, 1.0)], {0: "xy", 1: "xy"})
    found = cgff_cli.solve(brink).sensitivity("e0")
    assert (found.coordinates, found.forces) == (None, None)
    assert "going slack" in found.reason


@pytest.mark.parametrize("nearly", [0.0, 1.6e-12])
@pytest.mark.parametrize("sparse", [False, True])
def test_what_drives_a_motion_without_stiffness_is_not_told_and_what_does_not_is(sparse, nearly, monkeypatch):
    if sparse:
        monkeypatch.setattr(connectivity, "DENSE_ENTRIES", 0)
    # Half an arch, 2 wide and 1 high, about to snap: (k - q) high^2 + q l^2 = 0; and a bar beside it.
    k, q, length = 100.0, -25.0 + nearly, sqrt(5.0)
    points = [(-2.0, 0.0), (0.0, 1.0), (3.0, 0.0), (4.0, 0.0)]
    bars = [(0, 1, "strut", k, length * (1.0 - q / k)), (2, 3, "strut", k, 1.0)]
    half = scene(points, bars, {0: "xy", 1: "x", 2: "xy", 3: "y"}, {1: (0.0, 2.0 * q * 0.5)})
    found = cgff_cli.analyse(half, sensitivity=["e0", "e1"])
    assert (found.balanced, found.analysis["stability"]) == (True, "neutral")
    assert found.sensitivity["e0"].coordinates is None
    assert found.sensitivity["e0"].reason.startswith("not told: it drives a motion")
    assert found.sensitivity["e1"].coordinates[3] == pytest.approx([1.0, 0.0])
    assert found.analysis["critical_load_factor"] is None


def test_there_is_none_without_an_equilibrium():
    found = cgff_cli.solve(shipped("prism"), max_iterations=1).sensitivity("struts")
    assert (found.coordinates, found.forces) == (None, None)
    assert found.reason.startswith("no equilibrium")


@pytest.mark.parametrize(
    ("of", "message"),
    [
        (
            "strut",
            f"no group is named 'strut'{ONE}; did you mean 'struts'?",
        ),
        ("n1,n77", "no node is named 'n77'"),
        ("n1,n5", "no element joins 'n1' and 'n5'"),
        (
            "",
            f"no group is named ''{ONE}; there are triangles, verticals, struts",
        ),
    ],
)
def test_what_is_no_element_is_refused(of, message):
    with pytest.raises(cgff_cli.OptionError) as refused:
        chosen_rows(shipped("prism"), of)
    assert str(refused.value) == message


def test_two_elements_between_two_nodes_are_refused_and_a_comma_may_be_part_of_a_name():
    twice = cgff_cli.from_dict(
        {
            "law": "paper",
            "nodes": {"a,b": [0, 0], "c": [1, 0], "d": [0, 1]},
            "elements": {
                "x,y": {"kind": "strut", "EA": 1, "rest_length": 1, "pairs": [["a,b", "c"], ["c", "a,b"]]},
                "z": {"kind": "strut", "EA": 1, "rest_length": 1, "pairs": [["d", "a,b"]]},
            },
        }
    )
    assert chosen_rows(twice, "x,y").tolist() == [0, 1]
    assert chosen_rows(twice, "a,b,d").tolist() == [2]
    with pytest.raises(cgff_cli.OptionError, match="2 elements join 'c' and 'a,b'"):
        chosen_rows(twice, "c, a,b")
