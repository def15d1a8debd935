"""At which multiple of the loads the first cable goes slack: closed forms, K by differences, and solves."""

from dataclasses import replace
from math import cos, sin, sqrt

import numpy as np
import pytest

import cgff_cli
from cgff_cli.mechanics import connectivity
from tests.analysis.test_buckling import column
from tests.bodies import scene, tangent_by_complex_steps
from tests.solvers.scenes import shipped

TENSION, ABOVE, BELOW = 2.0, 30.0, 50.0
LOADED = ("critical_load_factor", "first_slack_factor", "first_slack_cables")


@pytest.fixture(params=[False, True], ids=["dense", "sparse"])
def entries(request, monkeypatch):
    """Let every structure be small, then large."""
    if request.param:
        monkeypatch.setattr(connectivity, "DENSE_ENTRIES", 0)


def line(load, rest=None, turn=0.0):
    """Return a node between two cables in line, pulled together, under a load along them, in balance.

    Their stiffnesses are ABOVE and BELOW, each is 1 long; rest: rest lengths in place of those of balance.
    """
    down = np.array([sin(turn), -cos(turn)])
    share = load * ABOVE / (ABOVE + BELOW)
    upper, lower = (TENSION + share) / ABOVE, (TENSION + share - load) / BELOW
    rests = rest or (1.0 - upper, 1.0 - lower)
    bars = [(0, 1, "cable", ABOVE, rests[0]), (1, 2, "cable", BELOW, rests[1])]
    return scene([0.0 * down, down, 2.0 * down], bars, {0: "xy", 2: "xy"}, {1: load * down})


def mast(force, turn=0.0):
    """Return a mast of 30 with three guys of tension 20, feet 18 away, under a level force; to be solved.

    The force pushes away from the first guy's foot, turn: both about the shaft.
    """
    feet = [(-18.0, 0.0, 0.0), (9.0, 9.0 * sqrt(3.0), 0.0), (9.0, -9.0 * sqrt(3.0), 0.0)]
    length = sqrt(18.0**2 + 30.0**2)
    thrust = 3.0 * 20.0 * 30.0 / length
    bars = [(0, 1, "strut", 600000.0, 30.0 / (1.0 - thrust / 600000.0))]
    bars += [(row, 1, "cable", 30000.0, length / (1.0 + 20.0 / 30000.0)) for row in (2, 3, 4)]
    held = dict.fromkeys((0, 2, 3, 4), "xyz")
    about = np.array([[cos(turn), -sin(turn), 0.0], [sin(turn), cos(turn), 0.0], [0.0, 0.0, 1.0]])
    points = np.array([(0.0, 0.0, 0.0), (0.0, 0.0, 30.0), *feet]) @ about.T
    return scene(points, bars, held, {1: about @ (force, 0.0, 0.0)}, "hooke")


def told(body, **options):
    found = cgff_cli.analyse(body, **options)
    assert found.balanced
    return found.analysis


@pytest.mark.parametrize("load", [0.01, 1.0, 3.0])
def test_of_two_cables_in_line_the_one_below_goes_slack_where_its_share_of_the_load_is_its_tension(
    load, entries
):
    # The load is shared as the stiffnesses are: below, BELOW / (ABOVE + BELOW) of it is lost.
    found = told(line(load, turn=0.4))
    assert found["first_slack_factor"] == pytest.approx(TENSION * (ABOVE + BELOW) / (BELOW * load), rel=1e-9)
    assert found["first_slack_cables"] == ["e1: n1-n2"]


def test_without_a_critical_factor_the_reason_names_the_cables_that_go_slack():
    found = told(cgff_cli.solve(mast(4.0)))
    assert found["critical_load_factor"] is None
    assert found["reason"]["critical_load_factor"] == (
        "no multiple of the loads makes the stiffness singular, as far as it is linear in them and no cable "
        f"goes slack; e2: n3-n1, e3: n4-n1 go slack at {found['first_slack_factor']:.6g} times the loads"
    )


def test_weight_counts_among_the_loads():
    weight = 0.5
    body = cgff_cli.from_dict(
        {
            "law": "hooke",
            "nodes": {"top": [0.0, 2.0], "mid": [0.0, 1.0], "end": [0.0, 0.0]},
            "elements": {
                "line": {"kind": "cable", "EA": 1e5, "rest_length": 0.9999, "weight": weight}
                | {"pairs": [["top", "mid"], ["mid", "end"]]}
            },
            "supports": {"top": "xy", "end": "xy"},
        }
    )
    # 1e5 (1 / 0.9999 - 1) in either, of which half the weight on the node between is lost below.
    known = 2.0 * 1e5 * (1.0 / 0.9999 - 1.0) / (weight * 0.9999)
    found = told(cgff_cli.solve(body, tolerance=1e-12))
    assert found["first_slack_factor"] == pytest.approx(known, rel=1e-9)
    assert found["first_slack_cables"] == ["line: mid-end"]


@pytest.mark.parametrize("turn", [0.0, 0.5, 1.3])
def test_the_leeward_guys_of_a_mast_go_slack_together_where_a_hand_calculation_says(turn, entries):
    # u = F / (3/2 EA/l cos^2) and a leeward guy loses EA/l cos u / 2: all of 20 at F = 3 x 20 cos.
    found = told(cgff_cli.solve(mast(4.0, turn)))
    by_hand = 3.0 * 20.0 * 18.0 / sqrt(18.0**2 + 30.0**2) / 4.0
    assert found["first_slack_factor"] == pytest.approx(by_hand, rel=2e-3)
    assert found["first_slack_cables"] == ["e2: n3-n1", "e3: n4-n1"]


