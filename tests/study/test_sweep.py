"""A sweep: rows that stand for solves, in the order of the grid, whatever the chunks."""

import pickle
from collections.abc import Callable
from dataclasses import replace
from math import sqrt

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.scene import Scene
from cgff_cli.structure import from_scene
from cgff_cli.study.axes import KEYS
from cgff_cli.study.rows import sweep
from cgff_cli.study.sweep import BAD_SCENE, Sweep, planned
from tests.shapes import STRUCTURES

PAIR = """\
law: hooke
nodes: {a: [0, 0], b: [1, 0], "c.d": [2, 0]}
elements:
  left: {kind: cable, EA: 10, rest_length: 1, pairs: [[a, b]]}
  right.one: {kind: cable, EA: 10, rest_length: [1], pairs: [[b, c.d]]}
supports: {a: xy, c.d: xy}
loads: {b: [0, -1]}
"""
ONE = " (one element is written A,B, by its nodes)"
ALL = ("force:left", "length:a,b", "node:b", "slack", "max_strain", "height")


@pytest.fixture
def pair() -> Scene:
    """Give two cables in a line between supports, with a load in the middle."""
    return cgff_cli.loads(PAIR)


@pytest.fixture
def prism() -> Scene:
    """Give the prism of Table IV."""
    return cgff_cli.load(STRUCTURES / "prism.yaml")


def column(name: str, plan: Sweep) -> list[object]:
    return plan.solved(plan.span(0, plan.rows)).columns[name]


def test_a_grid_has_all_combinations_the_last_key_fastest(pair: Scene):
    plan = planned(pair, set={"left.EA": "1:3:3", "loads.b.y": [-1.0, -2.0]})
    assert plan.values(0, 6).tolist() == [[1, -1], [1, -2], [2, -1], [2, -2], [3, -1], [3, -2]]


def test_zipped_values_stand_side_by_side(pair: Scene):
    plan = planned(pair, set={"left.EA": "log:1:100:3", "loads.b.y": "-1,-2,-3"}, zip=True)
    assert plan.values(0, 3).tolist() == [[1, -1], [10, -2], [100, -3]]


def test_random_values_lie_between_their_ends_or_among_their_numbers_and_belong_to_the_row(pair: Scene):
    asked = {"left.EA": "log:1:1e4", "loads.b.y": "-3:-1", "right.one.EA": "1,2,7"}
    plan = planned(pair, set=asked, random=4000, seed=5)
    found = plan.values(0, 4000)
    assert np.array_equal(found[1000:1700], plan.values(1000, 1700))
    EA, load, other = found.T
    assert np.histogram(np.log10(EA), [0, 1, 2, 3, 4])[0] == pytest.approx([1000] * 4, abs=120)
    assert np.histogram(load, [-3, -2, -1])[0] == pytest.approx([2000] * 2, abs=160)
    assert np.unique(other, return_counts=True)[1] == pytest.approx([1333] * 3, abs=160)
    assert not np.array_equal(found, planned(pair, set=asked, random=4000, seed=6).values(0, 4000))


def test_a_loaded_pair_of_cables_hangs_as_statics_says(pair: Scene):
    for row in sweep(pair, set={"loads.b.y": [-0.1, -1.0, -5.0]}, out=ALL):
        y = row["node:b.y"]
        l = sqrt(1.0 + y * y)
        assert row["converged"]
        assert 2.0 * 10.0 * (l - 1.0) * y / l == pytest.approx(row["loads.b.y"], rel=1e-8)
        assert row["length:a,b"] == pytest.approx(l)
        assert row["force:left.min"] == row["force:left.max"] == pytest.approx(10.0 * (l - 1.0))
        assert (row["slack"], row["max_strain"], row["height"]) == (0, pytest.approx(l - 1.0), -y)


@pytest.mark.parametrize(
    ("asked", "change"),
    [
        ({"set": {"struts.EA": [7.0, 700.0]}}, lambda own, value: {"EA": 0.0 * own.EA + value}),
        (
            {"scale": {"struts.rest_length": [0.9, 1.2]}},
            lambda own, value: {"rest_length": value * own.rest_length},
        ),
    ],
)
def test_every_row_is_the_solve_of_the_changed_scene(
    prism: Scene, asked: dict[str, object], change: Callable[..., dict[str, np.ndarray]]
):
    ((name, _),) = next(iter(asked.values())).items()
    words = ("force:struts", "length:n1,n4", "slack", "max_strain")
    for row in sweep(prism, out=words, **asked):
        groups = [
            replace(own, **change(own, row[name])) if own.name == "struts" else own for own in prism.groups
        ]
        alone = cgff_cli.solve(replace(prism, groups=tuple(groups)))
        assert row["stability"] == alone.analysis["stability"]
        assert row["energy"] == pytest.approx(alone.energy, rel=1e-9)
        least, greatest = alone.groups["struts"]["force"]
        assert (row["force:struts.min"], row["force:struts.max"]) == pytest.approx(
            (least, greatest), rel=1e-8
        )
        assert row["max_strain"] == pytest.approx(alone.max_strain, rel=1e-8)
        assert row["length:n1,n4"] == pytest.approx(
            np.linalg.norm(alone.coordinates[0] - alone.coordinates[3])
        )


