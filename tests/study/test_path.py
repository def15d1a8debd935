"""A path: what is lost, what only branches off, what is the same as separate solves; against closed forms."""

import json
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import cgff_cli
from cgff_cli.study.alignment import rigidly
from cgff_cli.study.path import Path, followed
from cgff_cli.study.rows import sweep
from cgff_cli.study.sweep import planned
from tests.shapes import STRUCTURES

REST, EA = float(np.hypot(1.0, 0.5)), 100.0
TRUSS = f"""\
law: hooke
nodes: {{a: [-1, 0], b: [0, 0.5], c: [1, 0]}}
elements: {{bars: {{kind: strut, EA: {EA}, rest_length: {REST!r}, pairs: [[a, b], [c, b]]}}}}
supports: {{a: xy, c: xy}}
"""
COLUMN = """\
law: paper
nodes: {a: [0, 0], b: [1, 0], c: [2, 0], u: [1, 1], d: [1, -1]}
elements:
  bars: {kind: strut, EA: 100, rest_length: 1, pairs: [[a, b], [b, c]]}
  springs: {kind: strut, EA: 1, rest_length: 1, pairs: [[b, u], [b, d]]}
supports: {a: xy, c: xy, u: xy, d: xy}
"""


def force(y: float) -> float:
    """Return the load that holds the top of the truss at a height."""
    l = np.hypot(1.0, y)
    return 2.0 * EA / REST * (l - REST) * y / l


SNAPS = float(minimize_scalar(force, bounds=(0.0, 0.5), method="bounded", options={"xatol": 1e-12}).fun)


def path(scene: str, key: str, values: str, **asked: object) -> Path:
    return followed(planned(cgff_cli.loads(scene), set={key: values}, **asked))


@pytest.mark.parametrize("values", ["0:-6:13", "0:-3.9:2", "0:-6:4", "0:-300:2", "-3:-4:2", "0:-1000:2"])
def test_a_truss_snaps_through_at_the_load_of_its_closed_form(values: str):
    stops = list(path(TRUSS, "loads.b.y", values, out=["node:b"]).stops())
    (lost,) = [value for stop in stops for value in stop.lost]
    assert lost == pytest.approx(SNAPS, rel=1e-7)
    for stop in stops:
        load, y = stop.row["loads.b.y"], stop.row["node:b.y"]
        assert force(y) == pytest.approx(load, abs=1e-6)
        assert (y > 0.0) == (load > SNAPS)
        assert (stop.row["lost"] is not None) == ((stop.row["jump"] or 0.0) > 0.1)


@pytest.mark.parametrize("values", ["0:-5350:3", "0:-54:2"])
def test_a_tall_truss_snaps_through_however_far_a_step_leads(values: str):
    rest = float(np.hypot(1.0, 2.0))
    tall = TRUSS.replace("0.5", "2").replace(repr(REST), repr(rest))

    def pushed(y: float) -> float:
        return 200.0 / rest * (np.hypot(1.0, y) - rest) * y / np.hypot(1.0, y)

    snaps = minimize_scalar(pushed, bounds=(0.0, 2.0), method="bounded", options={"xatol": 1e-12}).fun
    (lost,) = [value for stop in path(tall, "loads.b.y", values).stops() for value in stop.lost]
    assert lost == pytest.approx(snaps, rel=1e-7)


def test_what_falls_after_another_is_told_each_for_itself():
    one = TRUSS.replace("supports: {", "supports: {P: xy, Q: xy, d: xy, f: xy, ").replace(
        "c: [1, 0]}", "c: [1, 0], d: [4, 0], e: [5, 0.3], f: [6, 0], P: [0, -6], Q: [5, -6]}"
    )
    low = float(np.hypot(1.0, 0.3))
    two = f"""  other: {{kind: strut, EA: 150, rest_length: {low!r}, pairs: [[d, e], [f, e]]}}
  pull: {{kind: cable, EA: 5, rest_length: 6, pairs: [[b, P], [e, Q]]}}
supports"""
    scene = one.replace("elements: {bars", "elements:\n  bars").replace("}}\nsupports", "}\n" + two)

    def fold(h: float, stiff: float) -> float:
        rest = np.hypot(1.0, h)

        def pulled(y: float) -> float:  # 5 (6 + y - l0) / l0 in the cable is what the bars bear
            l = np.hypot(1.0, y)
            return 5.0 * (6.0 + y) / (5.0 - 2.0 * stiff / rest * (l - rest) * y / l)

        return float(minimize_scalar(pulled, bounds=(0.0, h), method="bounded", options={"xatol": 1e-12}).fun)

    expected = sorted((fold(0.5, EA), fold(0.3, 150.0)), reverse=True)
    for values in ("6.5:2:2", "6.5:2:12"):
        stops = path(scene, "pull.rest_length", values).stops()
        assert [value for stop in stops for value in stop.lost] == pytest.approx(expected, rel=1e-7)


