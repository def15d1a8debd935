"""What is wrong though it converged is said; what is sound is left in peace."""

import numpy as np
import pytest

import cgff_cli
from cgff_cli.cautions import Found, cautions
from cgff_cli.scene.families import FAMILIES
from cgff_cli.scene.new import new
from cgff_cli.scene.read import from_dict
from cgff_cli.scene.scene import Scene
from cgff_cli.study.case import built
from cgff_cli.study.suite import cases_of, standard
from tests.bodies import scene
from tests.solvers.scenes import SHIPPED, shipped

KINDS = ("units", "slack", "no force", "strain", "pretension", "size", "fallen together")
PINS = {0: "xy", 1: "xy"}


def said(result: cgff_cli.Result, kind: str) -> str:
    """Return what a result says of one kind, nothing where it does not."""
    return next((words for words in result.warnings if words.startswith(f"{kind}: ")), "")


def kinds(result: cgff_cli.Result) -> list[str]:
    """Return the kinds of all that is said of the shape."""
    return [kind for kind in KINDS if said(result, kind)]


def hung(rest: float, *, length: float = 1.0, kind: str = "cable") -> Scene:
    """Two members from pins to a node at a depth of their length, which is too long or too short for them."""
    bars = [(0, 2, kind, 100.0, rest), (1, 2, kind, 100.0, rest)]
    return scene([(-0.1, 0.0), (0.1, 0.0), (0.0, -length)], bars, PINS)


@pytest.mark.parametrize("name", SHIPPED)
def test_the_shipped_structures_raise_no_doubt(name: str):
    assert cgff_cli.solve(shipped(name)).warnings == ()


@pytest.mark.parametrize("family", [family for family in FAMILIES if family != "kresling"])
def test_no_family_raises_a_doubt(family: str):
    smaller = {"net": {"side": 20}}.get(family, {})
    assert cgff_cli.solve(new(family, **smaller)).warnings == ()


def test_a_module_at_rest_is_said_to_carry_no_force():
    assert kinds(cgff_cli.solve(new("kresling"))) == ["no force"]


def test_the_small_scenes_of_the_standard_suite_raise_no_doubt():
    for case in cases_of([standard()]):
        if (made := built(case)).element_count < 1000:
            assert cgff_cli.solve(made).warnings == (), case.id


def test_every_sentence_says_what_is_wrong_and_then_what_to_do():
    for rest in (0.001, 0.5, 1.5, 1000.0):
        for words in cgff_cli.solve(hung(rest)).warnings:
            kind, _, rest_of_it = words.partition(": ")
            assert kind
            assert "; " in rest_of_it
            assert "\n" not in words


def test_cables_that_are_all_slack_are_said_with_their_groups():
    result = cgff_cli.solve(hung(2.0))
    assert "every cable is slack (groups 'e0', 'e1')" in said(result, "slack")
    assert said(result, "no force") == ""


def test_one_taut_cable_is_enough():
    bars = [(0, 1, "cable", 1.0, 0.99), (0, 1, "cable", 1.0, 2.0)]
    assert kinds(cgff_cli.solve(scene([(0, 0), (1, 0)], bars, PINS))) == []


def test_struts_at_rest_carry_no_force_and_a_load_mends_that():
    bars = [(0, 2, "strut", 100.0, 1.2), (1, 2, "strut", 100.0, 1.2)]
    places = [(-1.0, 0.0), (1.0, 0.0), (0.0, 0.6)]
    assert "no element carries any" in said(cgff_cli.solve(scene(places, bars, PINS)), "no force")
    assert kinds(cgff_cli.solve(scene(places, bars, PINS, {2: (0.0, -1.0)}))) == []


@pytest.mark.parametrize(("rest", "warned"), [(1 / 1.09, False), (1 / 1.1, False), (1 / 1.11, True)])
def test_a_strain_above_a_tenth_names_group_and_nodes(rest: float, warned: bool):
    result = cgff_cli.solve(scene([(0, 0), (1, 0)], [(0, 1, "strut", 1.0, rest)], PINS))
    assert bool(said(result, "strain")) is warned
    if warned:
        assert said(result, "strain").startswith("strain: 0.11 in group 'e0' ('n0' and 'n1'), ")


def propped(push: float, *, load: float = 0.0, case: str = "") -> cgff_cli.Result:
    """A strut that pushes between two cables of 20 at right angles, in balance where it pushes 20 sqrt 2."""
    ties = {"kind": "cable", "EA": 1e4, "pretension": 20.0, "pairs": [["a", "top"], ["b", "top"]]}
    prop = {"kind": "strut", "EA": 1e4, "pretension": -push, "pairs": [["foot", "top"]]}
    made = from_dict(
        {
            "law": "hooke",
            "nodes": {"a": [-1, 0], "b": [1, 0], "foot": [0, 0], "top": [0, 1]},
            "elements": {"ties": ties, "prop": prop},
            "supports": {"a": "xy", "b": "xy", "foot": "xy"},
            "loads": {"top": [0.0, -load]},
            "load_cases": {"wind": {"top": [1.0, 0.0]}},
        }
    )
    return next(cgff_cli.solve_cases(made, [case])) if case else cgff_cli.solve(made)


