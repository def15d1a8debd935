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


def drawn(seed):
    """Return points and a direction that no line search has touched, and M^-1."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(4, 4))
    inverse = root @ root.T + 0.1 * np.eye(4)
    g, g_old, d = (rng.normal(size=4) * 10.0 ** rng.integers(-6, 7) for _ in range(3))
    points = [Point(each, inverse @ each, float(each @ inverse @ each)) for each in (g, g_old)]
    return *points, d, lambda y: inverse @ y


@pytest.mark.parametrize("rule", ["TT", "SP"])
def test_three_terms_and_the_spectral_rule_go_down_as_steeply_as_the_gradient_whatever_the_line_search(rule):
    for seed in range(100):
        new, old, d, solved = drawn(seed)
        a, b, c = RULES[rule](new, old, d, solved)
        parts = [a * new.gz, b * float(new.g @ d), c * float(new.z @ (new.g - old.g))]
        whole = sum(map(abs, parts))
        assert sum(parts) == pytest.approx(-new.gz, rel=1e-12, abs=1e-14 * whole)


def test_hager_and_zhang_goes_down_seven_eighths_as_steeply_at_least_whatever_the_line_search():
    for seed in range(100):
        new, old, d, solved = drawn(seed)
        a, b, _ = RULES["HZ"](new, old, d, solved)
        parts = [a * new.gz, b * float(new.g @ d)]
        assert sum(parts) <= -0.875 * new.gz + 1e-12 * sum(map(abs, parts))


def test_three_terms_and_the_spectral_rule_are_their_formulas():
    gd = -6 - 1 + 8 - 28
    three = (-1.0, ZY / GZ_OLD, -gd / GZ_OLD)
    assert told("TT", G, Z, G_OLD, Z_OLD, D) == pytest.approx(three, rel=1e-15)
    assert told("SP", G, Z, G_OLD, Z_OLD, D) == pytest.approx((-1 - gd / GZ_OLD, GZ / GZ_OLD, 0.0), rel=1e-15)


def test_hager_and_zhang_is_its_formula_down_to_its_bound():
    yy = 4 + 9 + 25 + 9  # told() takes M^-1 y for y
    beta = Fraction(ZY, DY) - Fraction(2 * yy * (-6 - 1 + 8 - 28), DY**2)
    assert told("HZ", G, Z, G_OLD, Z_OLD, D)[1] == pytest.approx(float(beta), rel=1e-15)
    g_old, d = np.array([1.0, 0.0]), np.array([-1000.0, 0.0])
    g = np.array([-2.0, 0.0])  # <d, y> = 3000, beta = 6 / 3000 - 2 * 9 * 2000 / 3000^2 = -0.002
    assert told("HZ", g, g, g_old, g_old, d)[1] == pytest.approx(-0.002)
    g_old, g = 100.0 * g_old, 100.0 * g
    assert told("HZ", g, g, g_old, g_old, d / 1000.0)[1] == pytest.approx(-100.0)  # -1 / (1 * 0.01), not -200


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