def test_a_small_snap_in_a_large_structure_is_seen_whatever_the_steps():
    height, top = 100, 0.038108719  # of the snapping bars on rigid ground; the ladder gives way a little
    rungs = range(height + 1)
    nodes = {f"{side}{i}": [x, -i] for i in rungs for side, x in (("l", 0), ("r", 1))}
    sides = [[f"{side}{i}", f"{side}{i + 1}"] for i in rungs[:-1] for side in "lr"]
    steps = [[f"l{i}", f"r{i}"] for i in rungs[1:]]
    crosses = [[f"{a}{i}", f"{b}{i + 1}"] for i in rungs[:-1] for a, b in ("lr", "rl")]
    bar = {"kind": "strut", "EA": 1e4}
    elements = {
        "frame": bar | {"rest_length": 1.0, "pairs": sides + steps},
        "crosses": bar | {"rest_length": float(np.sqrt(2.0)), "pairs": crosses},
        "snap": {
            "kind": "strut",
            "EA": 100.0,
            "rest_length": float(np.hypot(0.5, 0.05)),
            "pairs": [[f"l{height}", "t"], [f"r{height}", "t"]],
        },
    }
    scene = {
        "law": "hooke",
        "nodes": nodes | {"t": [0.5, -height - 0.05]},
        "elements": elements,
        "supports": {"l0": "xy", "r0": "xy"},
    }
    for values in ([0.0, 3.0 * top], [0.0, 0.5 * top, top, 1.5 * top]):
        stops = followed(planned(cgff_cli.loads(json.dumps(scene)), set={"loads.t.y": values})).stops()
        (lost,) = [value for stop in stops for value in stop.lost]
        assert lost == pytest.approx(0.03776814838, rel=1e-7)


@pytest.mark.parametrize("values", ["0:-1:5", "0:-1:2"])
def test_cables_that_hang_slack_until_they_are_loaded_lose_nothing(values: str):
    slack = TRUSS.replace("strut", "cable").replace(repr(REST), "1.2")
    stops = list(path(slack, "loads.b.y", values, out=["node:b"]).stops())
    assert [stop.lost for stop in stops] == [()] * len(stops)
    y = stops[-1].row["node:b.y"]
    l = np.hypot(1.0, y)
    assert 2.0 * EA / 1.2 * (l - 1.2) * y / l == pytest.approx(-1.0)


@pytest.mark.parametrize("values", ["1:-0.9:2", "1:-0.37:7"])
def test_cables_that_flop_over_where_nothing_loads_them_are_lost_once(values: str):
    slack = TRUSS.replace("strut", "cable").replace(repr(REST), "1.2")
    (lost,) = [value for stop in path(slack, "loads.b.y", values).stops() for value in stop.lost]
    assert lost == pytest.approx(0.0, abs=1e-9)


def test_the_way_back_is_another_one():
    rows = [stop.row for stop in path(TRUSS, "loads.b.y", "-6:6:13", out=["node:b"]).stops()]
    (lost,) = [row["lost"] for row in rows if row["lost"] is not None]
    assert lost == pytest.approx(-SNAPS, rel=1e-7)
    assert [row["node:b.y"] > 0.0 for row in rows] == [row["loads.b.y"] > -SNAPS for row in rows]


@pytest.mark.parametrize("values", ["2:1.9:11", "2:1.9:7", "2:1.95:2", "1.9:2:5"])
def test_a_column_that_buckles_moves_aside_and_loses_nothing(values: str):
    buckles = 2.0 * (1.0 - 1.0 / 101.0)  # 2 q of bars and 2 EA / l of springs cancel
    rows = [stop.row for stop in path(COLUMN, "nodes.c.x", values, out=["node:b"]).stops()]
    assert [row["lost"] for row in rows] == [None] * len(rows)
    assert {row["stability"] for row in rows} == {"stable"}
    assert [abs(row["node:b.y"]) > 1e-6 for row in rows] == [row["nodes.c.x"] < buckles for row in rows]