def test_pretensions_out_of_balance_are_told_with_what_comes_of_them():
    even = 20.0 * 2**0.5
    for push, load in ((even, 0.0), (even, 5.0), (even + 5.0, 5.0), (0.97 * even, 0.0), (0.0, 0.0)):
        assert said(propped(push, load=load), "pretension") == "", (push, load)
    words = said(propped(-even), "pretension")
    assert words.startswith(
        "pretension: at the coordinates given, 200 % of the largest is out of balance, most at node 'top'; "
        "in balance group 'prop' has "
    )
    assert words.endswith(" in place of 28.3; check signs and sizes")


def test_in_a_load_case_pretensions_need_not_balance():
    assert said(propped(20.0), "pretension")
    assert not said(propped(20.0, case="wind"), "pretension")


def test_the_worst_three_of_many_strained_groups_are_named():
    bars = [(0, 1, "cable", 1.0, rest) for rest in (0.9, 0.5, 0.8, 0.7, 0.85)]
    words = said(cgff_cli.solve(scene([(0, 0), (1, 0)], bars, PINS)), "strain")
    assert words.startswith("strain: 1 in group 'e1' ")
    assert words.index("'e3'") < words.index("'e2'") < words.index("(5 groups in all)")
    assert "'e0'" not in words


@pytest.mark.parametrize(
    ("factor", "what"),
    [
        (1e3, "lengths at the start are 1010 times the rest lengths"),
        (3.1, "lengths at the start are 3.14 times the rest lengths"),
        (1 / 3.1, "rest lengths are 3.06 times the lengths at the start"),
        (1e-3, "rest lengths are 986 times the lengths at the start"),
    ],
)
def test_lengths_in_another_unit_than_rest_lengths_are_said(factor: float, what: str):
    prism = shipped("prism")
    other = Scene("prism", "paper", prism.node_names, prism.coordinates * factor, prism.groups)
    words = said(cgff_cli.solve(other), "units")
    assert words.startswith(f"units: {what} in the median (groups 'triangles', 'verticals', 'struts'); ")


def test_units_are_no_doubt_for_a_start_in_one_point():
    prism = shipped("prism")
    other = Scene("prism", "paper", prism.node_names, np.zeros((6, 3)), prism.groups)
    assert kinds(cgff_cli.solve(other)) == []


@pytest.mark.parametrize(("factor", "what"), [(0.4, "grew to 2.5"), (2.5, "shrank to 0.4"), (1.9, "")])
def test_a_shape_of_another_size_than_its_start_is_said(factor: float, what: str):
    prism = new("prism")
    other = Scene("prism", prism.law, prism.node_names, prism.coordinates * factor, prism.groups)
    words = said(cgff_cli.solve(other), "size")
    assert bool(words) is bool(what)
    assert what in words


def test_a_rigid_motion_is_no_change_of_size():
    one = cgff_cli.solve(new("prism"))
    rotation = np.linalg.qr(np.array([[1.0, 1.0, 1.0], [1.0, -1.0, 0.0], [1.0, 1.0, -2.0]]))[0]
    turned = one.structure.coordinates @ rotation + 100.0
    found = Found(one.source, one.structure, turned, one.forces, one.slack, one.strains, 0.0)
    assert cautions(found) == ()
    assert cautions(found._replace(coordinates=2.01 * turned))[0].startswith("size: ")
    assert cautions(found._replace(coordinates=1.99 * turned)) == ()


def test_nodes_that_fall_together_are_named():
    bars = [(i, j, "cable", 10.0, 0.95) for i in (0, 1) for j in (2, 3)]
    result = cgff_cli.solve(scene([(-1, 0), (1, 0), (0, 0.5), (0, -0.5)], bars, PINS))
    assert said(result, "fallen together").startswith("fallen together: nodes 'n2' and 'n3'; ")


def test_nodes_that_begin_together_may_stay_so():
    bars = [(0, 1, "cable", 10.0, 0.95), (2, 3, "cable", 10.0, 0.95)]
    result = cgff_cli.solve(scene([(0, 0), (1, 0), (1, 0), (2, 0)], bars, dict.fromkeys(range(4), "xy")))
    assert kinds(result) == []


@pytest.mark.parametrize("seed", range(5))
def test_no_pair_in_a_cloud_of_nodes_is_missed_or_invented(seed: int):
    rng = np.random.default_rng(seed)
    start = rng.uniform(size=(300, 3))
    end = start.copy()
    pairs = rng.permutation(300)[:8].reshape(4, 2)
    end[pairs[:, 1]] = end[pairs[:, 0]]
    body = scene(start, [(0, 1, "strut", 1.0, 1.0)])
    one = cgff_cli.solve(body)
    words = cautions(Found(body, one.structure, end, one.forces, one.slack, one.strains, 0.0))[-1]
    assert words.startswith("fallen together: ")
    assert "(4 pairs in all)" in words
    a, b = sorted(min(pairs.tolist(), key=min))
    assert f"nodes 'n{a}' and 'n{b}', " in words


def test_what_did_not_converge_is_doubted_just_the_same():
    result = cgff_cli.solve(hung(0.001), max_iterations=0)
    assert not result.converged
    assert kinds(result) == ["units", "strain"]


def test_numbers_without_end_are_no_reason_to_fail():
    one = cgff_cli.solve(shipped("prism"))
    for odd in (np.nan, np.inf):
        shape, column = np.full((6, 3), odd), np.full(12, odd)
        cautions(Found(one.source, one.structure, shape, column, one.slack, column, odd))
