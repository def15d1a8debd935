"""Rank conditions, states of self-stress and mechanisms of structures where counting tells them."""

from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

import cgff_cli
from cgff_cli.analysis.ranks import rank_tolerance
from cgff_cli.scene.read import from_dict
from tests.analysis.scenes import ACROSS, AROUND, CORNERS, unstressed
from tests.bodies import scene
from tests.closed_forms.references import expanded_octahedron, hanging_chain, prism
from tests.solvers.scenes import shipped

TETRAHEDRON = [(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.2, 0.3, 1.0)]
K4 = list(combinations(range(4), 2))
TRIANGLE = [(0, 1), (1, 2), (2, 0)]
TWO_TRIANGLES = [*CORNERS[:3], (5.0, 0.0), (6.0, 0.0), (5.0, 1.0)]
LINE = [(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)]


def counts(scene: "cgff_cli.Scene", **options: object) -> tuple[int, int, int]:
    """Return states of self-stress, mechanisms and rigid motions."""
    found = cgff_cli.solve(scene, **options).analysis
    return found["self_stress_states"], found["mechanisms"], found["rigid_motions"]


@pytest.mark.parametrize(
    ("structure", "expected"),
    [
        pytest.param(unstressed(CORNERS[:3], TRIANGLE), (0, 0, 3), id="triangle"),
        pytest.param(unstressed(CORNERS, AROUND), (0, 1, 3), id="square"),
        pytest.param(unstressed(CORNERS, AROUND + ACROSS[:1]), (0, 0, 3), id="square, one diagonal"),
        pytest.param(unstressed(CORNERS, AROUND + ACROSS), (1, 0, 3), id="K4 in the plane"),
        pytest.param(unstressed(TETRAHEDRON, K4), (0, 0, 6), id="K4 in space"),
        pytest.param(unstressed(TETRAHEDRON, [*K4, (1, 0)]), (1, 0, 6), id="tetrahedron, one side doubled"),
        pytest.param(unstressed(TETRAHEDRON, AROUND), (0, 2, 6), id="skew quadrilateral"),
        pytest.param(
            unstressed(TWO_TRIANGLES, [*TRIANGLE, (3, 4), (4, 5), (5, 3)]), (0, 3, 3), id="two parts"
        ),
        pytest.param(
            unstressed(LINE, [(0, 1), (1, 2)], {0: "xy", 2: "xy"}), (1, 1, 0), id="line between pins"
        ),
        pytest.param(unstressed(LINE, TRIANGLE), (1, 1, 3), id="flattened triangle"),
        pytest.param(
            unstressed(CORNERS[:3], [(0, 1), (1, 2)], {0: "xy", 2: "xy"}), (0, 0, 0), id="anchored V"
        ),
        pytest.param(unstressed(CORNERS[:2], [(0, 1)], {0: "xy"}), (0, 0, 1), id="pinned bar"),
        pytest.param(
            unstressed(CORNERS[:2], [(0, 1)], {0: "xy", 1: "xy"}), (1, 0, 0), id="bar held at both ends"
        ),
        pytest.param(shipped("prism"), (1, 1, 6), id="prism"),
        pytest.param(shipped("octahedron"), (1, 1, 6), id="octahedron"),
        pytest.param(shipped("hexagon"), (1, 1, 3), id="hexagon"),
        pytest.param(shipped("x-module"), (1, 0, 3), id="X-module"),
        pytest.param(shipped("bracket"), (0, 0, 0), id="bracket"),
        pytest.param(from_dict(hanging_chain(4).scene("paper")), (0, 6, 2), id="hanging chain"),
    ],
)
def test_states_of_self_stress_mechanisms_and_rigid_motions(structure, expected):
    assert counts(structure) == expected


@pytest.mark.parametrize("n", range(3, 13))
def test_every_prism_has_one_self_stress_and_maxwells_count_of_mechanisms(n):
    reference = from_dict(prism(n).scene("paper"))
    assert counts(reference) == (1, 6 * n - 4 * n + 1 - 6, 6)


@pytest.mark.parametrize("reference", [prism(3), prism(7), expanded_octahedron()])
def test_a_prestressed_structure_in_space_meets_both_rank_conditions(reference):
    found = cgff_cli.solve(from_dict(reference.scene("paper", 0.05, 1))).analysis
    assert (found["nullity_D"], found["nullity_U"]) == (4, 1)
    assert (found["condition_D"], found["condition_U"]) == (True, True)