def test_jump_is_of_second_order_in_a_smooth_step():
    jumps = [
        max(stop.row["jump"] or 0.0 for stop in path(TRUSS, "loads.b.y", f"0:-2:{count}").stops())
        for count in (6, 11, 21)
    ]
    assert [before / after for before, after in pairwise(jumps)] == pytest.approx([4.0, 4.0], abs=0.4)


def test_a_free_body_is_followed_whatever_its_attitude():
    prism = cgff_cli.load(STRUCTURES / "prism.yaml")
    rows = list(sweep(prism, set={"verticals.rest_length": "3:6:7"}, follow=True, out=["length:n1,n4"]))
    apart = list(sweep(prism, set={"verticals.rest_length": "3:6:7"}, out=["length:n1,n4"]))
    assert [row["length:n1,n4"] for row in rows] == pytest.approx([row["length:n1,n4"] for row in apart])
    assert [row["lost"] for row in rows] == [None] * 7
    assert max(row["jump"] for row in rows[1:]) < 2e-3


def test_cables_that_go_slack_are_one_of_many_shapes_and_not_lost():
    prism = cgff_cli.load(STRUCTURES / "prism.yaml")
    rows = list(sweep(prism, set={"struts.rest_length": "8:5:7"}, follow=True))
    assert [row["stability"] for row in rows] == ["stable"] * 3 + ["neutral"] * 4
    assert [row["lost"] for row in rows] == [None] * 7
    assert [row["jump"] for row in rows[-3:]] == [None] * 3


def test_what_is_left_of_the_forces_leaves_no_row_without_stability():
    tower = cgff_cli.new("tower", sides=3, stages=2)
    tower = replace(tower, supports=dict.fromkeys(range(3), "xyz"))
    asked = {"set": {"n1_1,n2_1.rest_length": "1.2:0.6:2"}, "tolerance": 1e-6}
    rows, apart = list(sweep(tower, follow=True, **asked)), list(sweep(tower, **asked))
    assert [row["stability"] for row in rows] == ["stable", "neutral"]
    assert [row["stability"] for row in apart] == ["stable", "neutral"]
    assert [row["energy"] for row in rows] == pytest.approx([row["energy"] for row in apart], rel=1e-6)


def test_a_row_that_does_not_converge_says_so_and_the_path_goes_on_from_the_last_that_did():
    rows = list(sweep(cgff_cli.loads(TRUSS), set={"loads.b.y": "0,-1,1"}, follow=True, max_iterations=2))
    assert [row["verdict"] for row in rows] == ["converged", "max_iterations", "max_iterations"]
    assert [row["jump"] for row in rows] == [None] * 3


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        (
            {"set": {"loads.b.y": "0:1:3", "bars.EA": "1,2"}},
            "a path follows one swept number, through all its values in their order",
        ),
        (
            {"set": {"loads.b.y": "0:1"}, "random": 5},
            "a path follows one swept number, through all its values in their order",
        ),
        (
            {"set": {"loads.b.y": "0:1:3"}, "analysis": "never"},
            "what a path loses shows in the stability of its shapes: not with analysis never",
        ),
        ({"set": {"nodes.b.y": "0:1:3"}}, "nodes.b.y: no path follows a start that is free to move"),
    ],
)
def test_what_is_no_path_is_refused(asked: dict[str, object], message: str):
    with pytest.raises(cgff_cli.OptionError) as raised:
        sweep(cgff_cli.loads(TRUSS), follow=True, **asked)
    assert str(raised.value) == message


def test_loads_that_nothing_holds_are_refused_before_the_path_begins():
    with pytest.raises(cgff_cli.OptionError, match=r"loads.n1.z: at 1 nothing can balance the loads"):
        sweep(cgff_cli.load(STRUCTURES / "prism.yaml"), set={"loads.n1.z": "0:2:3"}, follow=True)


def test_a_free_body_is_turned_but_not_mirrored_onto_what_is_predicted():
    X = np.random.default_rng(3).normal(size=(6, 3))
    turn = np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    turn[0] *= np.linalg.det(turn)
    assert rigidly(X @ turn + 1.0, X, mirror=False) == pytest.approx(X, abs=1e-12)
    mirrored = X * (1.0, 1.0, -1.0)
    assert rigidly(mirrored, X) == pytest.approx(X, abs=1e-12)
    assert np.abs(rigidly(mirrored, X, mirror=False) - X).max() > 0.1
