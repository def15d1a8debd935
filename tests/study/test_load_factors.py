"""Load factors in a sweep: a row is the scene with its loads written out, a path is one of many loads."""

import numpy as np
import pytest

import cgff_cli
from cgff_cli.study.path import followed
from cgff_cli.study.rows import sweep
from cgff_cli.study.sweep import planned
from tests.study.test_path import SNAPS, TRUSS, force

ROPE = """\
law: hooke
nodes: {{a: [0, 0], b: [2, -0.2], c: [4, 0]}}
elements:
  rope: {{kind: cable, EA: 1000, rest_length: 2, weight: {weight}, pairs: [[a, b], [b, c]]}}
supports: {{a: xy, c: xy}}
loads: {{b: {load}}}
load_cases: {{apart: {{b: [3, 0]}}, down: {{b: [0, -2]}}}}
combinations: {{uls: {{down: 1.5, dead: 1.35, apart: 0.5}}, up: {{down: -1}}}}
"""
TWO = (
    TRUSS.replace("c: [1, 0]}", "c: [1, 0], d: [4, 0], e: [5, 0.5], f: [6, 0]}")
    .replace("[c, b]]", "[c, b], [d, e], [f, e]]")
    .replace("c: xy", "c: xy, d: xy, f: xy")
)


@pytest.mark.parametrize(
    ("case", "asked", "load", "weight"),
    [
        ("", {"set": {"case.down": "3"}}, [0.0, -7.0], 0.5),
        ("", {"set": {"case.down": "3", "case.apart": "-1"}}, [-3.0, -7.0], 0.5),
        ("", {"set": {"case.uls": "2"}}, [3.0, -8.7], 1.35),
        ("", {"set": {"case.apart": "2", "case.uls": "2"}}, [9.0, -8.7], 1.35),
        ("", {"set": {"case.uls": "2", "loads.b.y": "-4", "rope.weight": "1"}}, [3.0, -16.8], 2.7),
        ("", {"set": {"case.up": "-3"}}, [0.0, -6.0], 0.0),
        ("", {"set": {"case.dead": "3"}}, [0.0, -3.0], 1.5),
        ("", {"scale": {"loads": "4"}}, [0.0, -4.0], 0.5),
        ("", {"scale": {"loads": "4", "loads.b.y": "2"}, "set": {"case.down": "1"}}, [0.0, -10.0], 0.5),
        ("apart", {"scale": {"loads": "2"}}, [6.0, -2.0], 0.5),
        ("apart", {"set": {"case.down": "1"}}, [3.0, -3.0], 0.5),
    ],
)
def test_a_row_is_the_scene_with_its_loads_written_out(
    case: str, asked: dict[str, dict[str, str]], load: list[float], weight: float
):
    scene = cgff_cli.loads(ROPE.format(load=[0, -1], weight=0.5))
    scene = scene.in_case(case) if case else scene
    out = ["node:b", "force:rope"]
    alone = cgff_cli.solve(cgff_cli.loads(ROPE.format(load=load, weight=weight)))
    for follow in (False, True) if len({**asked.get("set", {}), **asked.get("scale", {})}) == 1 else (False,):
        (row,) = sweep(scene, out=out, follow=follow, **asked)
        assert row["converged"]
        assert [row["node:b.x"], row["node:b.y"]] == pytest.approx(alone.nodes["b"], rel=1e-7)
        assert row["force:rope.max"] == pytest.approx(alone.forces.max(), rel=1e-7)
        assert row["energy"] == pytest.approx(alone.energy, rel=1e-9)


@pytest.mark.parametrize(
    ("loads", "asked"),
    [
        ("load_cases: {push: {b: [0, -1], e: [0, -2]}}", {"set": {"case.push": "1.9:2:2"}}),
        ("loads: {b: [0, -1], e: [0, -2]}", {"scale": {"loads": "1.9:2:2"}}),
    ],
)
def test_loads_on_many_nodes_are_followed_to_the_factor_of_the_closed_form(
    loads: str, asked: dict[str, dict[str, str]]
):
    plan = planned(cgff_cli.loads(TWO + loads), **asked, out=["node:b", "node:e"])
    stops = list(followed(plan).stops())
    assert [stop.lost for stop in stops] == [(), (pytest.approx(-SNAPS / 2.0, rel=1e-7),)]
    for stop, factor in zip(stops, (1.9, 2.0), strict=True):
        held = [force(stop.row[f"node:{name}.y"]) for name in "be"]
        assert held == pytest.approx([-factor, -2.0 * factor], rel=1e-7)


def test_rows_under_load_factors_do_not_depend_on_their_chunks():
    scene = cgff_cli.loads(ROPE.format(load=[0, -1], weight=0.5))
    plan = planned(scene, set={"case.uls": "0.4:2:9", "rope.EA": [500.0, 710.0]}, out=["node:b"])
    whole, last = plan.solved(plan.span(0, 18)).columns, plan.for_workers.solved(plan.span(11, 18)).columns
    assert {name: column[11:] for name, column in whole.items()} == last
    assert len(np.unique(whole["node:b.y"])) == 18


@pytest.mark.parametrize(
    ("case", "asked", "message"),
    [
        ("", {"set": {"loads": "1"}}, "loads: all loads are many numbers; scale them, or set loads.NAME.x"),
        ("", {"set": {"case.dwn": "1"}}, "no load case is named 'dwn'; did you mean 'down'?"),
        ("", {"scale": {"case.down": "1"}}, "case.down: is a factor itself; set it"),
        (
            "",
            {"set": {"case.uls": "1", "case.dead": "1"}},
            "case.uls and case.dead each stand in the place of loads and weight; sweep one",
        ),
        (
            "down",
            {"set": {"case.down": "1"}},
            "case.down and --case down are both given; leave out --case",
        ),
        ("down", {"set": {"case.uls": "1"}}, "case.uls and --case down are both given; leave out --case"),
        (
            "",
            {"set": {"case.down": "1e30"}},
            "case.down: loads must not exceed 1e30 in size, got -2e+30 for the factor 1e+30",
        ),
        (
            "",
            {"set": {"case.uls": "0,-1"}},
            "case.uls: weight must be >= 0, got -0.675 for the factor -1",
        ),
        (
            "",
            {"set": {"loads.b.y": "1"}, "scale": {"loads": "1"}},
            "loads.b.y and loads change the same number; only factors may do so together",
        ),
    ],
)
def test_load_factors_without_a_meaning_are_refused(
    case: str, asked: dict[str, dict[str, str]], message: str
):
    scene = cgff_cli.loads(ROPE.format(load=[0, -1], weight=0.5))
    with pytest.raises(cgff_cli.OptionError) as raised:
        planned(scene.in_case(case) if case else scene, **asked)
    assert str(raised.value) == message


def test_a_scene_without_loads_has_none_to_scale():
    with pytest.raises(cgff_cli.OptionError, match=r"loads: the scene has none to scale; case.NAME is"):
        planned(cgff_cli.loads(TRUSS), scale={"loads": "0:1:2"})


def test_a_group_that_is_called_case_is_named_before_load_cases():
    text = TWO.replace("bars:", "case:") + "load_cases: {EA: {b: [0, -1]}, rest: {b: [0, -1]}}"
    (row,) = sweep(cgff_cli.loads(text), set={"case.EA": "50", "case.rest": "1"}, out=["force:case"])
    assert row["force:case.min"] < 0.0
    assert planned(cgff_cli.loads(text), set={"case.EA": "50"}).axes[0].array == "EA"
