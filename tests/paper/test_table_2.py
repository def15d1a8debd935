"""Table II: two struts crossed in four cables, in the plane.

Zhao, Liu, Li, Jin, Sun, "Form-finding of Tensegrity Structures Utilizing a Nonlinear Fletcher-Reeves
Conjugate Gradient Method". The paper prints neither EA nor rest lengths: those of
structures/x-module.yaml are back-computed, so what is reproduced is the shape and its self-stress.
"""

import numpy as np
import pytest

from tests.paper.printed import HALF_A_DIGIT as PRINTED
from tests.paper.printed import TABLE_2
from tests.shapes import (
    best_self_stress,
    distance_difference,
    element_lengths,
    node_difference,
    out_of_balance,
    solve_structure,
)

CGFF, FDM, CABLES, STRUTS = TABLE_2
PAIRS = TABLE_2.pairs


@pytest.fixture(scope="module")
def solved():
    return solve_structure("x-module", tolerance=1e-12)


def test_any_four_points_of_the_plane_carry_a_self_stress_so_the_table_tests_no_solver():
    anywhere = np.random.default_rng(2).normal(size=(20, 4, 2))
    assert max(best_self_stress(points, PAIRS)[1] for points in anywhere) < 1e-13


@pytest.mark.parametrize("column", [CGFF, FDM], ids=["CGFF", "FDM"])
def test_both_printed_columns_are_equilibria_with_cables_in_tension_and_struts_in_compression(column):
    q, residual = best_self_stress(column, PAIRS)
    assert residual < 1e-14
    assert (q[:4] > 0.0).all()
    assert (q[4:] < 0.0).all()


def test_the_diagonals_are_the_only_possible_struts():
    # The sign pattern of a convex quadrilateral: opposite sides and diagonals. Joining the nodes in
    # another cycle would put a diagonal among the cables.
    q, _ = best_self_stress(CGFF, PAIRS)
    assert [pair for pair, density in zip(PAIRS, q, strict=True) if density < 0.0] == STRUTS


def test_the_two_columns_are_different_shapes_with_different_force_densities():
    # Force densities survive every affine map, so the columns are not affine images of each other.
    assert distance_difference(CGFF, FDM) == pytest.approx(0.0120, abs=PRINTED)
    ours, theirs = best_self_stress(CGFF, PAIRS)[0], best_self_stress(FDM, PAIRS)[0]
    assert np.abs(ours - theirs).max() == pytest.approx(0.0606, abs=PRINTED)


def test_solving_gives_the_printed_shape_to_print_precision(solved):
    assert solved.converged
    assert node_difference(solved.coordinates, CGFF) <= PRINTED
    assert distance_difference(solved.coordinates, CGFF) <= PRINTED


def test_solving_gives_the_printed_points_to_more_than_print_precision(solved):
    # The rest lengths were computed from the printed decimals and carry 13 digits.
    assert distance_difference(solved.coordinates, CGFF) <= 1e-9


def test_the_forces_are_the_self_stress_of_the_printed_points(solved):
    q, _ = best_self_stress(CGFF, PAIRS)
    assert solved.force_densities == pytest.approx(q, rel=1e-9)
    assert solved.forces == pytest.approx(q * element_lengths(CGFF, PAIRS), rel=1e-9)
    assert np.abs(out_of_balance(solved.coordinates, PAIRS, solved.force_densities)).max() < 1e-11


def test_the_answer_is_super_stable_with_one_self_stress_and_no_mechanism(solved):
    found = {key: solved.analysis[key] for key in ("nullity_D", "self_stress_states", "mechanisms")}
    assert found == {"nullity_D": 3, "self_stress_states": 1, "mechanisms": 0}
    assert solved.analysis["stable"] is True
    assert solved.analysis["super_stable"] is True
    assert solved.energy == pytest.approx(0.0120015390, abs=0.5e-10)
