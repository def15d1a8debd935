"""Free tensegrities in self-stress: from a start off the answer, the closed form comes out."""

from math import pi, sin

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.read import from_dict
from tests.closed_forms.references import (
    LAWS,
    Reference,
    crossed_square,
    expanded_octahedron,
    prism,
)
from tests.shapes import distance_difference, out_of_balance, twist

STARTS = [(0.05, 1), (0.1, 2), (0.2, 3)]  # perturbation in mean lengths, seed


def solved(reference: Reference, law: str, perturbation: float, seed: int) -> "cgff_cli.Result":
    """Solve the reference's scene from a perturbed start, to near the rounding floor."""
    return cgff_cli.solve(from_dict(reference.scene(law, perturbation, seed)), tolerance=1e-12)


def assert_same(result: "cgff_cli.Result", reference: Reference) -> None:
    """Lengths, forces and shape agree to 1e-9 of the largest length or force."""
    assert result.converged
    size, force = reference.lengths.max(), np.abs(reference.forces).max()
    assert result.lengths == pytest.approx(reference.lengths, abs=1e-9 * size)
    assert result.forces == pytest.approx(reference.forces, abs=1e-9 * force)
    assert distance_difference(result.coordinates, reference.coordinates) <= 1e-8 * size


@pytest.mark.parametrize(
    "reference",
    [*(prism(n) for n in range(3, 13)), crossed_square(), crossed_square(2.0, 0.4), expanded_octahedron()],
    ids=[*(f"prism {n}" for n in range(3, 13)), "crossed square", "crossed rhomboid", "expanded octahedron"],
)
def test_the_references_are_in_equilibrium(reference):
    pairs = [pair for members in reference.groups.values() for pair in members.pairs]
    unbalanced = out_of_balance(reference.coordinates, pairs, reference.forces / reference.lengths)
    assert np.abs(unbalanced).max() < 1e-12 * np.abs(reference.forces).max()


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("n", range(3, 13))
def test_prisms_find_their_lengths_and_forces(n, start, law):
    assert_same(solved(prism(n), law, *start), prism(n))


@pytest.mark.parametrize("n", range(3, 13))
def test_prisms_twist_by_a_right_angle_less_half_a_side(n):
    X = solved(prism(n), "paper", 0.1, 4).coordinates
    assert twist(X, [(i, n + i) for i in range(n)]) == pytest.approx(90.0 - 180.0 / n, abs=1e-6)


@pytest.mark.parametrize("n", range(3, 13))
def test_prism_force_densities_have_the_known_ratios(n):
    q = solved(prism(n), "hooke", 0.1, 5).force_densities
    sides, verticals, struts = q[: 2 * n], q[2 * n : 3 * n], q[3 * n :]
    assert sides / verticals[0] == pytest.approx(0.5 / sin(pi / n), rel=1e-8)
    assert struts / verticals[0] == pytest.approx(-1.0, rel=1e-8)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("shear", [0.0, 0.4])
def test_crossed_squares_carry_one_in_cables_and_minus_one_in_struts(shear, start, law):
    reference = crossed_square(2.0, shear)
    result = solved(reference, law, *start)
    assert_same(result, reference)
    assert result.force_densities == pytest.approx([1.0] * 4 + [-1.0] * 2, rel=1e-8)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("start", STARTS)
def test_the_expanded_octahedron_pushes_one_and_a_half_times_as_hard_as_it_pulls(start, law):
    reference = expanded_octahedron()
    result = solved(reference, law, *start)
    assert_same(result, reference)
    q = result.force_densities
    assert q[24:] / q[0] == pytest.approx(-1.5, rel=1e-8)


@pytest.mark.parametrize("law", LAWS)
def test_parallel_struts_of_the_expanded_octahedron_are_half_a_strut_apart(law):
    X = solved(expanded_octahedron(4.0), law, 0.1, 6).coordinates
    middles = X.reshape(6, 2, 3).mean(axis=1)
    assert np.linalg.norm(middles[0::2] - middles[1::2], axis=1) == pytest.approx(2.0, abs=1e-8)
