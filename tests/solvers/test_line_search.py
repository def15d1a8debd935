"""Line searches: the steps they return satisfy the strong Wolfe inequalities themselves."""

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from cgff_cli.solvers.line_search import ENOUGH_DECREASE, Goal, strong_wolfe
from cgff_cli.solvers.objectives import OBJECTIVES, Trial
from tests.bodies import random_body
from tests.states import mechanics_of

firsts = st.sampled_from([1e-6, 1e-3, 0.1, 1.0, 30.0, 1e4])


@pytest.mark.parametrize("name", list(OBJECTIVES))
@settings(max_examples=60, deadline=None, derandomize=True)
@given(
    seed=st.integers(0, 2**32 - 1), d=st.sampled_from([2, 3]), first=firsts, c2=st.sampled_from([0.1, 0.4])
)
def test_steps_decrease_enough_and_end_where_the_line_is_flat(name, seed, d, first, c2):
    mechanics = mechanics_of(random_body(seed, d))
    objective, state = OBJECTIVES[name](), mechanics.at(mechanics.start)
    g = objective.gradient(state)
    noise = np.random.default_rng(seed).normal(size=g.shape) * np.linalg.norm(g)
    direction = 0.3 * noise * mechanics.mask - g
    slope = float(np.vdot(g, direction))
    assume(slope < 0.0)
    goal = Goal(slope, lambda: objective.noise(state), c2)
    line = objective.line(state, direction)
    found, _ = strong_wolfe(line, goal, line(first))
    there = mechanics.at(state.X + found.step * direction)
    rounding = 1e-14 * (abs(objective.value(there)) + abs(objective.value(state)))
    assert found.step > 0.0
    assert objective.change(state, there) <= ENOUGH_DECREASE * found.step * slope + rounding
    assert abs(np.vdot(objective.gradient(there), direction)) <= c2 * abs(slope) * (1.0 + 1e-9)


def polynomial(*coefficients: float):
    """Return phi(a) = sum c_n a^n as a line, and the list of steps that were tried on it."""
    phi = np.polynomial.Polynomial(coefficients)
    tried: list[float] = []

    def line(a: float) -> Trial:
        tried.append(a)
        return Trial(a, float(phi(a) - phi(0.0)), float(phi.deriv()(a)))

    return line, tried


def test_a_first_trial_that_serves_is_taken_as_it_is():
    line, tried = polynomial(0.0, -1.0, 0.5)
    found, more = strong_wolfe(line, Goal(-1.0, lambda: 0.0, 0.1), line(1.05))
    assert (found.step, more, tried) == (1.05, 0, [1.05])


@pytest.mark.parametrize("first", [1e-2, 0.5, 3.0, 100.0])
def test_on_a_parabola_secant_and_cubic_find_the_minimum_at_once(first):
    line, tried = polynomial(0.0, -1.0, 0.5)
    found, more = strong_wolfe(line, Goal(-1.0, lambda: 0.0, 1e-6), line(first))
    assert found.step == pytest.approx(1.0, abs=1e-6)
    assert more == len(tried) - 1 <= 9


def test_a_line_that_falls_for_ever_gives_a_step_that_descends():
    line, _ = polynomial(0.0, -1.0)
    found, _ = strong_wolfe(line, Goal(-1.0, lambda: 0.0, 0.1), line(1.0))
    assert found.step > 1e6


def test_a_kink_between_two_slopes_gives_the_last_step_that_descends():
    def line(a: float) -> Trial:  # |a - 1| has no flat point
        return Trial(a, abs(a - 1.0) - 1.0, -1.0 if a < 1.0 else 1.0)

    found, _ = strong_wolfe(line, Goal(-1.0, lambda: 0.0, 0.1), line(3.0))
    assert 0.9 < found.step <= 1.0


def test_a_line_that_only_rises_gives_no_step():
    def line(a: float) -> Trial:
        return Trial(a, a, 1.0)

    assert strong_wolfe(line, Goal(-1.0, lambda: 0.0, 0.1), line(1.0))[0].step == 0.0


def test_where_changes_are_rounding_error_slopes_alone_decide():
    def line(a: float) -> Trial:
        return Trial(a, 3e-16, 1e-13 * (a - 1.0))

    assert strong_wolfe(line, Goal(-1e-13, lambda: 0.0, 0.1), line(0.3))[0].step == 0.0
    assert strong_wolfe(line, Goal(-1e-13, lambda: 1e-15, 0.1), line(0.3))[0].step == pytest.approx(1.0)
