"""Table IV: the triangular prism.

Zhao, Liu, Li, Jin, Sun, "Form-finding of Tensegrity Structures Utilizing a Nonlinear Fletcher-Reeves
Conjugate Gradient Method". The CGFF column is a closed form to its last digit; the FDM column is no
equilibrium of this graph. EA and rest lengths are not printed: those of structures/prism.yaml are ours.
"""

from math import pi, sin, sqrt

import numpy as np
import pytest

from tests.paper.printed import HALF_A_DIGIT as PRINTED
from tests.paper.printed import TABLE_4, TRIANGLES, VERTICALS
from tests.shapes import (
    best_self_stress,
    distance_difference,
    element_lengths,
    node_difference,
    out_of_balance,
    solve_structure,
    twist,
)

CGFF, FDM, CABLES, STRUTS = TABLE_4
PAIRS = TABLE_4.pairs

HEIGHT = sqrt(49.0 - 12.0 * sin(75.0 * pi / 180.0) ** 2)
VERTICAL = sqrt(HEIGHT**2 + 12.0 * sin(15.0 * pi / 180.0) ** 2)
GROUPS = np.repeat([0, 1, 2], [6, 3, 3])
LENGTHS = np.array([3.0, VERTICAL, 7.0])[GROUPS]
DENSITIES = np.array([1.0 / sqrt(3.0), 1.0, -1.0])[GROUPS]


@pytest.fixture(scope="module")
def solved():
    return solve_structure("prism", tolerance=1e-12)


def test_the_printed_column_is_the_closed_form():
    assert element_lengths(CGFF, PAIRS) == pytest.approx(LENGTHS, abs=2 * PRINTED)
    assert CGFF[3:, 2] == pytest.approx(HEIGHT, abs=PRINTED)
    assert twist(CGFF, STRUTS) == pytest.approx(150.0, abs=1e-3)
    q, residual = best_self_stress(CGFF, PAIRS)
    assert residual < 1e-14
    assert q / q[6] == pytest.approx(DENSITIES, abs=2 * PRINTED)


def test_the_fdm_column_is_not_an_equilibrium():
    # |U q| / |t| of the best force densities there are, 2e-2; the closed form needs 150 degrees.
    assert best_self_stress(FDM, PAIRS)[1] == pytest.approx(1.92e-2, abs=0.5e-4)
    assert twist(FDM, STRUTS) == pytest.approx(147.4, abs=0.05)


def test_the_fdm_column_is_another_size_of_prism():
    assert np.ptp(FDM[:, 2]) == pytest.approx(5.9598, abs=PRINTED)
    mean_lengths = [element_lengths(FDM, group).mean() for group in (TRIANGLES, VERTICALS, STRUTS)]
    assert mean_lengths == pytest.approx([2.8371, 6.0101, 6.7384], abs=PRINTED)


def test_solving_gives_the_printed_shape_to_print_precision(solved):
    assert solved.converged
    assert node_difference(solved.coordinates, CGFF, reflect=False) <= PRINTED
    assert distance_difference(solved.coordinates, CGFF) <= 2 * PRINTED  # two rounded ends


def test_solving_gives_the_closed_form_far_beyond_print_precision(solved):
    assert solved.lengths == pytest.approx(LENGTHS, abs=1e-9)
    assert twist(solved.coordinates, STRUTS) == pytest.approx(150.0, abs=1e-8)


def test_the_forces_are_those_of_the_closed_form(solved):
    assert solved.force_densities == pytest.approx(DENSITIES, abs=1e-9)
    assert solved.forces == pytest.approx(DENSITIES * LENGTHS, abs=1e-9)
    assert np.abs(out_of_balance(solved.coordinates, PAIRS, solved.force_densities)).max() < 1e-10


def test_the_answer_is_super_stable_with_one_self_stress_and_one_mechanism(solved):
    found = {key: solved.analysis[key] for key in ("nullity_D", "self_stress_states", "mechanisms")}
    assert found == {"nullity_D": 4, "self_stress_states": 1, "mechanisms": 1}
    assert solved.analysis["stable"] is True
    assert solved.analysis["super_stable"] is True
    assert solved.energy == pytest.approx(0.742615427, abs=0.5e-9)