@pytest.mark.parametrize(
    ("asked", "EA"),
    [
        ({"set": {"b,c.d.EA": "40"}}, [10.0, 40.0]),
        ({"set": {"left.EA": "20", "c.d,b.EA": "40"}}, [20.0, 40.0]),
        ({"scale": {"a,b.EA": "3", "left.EA": "2"}}, [60.0, 10.0]),
    ],
)
def test_one_element_is_named_by_its_nodes(pair: Scene, asked: dict[str, dict[str, str]], EA: list[float]):
    (row,) = sweep(pair, out=["node:b"], **asked)
    alone = cgff_cli.solve(pair.with_axial_stiffness(np.array(EA)))
    assert [row["node:b.x"], row["node:b.y"]] == pytest.approx(alone.nodes["b"], rel=1e-7)


def test_one_cable_of_a_group_is_an_actuator(prism: Scene):
    rest = from_scene(prism).rest_lengths.copy()
    rest[0] = 2.5  # the first of the triangles, n1-n2
    alone = cgff_cli.solve(prism.with_rest_lengths(rest))
    for follow in (False, True):
        (row,) = sweep(prism, set={"n1,n2.rest_length": "2.5"}, out=["force:triangles"], follow=follow)
        assert row["energy"] == pytest.approx(alone.energy, rel=1e-9)
        assert row["force:triangles.max"] == pytest.approx(alone.groups["triangles"]["force"][1], rel=1e-8)


def test_a_start_and_a_support_are_moved_where_a_coordinate_is_swept(pair: Scene):
    rows = list(sweep(pair, set={"nodes.c.d.x": [2.0, 2.2]}, out=["node:c.d", "force:left"]))
    assert [row["node:c.d.x"] for row in rows] == [2.0, 2.2]
    assert rows[1]["force:left.max"] > rows[0]["force:left.max"]


def test_rows_do_not_depend_on_their_chunks_or_on_processes(prism: Scene):
    plan = planned(prism, scale={"verticals.rest_length": "0.5:1.5:30"}, out=["node:n1"])
    whole = plan.solved(plan.span(0, 30)).columns
    halves = [plan.solved(plan.span(0, 11)).columns, plan.solved(plan.span(11, 30)).columns]
    assert whole == {name: halves[0][name] + halves[1][name] for name in whole}


def test_a_worker_is_handed_the_values_of_its_own_rows_alone(prism: Scene):
    plan = planned(prism, set={"struts.EA": "10:1000:100000"}, out=["height"])
    *_, last = chunks = list(plan.chunks(range(98000, 99500)))
    assert [len(pickle.dumps((plan.for_workers.solved, chunk))) < 30000 for chunk in chunks] == [True] * 2
    assert plan.for_workers.solved(last) == plan.solved(plan.span(99000, 99500))


def test_shards_are_whole_chunks_that_follow_each_other(pair: Scene):
    plan = planned(pair, set={"left.EA": "1:2:10500"})
    rows = [plan.rows_of((i, 4)) for i in range(1, 5)]
    assert [own.start % plan.at_once for own in rows] == [0] * 4
    assert [row for own in rows for row in own] == list(range(10500))
    assert [len(planned(pair, set={"left.EA": "1:2:3"}).rows_of((i, 2))) for i in (1, 2)] == [0, 3]


def test_loads_that_nothing_can_balance_are_told_in_their_row_and_stop_no_other(prism: Scene):
    rows = list(sweep(prism, set={"loads.n1.z": [0.0, 1.0]}, out=["slack"]))
    assert [(row["verdict"], row["converged"], row["slack"]) for row in rows] == [
        ("converged", True, 0),
        (BAD_SCENE, False, None),
    ]


def test_a_row_without_equilibrium_in_reach_says_so(prism: Scene):
    (row,) = sweep(prism, set={"struts.EA": [10.0]}, max_iterations=1)
    assert (row["verdict"], row["converged"], row["stability"]) == ("max_iterations", False, None)


