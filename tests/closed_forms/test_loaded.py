"""Anchored and loaded structures whose answer is a formula or the root of one scalar equation."""

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.read import from_dict
from tests.closed_forms.references import (
    LAWS,
    Reference,
    bracket,
    hanging_chain,
    hypar_net,
    stiffness,
    v_height,
)
from tests.shapes import solve_structure

STARTS = [(0.05, 1), (0.1, 2), (0.2, 3)]  # perturbation in mean lengths, seed


def solve(mapping: dict) -> "cgff_cli.Result":
    """Solve a scene given as a mapping, to near the rounding floor."""
    return cgff_cli.solve(from_dict(mapping), tolerance=1e-12)


def assert_same(result: "cgff_cli.Result", reference: Reference) -> None:
    """Coordinates and forces agree to 1e-9 of the largest length or force; nothing may float here."""
    assert result.converged
    size, force = reference.lengths.max(), np.abs(reference.forces).max()
    assert result.coordinates == pytest.approx(reference.coordinates, abs=1e-9 * size)
    assert result.forces == pytest.approx(reference.forces, abs=1e-9 * force)


def one_element(kind: str, law: str, load: float, held: str = "") -> dict:
    """Return an element of rest length 2 and EA 50 along x, from a fixed node to one loaded along x."""
    return {
        "name": "one element",
        "law": law,
        "nodes": {"wall": [0.0, 0.0], "end": [2.1, 0.0 if held else 0.3]},
        "elements": {"bar": {"kind": kind, "EA": 50.0, "rest_length": 2.0, "pairs": [["wall", "end"]]}},
        "supports": {"wall": "xy", **({"end": held} if held else {})},
        "loads": {"end": [load, 0.0]},
    }


def v_shape(kind: str, law: str, rest_length: float, load: float, start: float) -> dict:
    """Return two elements of EA 1000 from supports at x = -3 and 3 to a node under a vertical load."""
    pairs = [["left", "node"], ["right", "node"]]
    return {
        "name": "V",
        "law": law,
        "nodes": {"left": [-3.0, 0.0], "right": [3.0, 0.0], "node": [0.4, start]},
        "elements": {"legs": {"kind": kind, "EA": 1000.0, "rest_length": rest_length, "pairs": pairs}},
        "supports": {"left": "xy", "right": "xy"},
        "loads": {"node": [0.0, load]},
    }


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("kind", ["cable", "strut"])
def test_one_element_stretches_by_force_over_stiffness(kind, law):
    result = solve(one_element(kind, law, load=5.0))
    length = 2.0 + 5.0 / stiffness(law, 50.0, 2.0)
    assert result.converged
    assert result.nodes["end"] == pytest.approx([length, 0.0], abs=1e-9)
    assert result.forces == pytest.approx([5.0], abs=1e-9)


