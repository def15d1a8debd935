"""What the analysis names, what it leaves null, and what it says of prestress."""

import numpy as np
import pytest

import cgff_cli
from cgff_cli.analysis import equilibrium
from cgff_cli.analysis.reasons import ASKED_FOR, OF_EQUILIBRIA
from cgff_cli.scene.read import from_dict
from cgff_cli.scene.scene import Group, Scene
from tests.analysis.scenes import CORNERS
from tests.bodies import scene
from tests.closed_forms.references import hypar_net
from tests.solvers.scenes import pendulum, shipped, truss

JUDGED = ("stable", "stability", "smallest_stiffness", "super_stable")
COUNTED = ("nullity_D", "nullity_U", "self_stress_states", "mechanisms", "rigid_motions", "rank_tolerance")


def test_slack_cables_are_named_by_group_and_ends():
    sides = [(0, 1, "cable", 10.0, 3.0), (1, 2, "strut", 10.0, 2.0), (2, 0, "cable", 10.0, 4.0)]
    found = cgff_cli.solve(scene(CORNERS[:3], sides)).analysis
    assert found["slack_count"] == 2
    assert found["slack_cables"] == ["e0: n0-n1", "e2: n2-n0"]


def test_a_group_of_several_names_the_right_one():
    pairs = np.array([[0, 1], [1, 2], [2, 0]])
    body = scene(CORNERS[:3], [(0, 1, "strut", 1.0, 2.0)])
    ring = Group("ring", "cable", pairs, np.full(3, 10.0), np.array([2.0, 2.5, 2.0]))
    groups, held = (*body.groups, ring), {0: "xy", 1: "xy", 2: "xy"}
    one = Scene("ring", "paper", body.node_names, body.coordinates, groups, held)
    found = cgff_cli.solve(one).analysis
    assert found["slack_cables"] == ["ring: n1-n2"]


def test_struts_in_tension_are_named():
    found = cgff_cli.solve(pendulum(-1.0)).analysis
    assert found["struts_in_tension_count"] == 1
    assert found["struts_in_tension"] == ["e0: n0-n1"]


def test_a_strut_in_compression_or_at_rest_is_not_in_tension():
    assert cgff_cli.solve(shipped("prism")).analysis["struts_in_tension"] == []
    assert cgff_cli.solve(truss(0.5)).analysis["struts_in_tension"] == []


def test_no_more_than_a_hundred_are_named_but_all_are_counted():
    cables = [(0, 1, "cable", 1.0, 5.0)] * 130
    held = scene(CORNERS[:2], cables, {0: "xy", 1: "xy"})
    found = cgff_cli.solve(held).analysis
    assert found["slack_count"] == 130
    assert len(found["slack_cables"]) == 100


def test_prestress_is_told_from_rounding():
    assert cgff_cli.solve(shipped("prism")).analysis["prestressed"] is True
    assert cgff_cli.solve(truss(0.5)).analysis["prestressed"] is False


def test_without_analysis_everything_computed_is_null_and_the_names_remain():
    found = cgff_cli.solve(shipped("prism"), analysis="never").analysis
    assert [found[name] for name in (*JUDGED, *COUNTED)] == [None] * 10
    assert set(found["reason"].values()) == {"not computed: analysis is off (analysis: never)"}
    assert found["slack_count"] == 0
    assert found["prestressed"] is True


@pytest.mark.parametrize("options", [{"max_iterations": 2}, {"method": "table1"}])
def test_short_of_an_equilibrium_stability_is_null_and_ranks_are_not(options):
    result = cgff_cli.solve(shipped("hexagon"), **options)
    assert not result.converged
    assert [result.analysis[name] for name in OF_EQUILIBRIA] == [None] * 7
    told = {result.analysis["reason"][name] for name in OF_EQUILIBRIA}
    assert told == {"no equilibrium was reached, so stability is not told"}
    assert None not in [result.analysis[name] for name in COUNTED]


def test_ranks_of_very_large_scenes_are_counted_only_when_asked(monkeypatch):
    net = from_dict(hypar_net(12).scene("paper"))
    monkeypatch.setattr(equilibrium, "MOST", 362)
    unasked = cgff_cli.solve(net).analysis
    left_out = (*COUNTED, "smallest_stiffness", "super_stable")
    assert [unasked[name] for name in left_out] == [None] * 8
    assert {unasked["reason"][name] for name in left_out} == {
        "not computed: more than 3000 free directions; ask with --analysis always"
    }
    assert unasked["stable"] is True
    asked = cgff_cli.solve(net, analysis="always").analysis
    assert (asked["stable"], asked["super_stable"]) == (True, True)
    # 121 free nodes, 264 cables, one self-stress.
    assert (asked["self_stress_states"], asked["mechanisms"]) == (1, 3 * 121 - 264 + 1)
    assert set(asked["reason"]) == set(ASKED_FOR)


@pytest.mark.parametrize("name", ["prism", "bracket", "cable-net"])
def test_nothing_is_null_without_a_reason(name):
    for options in ({}, {"max_iterations": 1}, {"analysis": "never"}):
        found = cgff_cli.solve(shipped(name), **options).analysis
        assert {field for field, value in found.items() if value is None} == set(found["reason"])


def test_where_all_that_moves_is_idle_no_stiffness_is_told_and_why():
    bar = scene(CORNERS[:2], [(0, 1, "strut", 10.0, 2.0)])
    found = cgff_cli.solve(bar).analysis
    assert found["smallest_stiffness"] is not None
    found = cgff_cli.solve(scene(CORNERS[:2], [(0, 1, "strut", 10.0, 2.0)], {0: "xy", 1: "xy"})).analysis
    assert set(found["reason"]) == {"smallest_stiffness", "rank_gap", *ASKED_FOR}
    assert found["tangent_eigenvalues"] == []