def test_elements_without_rest_length_have_no_strain_to_tell():
    scene = cgff_cli.loads(PAIR.replace("hooke", "paper"))
    (row,) = sweep(scene, set={"left.rest_length": [0], "right.one.rest_length": [0]}, out=["max_strain"])
    assert np.isnan(row["max_strain"])


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ({}, f"nothing is swept; give {KEYS} some values"),
        ({"set": {"lift.EA": "1"}}, f"no group is named 'lift'{ONE}; did you mean 'left'?"),
        ({"set": {"a,c.d.EA": "1"}}, "no element joins 'a' and 'c.d'"),
        (
            {"set": {"left.EA": "1", "b,a.EA": "1"}},
            "left.EA and b,a.EA change the same number; only factors may do so together",
        ),
        ({"set": {"loads.B.y": "1"}}, "no node is named 'B'; did you mean 'b'?"),
        ({"set": {"loads.b.z": "1"}}, "loads.b.z: an axis of this scene is one of x, y"),
        (
            {"set": {"left.length": "1"}},
            f"left.length: no number of a scene; what can be swept: {KEYS}",
        ),
        ({"set": {"left.EA": "0:1:3"}}, "left.EA: EA must be > 0, got 0"),
        ({"set": {"left.EA": "1:inf:3"}}, "left.EA=1:inf:3: both ends of a range must be finite"),
        ({"set": {"left.EA": "1,nan"}}, "left.EA: EA must be a finite number, got nan"),
        ({"set": {"left.rest_length": "0"}}, "left.rest_length: rest_length must be > 0, got 0"),
        ({"scale": {"left.EA": "-1"}}, "left.EA: EA must be > 0, got -10 for the factor -1"),
        (
            {"set": {"left.EA": "1:2"}},
            "left.EA=1:2: values must be LEAST:GREATEST:COUNT, log:LEAST:GREATEST:COUNT "
            "or numbers with commas",
        ),
        (
            {"set": {"left.EA": "1:2:3"}, "random": 5},
            "left.EA=1:2:3: values must be LEAST:GREATEST, log:LEAST:GREATEST or numbers with commas; "
            "a random sweep takes no count",
        ),
        (
            {"set": {"left.EA": "1:2:0"}},
            "left.EA=1:2:0: the count must be a whole number from 1 to 10000000, got 0",
        ),
        (
            {"set": {"left.EA": "log:-1:2:3"}},
            "left.EA=log:-1:2:3: both ends of a range must be > 0 where it is logarithmic",
        ),
        ({"set": {"loads.b.y": "-1e308:1e308:3"}}, "loads.b.y: y must be a finite number, got nan"),
        ({"set": {"left.EA": [1, "x"]}}, "left.EA: values must be numbers, got [1, 'x']"),
        ({"set": {"left.EA": "1"}, "scale": {"left.EA": "1"}}, "left.EA is both set and scaled"),
        (
            {"set": {"left.EA": "1,2", "right.one.EA": "1,2,3"}, "zip": True},
            "zipped axes must have as many values each; left.EA has 2, right.one.EA has 3",
        ),
        ({"set": {"left.EA": "1"}, "zip": True, "random": 2}, "a sweep is zipped or random, not both"),
        (
            {"set": {"left.EA": "1"}, "out": ["hight"]},
            "hight: unknown output 'hight'; did you mean 'height'?",
        ),
        ({"set": {"left.EA": "1"}, "out": ["force"]}, "force: must be force:GROUP"),
        ({"set": {"left.EA": "1"}, "out": ["slack:left"]}, "slack:left: must be slack"),
        ({"set": {"left.EA": "1"}, "out": ["length:a,x"]}, "no node is named 'x'"),
        (
            {"set": {"left.EA": "1:2:1000000", "right.one.EA": "1:2:10000000"}},
            "the number of rows must be a whole number from 1 to 1000000000000, got 10000000000000",
        ),
    ],
)
def test_what_is_asked_wrongly_is_told_before_anything_is_solved(
    pair: Scene, asked: dict[str, object], message: str
):
    with pytest.raises(cgff_cli.OptionError) as raised:
        planned(pair, **asked)
    assert str(raised.value) == message


def test_a_geometry_has_no_equilibrium_to_sweep(pair: Scene):
    geometry = PAIR.replace("rest_length: 1, ", "").replace("rest_length: [1], ", "")
    with pytest.raises(cgff_cli.SceneError, match="cgff prestress"):
        planned(cgff_cli.loads(geometry), set={"left.EA": "1"})