@pytest.mark.parametrize("law", LAWS)
def test_a_guided_strut_shortens_by_force_over_stiffness(law):
    result = solve(one_element("strut", law, load=-5.0, held="y"))
    length = 2.0 - 5.0 / stiffness(law, 50.0, 2.0)
    assert result.converged
    assert result.nodes["end"] == pytest.approx([length, 0.0], abs=1e-9)
    assert result.forces == pytest.approx([-5.0], abs=1e-9)
    assert result.reactions["wall"] == pytest.approx([5.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("rest_length", [2.5, 3.0, 3.7], ids=["taut", "just straight", "sagging"])
def test_a_hanger_sags_to_the_root_of_its_equation(rest_length, law):
    result = solve(v_shape("cable", law, rest_length, load=-50.0, start=-1.0))
    sag = v_height(law, 1000.0, rest_length, 3.0, 50.0, guess=2.0)
    assert result.converged
    assert result.nodes["node"] == pytest.approx([0.0, -sag], abs=1e-9)
    assert result.forces == pytest.approx([25.0 * np.hypot(3.0, sag) / sag] * 2, rel=1e-9)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("start", [-1.0, -6.0], ids=["slack from the start", "taut at the start"])
def test_a_stay_longer_than_its_span_hangs_slack_and_changes_nothing(start, law):
    # The stay, from above to the loaded node, is taut only where the start is far too low.
    hanger = v_shape("cable", law, 3.7, load=-50.0, start=start)
    hanger["nodes"]["top"] = [0.0, 4.0]
    hanger["supports"]["top"] = "xy"
    stay = {"kind": "cable", "EA": 1000.0, "rest_length": 7.0, "pairs": [["top", "node"]]}
    result = solve({**hanger, "elements": {**hanger["elements"], "stay": stay}})
    sag = v_height(law, 1000.0, 3.7, 3.0, 50.0, guess=2.0)
    assert result.converged
    assert result.nodes["node"] == pytest.approx([0.0, -sag], abs=1e-9)
    assert result.slack.tolist() == [False, False, True]
    assert result.forces[2] == 0.0
    assert result.reactions["top"] == pytest.approx([0.0, 0.0], abs=1e-12)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("load", [-50.0, -200.0])
def test_two_leaning_struts_come_down_to_the_root_of_their_equation(load, law):
    result = solve(v_shape("strut", law, 5.0, load=load, start=4.5))
    height = v_height(law, 1000.0, 5.0, 3.0, load, guess=3.9)
    assert result.converged
    assert result.nodes["node"] == pytest.approx([0.0, height], abs=1e-9)
    assert result.forces == pytest.approx([load / 2.0 * np.hypot(3.0, height) / height] * 2, rel=1e-9)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("start", STARTS)
def test_a_chain_hangs_straight_and_each_link_carries_what_is_below(start, law):
    reference = hanging_chain()
    result = solve(reference.scene(law, *start))
    assert_same(result, reference)
    assert result.forces == pytest.approx([5.0, 4.0, 3.0, 2.0, 1.0], abs=1e-9)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("start", STARTS)
def test_a_bracket_shares_its_load_by_the_3_4_5_triangle(start, law):
    result = solve(bracket().scene(law, *start))
    assert_same(result, bracket())
    assert result.reactions["n0"] == pytest.approx([40.0, 0.0], abs=1e-8)
    assert result.reactions["n1"] == pytest.approx([-40.0, 30.0], abs=1e-8)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("load", [0.0, 0.5])
def test_a_saddle_net_balances_a_load_by_its_two_curvatures(load, start, law):
    reference = hypar_net(load=load)
    assert_same(solve(reference.scene(law, *start)), reference)


def test_reactions_of_a_net_carry_all_its_load():
    result = solve(hypar_net(load=0.5).scene("hooke", 0.1, 7))
    assert np.sum(list(result.reactions.values()), axis=0) == pytest.approx([0.0, 0.0, 12.5], abs=1e-8)


def test_the_shipped_bracket_is_the_closed_form():
    assert_same(solve_structure("bracket", tolerance=1e-12), bracket())


def test_the_shipped_net_is_the_closed_form():
    result = solve_structure("cable-net", tolerance=1e-12)
    assert result.converged
    x, y, z = result.coordinates.T
    assert z == pytest.approx(0.1 * (x**2 - y**2), abs=1e-9)
    assert result.coordinates[:, :2] == pytest.approx(np.round(result.coordinates[:, :2]), abs=1e-9)
    assert result.force_densities == pytest.approx([5.0] * 30 + [2.5] * 30, rel=1e-9)
    assert result.energy == pytest.approx(0.552139064, abs=0.5e-9)
    assert not result.slack.any()


def test_the_shipped_octahedron_is_the_closed_form():
    result = solve_structure("octahedron", tolerance=1e-12)
    assert result.converged
    assert result.lengths == pytest.approx([6.0**0.5] * 24 + [4.0] * 6, abs=1e-9)
    assert result.force_densities == pytest.approx([1.0] * 24 + [-1.5] * 6, rel=1e-8)
    assert result.energy == pytest.approx(2.15607314, abs=0.5e-8)