def test_a_structure_in_the_plane_needs_only_three():
    found = cgff_cli.solve(shipped("x-module")).analysis
    assert (found["nullity_D"], found["condition_D"], found["nullity_U"]) == (3, True, 1)


def test_a_rigid_frame_without_self_stress_fails_the_second_condition():
    found = cgff_cli.solve(unstressed(CORNERS[:3], TRIANGLE)).analysis
    assert (found["nullity_U"], found["condition_U"]) == (0, False)
    assert found["nullity_D"] == 3  # without force D is zero


def test_slack_cables_hold_nothing():
    # The same triangle: with one side a slack cable it is a mechanism.
    sides = [(0, 1, "strut", 10.0, 2.0), (1, 2, "strut", 10.0, 2.0), (2, 0, "cable", 10.0, 5.0)]
    assert counts(scene(CORNERS[:3], sides)) == (0, 1, 3)
    found = cgff_cli.solve(scene(CORNERS[:3], sides)).analysis
    assert found["nullity_U"] == 0  # eq. (6) counts every element


def test_ranks_do_not_depend_on_units():
    reference = from_dict(prism(4).scene("paper"))
    for factor in (1e-9, 1e9):
        scaled = prism(4, radius=factor, height=2.0 * factor)
        assert counts(from_dict(scaled.scene("paper"))) == counts(reference)


@pytest.mark.parametrize(("residual", "tolerance"), [(0.0, 1e-9), (1e-12, 1e-9), (1e-5, 1e-4), (1e-3, 1e-2)])
def test_ranks_are_known_no_better_than_the_balance(residual, tolerance):
    assert rank_tolerance(residual) == pytest.approx(tolerance)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7, 1e-11])
def test_a_prism_solved_loosely_still_shows_its_self_stress(tolerance):
    # A start 1 % off, so that the loose answers are truly loose.
    start = from_dict(prism(3).scene("paper", 0.01, 2))
    result = cgff_cli.solve(start, tolerance=tolerance)
    loose = max(1e-9, 10.0 * result.residual["relative"])
    assert result.analysis["rank_tolerance"] == pytest.approx(loose, rel=1e-12)
    assert counts(start, tolerance=tolerance) == (1, 1, 6)
    assert result.analysis["nullity_D"] == 4


def test_ranks_are_told_of_shapes_that_are_not_balanced_too():
    found = cgff_cli.solve(shipped("prism"), max_iterations=2).analysis
    assert (found["self_stress_states"], found["mechanisms"]) == (0, 0)  # as of twelve bars anywhere
    assert found["nullity_U"] is not None
    assert np.isfinite(found["rank_tolerance"])
    assert found["stable"] is None


@pytest.mark.parametrize("seed", range(10))
def test_without_prestress_no_rank_is_left_to_rounding(seed):
    """The prism at its own lengths, turned: forces are rounding errors, D is zero, U is what it was."""
    solved = cgff_cli.solve(shipped("prism"), tolerance=1e-14)
    turn = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))[0]
    X = solved.coordinates @ turn
    groups = tuple(
        replace(group, rest_length=np.linalg.norm(X[group.pairs[:, 0]] - X[group.pairs[:, 1]], axis=1))
        for group in solved.source.groups
    )
    at_rest = replace(solved.source, coordinates=X, groups=groups)
    assert counts(at_rest) == (1, 1, 6)
    assert cgff_cli.solve(at_rest).analysis["nullity_D"] == 6


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("d", [2, 3])
def test_one_bar_never_has_less_than_no_mechanism(d, seed):
    rng = np.random.default_rng(seed)
    X = rng.normal(size=(2, d)) * 10.0 ** rng.integers(-6, 6)
    for axes in ("x", "xy", "xyz"[:d]):
        for kind in ("cable", "strut"):
            held = scene(X, [(0, 1, kind, 10.0, 0.7)], {0: "xyz"[:d], 1: axes})
            states, mechanisms, rigid = counts(held)
            assert min(states, mechanisms, rigid) >= 0


def test_a_bar_along_its_supports_has_a_column_of_rounding_and_no_rank():
    # Relative to itself it would have full rank, and with the rotation one mechanism less than none.
    bar = scene([(0.0, 0.0), (1.0, 1e-17)], [(0, 1, "strut", 10.0, 1.0)], {0: "xy", 1: "x"})
    assert counts(bar) == (1, 0, 1)
