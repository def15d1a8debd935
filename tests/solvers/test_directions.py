"""Conjugate gradient directions against their textbook formulas."""

from fractions import Fraction

import numpy as np
import pytest

from cgff_cli.options import OPTIONS
from cgff_cli.solvers.directions import RULES, Point

# Whole numbers, so that the formulas can be worked out as fractions.
G, Z = np.array([[3.0, -1.0], [2.0, 4.0]]), np.array([[1.0, -2.0], [5.0, 1.0]])
G_OLD, Z_OLD = np.array([[1.0, 2.0], [-3.0, 1.0]]), np.array([[2.0, 1.0], [-1.0, 3.0]])
D = np.array([[-2.0, 1.0], [4.0, -7.0]])
GZ, GZ_OLD, ZY, DY = 3 + 2 + 10 + 4, 2 + 2 + 3 + 3, 2 + 6 + 25 + 3, -4 - 3 + 20 - 21


def told(rule, g, z, g_old, z_old, d):
    """Return the coefficients of z, the old direction and M^-1 y."""
    new, old = Point(g, z, float(np.vdot(g, z))), Point(g_old, z_old, float(np.vdot(g_old, z_old)))
    return RULES[rule](new, old, d, np.asarray)


@pytest.mark.parametrize(
    ("rule", "beta"),
    [
        ("FR", Fraction(GZ, GZ_OLD)),
        ("PR+", Fraction(ZY, GZ_OLD)),
        ("HS", Fraction(ZY, DY)),
        ("DY", Fraction(GZ, DY)),
    ],
)
def test_a_rule_is_its_formula(rule, beta):
    assert told(rule, G, Z, G_OLD, Z_OLD, D) == pytest.approx((-1.0, float(beta), 0.0), rel=1e-15)


def test_the_plus_of_polak_and_ribiere_keeps_it_from_turning_negative():
    assert told("PR+", G_OLD / 2, G_OLD / 2, G_OLD, G_OLD, -G_OLD)[1] == 0.0
    assert told("HS", G_OLD / 2, G_OLD / 2, G_OLD, G_OLD, -G_OLD)[1] < 0.0


@pytest.mark.parametrize("rule", list(RULES))
def test_a_rule_over_nothing_is_zero_and_not_nan(rule):
    nothing = np.zeros((2, 2))
    assert told(rule, G, Z, nothing, nothing, nothing)[1] == 0.0


def test_every_rule_is_an_option_and_every_option_a_rule():
    assert tuple(RULES) == OPTIONS["cg_beta"].metadata["allowed"]


@pytest.mark.parametrize("preconditioned", [False, True])
def test_on_a_quadratic_with_exact_steps_all_rules_agree_and_end_after_n_steps(preconditioned):
    rng = np.random.default_rng(4)
    A = rng.normal(size=(5, 5))
    A = A @ A.T + np.eye(5)
    inverse = np.diag(rng.uniform(0.5, 2.0, 5)) if preconditioned else np.eye(5)
    x = rng.normal(size=5)
    g = A @ x
    d = -inverse @ g
    for step in range(5):
        x = x - (g @ d) / (d @ A @ d) * d
        new = A @ x
        if step == 4:
            break
        betas = {rule: told(rule, new, inverse @ new, g, inverse @ g, d)[1] for rule in RULES}
        assert betas == pytest.approx(dict.fromkeys(RULES, betas["FR"]), rel=1e-8)
        d = betas["FR"] * d - inverse @ new
        g = new
    assert x == pytest.approx(np.zeros(5), abs=1e-10)