@pytest.mark.parametrize(("share", "slack"), [(0.999, 0), (1.001, 2)])
def test_solves_of_a_mast_find_the_guys_slack_above_that_factor_and_taut_below(share, slack):
    factor = told(cgff_cli.solve(mast(4.0)))["first_slack_factor"]
    assert cgff_cli.solve(mast(4.0 * factor * share)).slack.sum() == slack


@pytest.mark.parametrize("share", [0.2, 0.6, 0.98])
def test_the_force_at_slack_hangs_little_on_the_load_it_is_foretold_from(share):
    alone = 4.0 * told(cgff_cli.solve(mast(4.0)))["first_slack_factor"]
    force = alone * share
    assert force * told(cgff_cli.solve(mast(force)))["first_slack_factor"] == pytest.approx(alone, rel=2e-3)


@pytest.mark.parametrize(("name", "case"), [("spine", "tool"), ("roof", "snow"), ("cable-net", None)])
def test_the_factor_is_that_of_a_stiffness_by_complex_steps(name, case, entries):
    body = shipped(name)
    result = cgff_cli.solve(body.in_case(case) if case else body, tolerance=1e-12)
    s, X = result.structure, result.coordinates
    free = np.flatnonzero(s.free)
    dx = np.zeros(X.size)
    dx[free] = np.linalg.solve(tangent_by_complex_steps(s, X), s.loads.reshape(-1)[free])
    V, Z = (own[s.start] - own[s.end] for own in (X, dx.reshape(X.shape)))
    rate = s.stiffness * (V * Z).sum(axis=1) / np.linalg.norm(V, axis=1)
    falls = s.tension_only & (result.forces > 0.0) & (rate < -1e-6 * np.abs(rate).max())
    known = (1.0 - result.forces[falls] / rate[falls]).min()
    assert told(result)["first_slack_factor"] == pytest.approx(known, rel=1e-6)


@pytest.mark.parametrize("turn", [0.0, 0.3, 1.1, 2.0])
def test_a_cable_that_loads_do_not_reach_but_for_rounding_does_not_go_slack(turn, entries):
    # Soft springs take the load across two stiff cables with a strain of 1e-9: those turn, and no more.
    along, across = np.array([cos(turn), sin(turn)]), np.array([-sin(turn), cos(turn)])
    points = [0.0 * along, along, -along, across, -across]
    load, soft = 1e-4, 1e-4
    bars = [(0, row, "cable", 1e3, 1.0 - 1e-9) for row in (1, 2)]
    bars += [(0, 3, "strut", soft, 1.5), (0, 4, "strut", soft, 1.5 - load / soft)]
    found = told(scene(points, bars, dict.fromkeys((1, 2, 3, 4), "xy"), {0: load * across}))
    assert (found["stability"], found["first_slack_factor"]) == ("stable", None)
    assert "no taut cable loses its force" in found["reason"]["first_slack_factor"]


def test_what_is_far_softer_beside_it_does_not_hide_that_a_cable_goes_slack(entries):
    # A spring of 1e-8 would move 1e6 under a load that stretches the line by 1e-4.
    body, load, soft = line(0.01), 0.01, 1e-8
    spring = replace(body.groups[0], name="spring", kind="strut", pairs=np.array([[3, 4]]))
    spring = replace(spring, EA=np.array([soft]), rest_length=np.array([1.0 + load / soft]))
    beside = replace(
        body,
        node_names=(*body.node_names, "n3", "n4"),
        coordinates=np.vstack((body.coordinates, [(5.0, -1.0), (5.0, 0.0)])),
        groups=(*body.groups, spring),
        supports={**body.supports, 3: "xy", 4: "x"},
        loads={**body.loads, 4: (0.0, -load)},
    )
    known = told(body)["first_slack_factor"]
    assert told(beside)["first_slack_factor"] == pytest.approx(known, rel=1e-6)


def test_a_cable_without_rest_length_never_goes_slack():
    body = scene(
        [(0.0, 0.0), (0.0, -1.0), (0.0, -2.0)],
        [(0, 1, "cable", 3.0, 0.0), (1, 2, "cable", 2.0, 0.0)],
        {0: "xy", 2: "xy"},
        {1: (0.0, -1.0)},
    )
    found = told(body)
    assert found["first_slack_cables"] is found["first_slack_factor"] is None


def test_a_slack_cable_is_not_told_to_go_slack():
    body = line(1.0)
    slack = replace(body.groups[1], name="slack", rest_length=np.array([3.0]))
    found = told(replace(body, groups=(*body.groups, slack)))
    assert found["slack_cables"] == ["slack: n1-n2"]
    assert found["first_slack_cables"] == ["e1: n1-n2"]


@pytest.mark.parametrize(
    ("body", "why"),
    [
        (line(0.0), "there are no loads"),
        (line(1.0, rest=(0.9, 0.9)), "no equilibrium was reached"),
        (column(2, 3.0 / 1.0015), "some motion has no stiffness"),
        (replace(line(1.0), supports=dict.fromkeys(range(3), "xy")), "nothing can move"),
    ],
    ids=["without loads", "out of balance", "at its critical load", "held everywhere"],
)
def test_where_the_loads_tell_nothing_all_that_hangs_on_them_is_null_for_one_reason(body, why, entries):
    found = cgff_cli.analyse(body).analysis
    assert [found[name] for name in LOADED] == [None] * 3
    assert why in found["reason"][LOADED[0]]
    assert len({found["reason"][name] for name in LOADED}) == 1
