"""The energy and eq. (10): gradients, and changes and slopes along a line, against forty digits."""

import mpmath
import numpy as np
import pytest

from cgff_cli.solvers.objectives import OBJECTIVES
from cgff_cli.solvers.stopping import Gauge
from tests.bodies import Structure, body, energy_by_loop, exact, random_body
from tests.states import mechanics_of

STEPS = [2.0**-n for n in range(8, 12)]
NAMES = list(OBJECTIVES)


def residual_by_loop(structure: Structure, X: object) -> mpmath.mpf:
    """Return half the squared residual over the free directions, element by element."""
    total = [[mpmath.mpf(f) for f in load] for load in structure.loads.tolist()]
    for e in range(len(structure.start)):
        i, j = int(structure.start[e]), int(structure.end[e])
        V = [there - here for here, there in zip(X[i], X[j], strict=True)]
        l = mpmath.sqrt(sum(v * v for v in V))
        stretch = l - float(structure.rest_lengths[e])
        if structure.tension_only[e] and stretch < 0:
            continue
        for axis, v in enumerate(V):
            pull = float(structure.stiffness[e]) * stretch * v / l
            total[i][axis] += pull
            total[j][axis] -= pull
    free = zip(*np.nonzero(structure.free), strict=True)
    return sum(total[row][axis] ** 2 for row, axis in free) / 2


LOOPS = {"energy": energy_by_loop, "residual": residual_by_loop}


def setting(seed: int, name: str, d: int = 3):
    """Return mechanics, objective, a state and a direction over its free directions."""
    mechanics = mechanics_of(random_body(seed, d))
    direction = np.random.default_rng(seed).normal(size=mechanics.start.shape) * mechanics.mask
    return mechanics, OBJECTIVES[name](), mechanics.at(mechanics.start), direction


def where(state):
    """Return a state's shape as exact numbers, node by node."""
    return exact(state.mechanics.shape(state.X))


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("seed", range(4))
def test_the_value_is_that_of_a_loop(seed, name):
    mechanics, objective, state, _ = setting(seed, name)
    expected = float(LOOPS[name](mechanics.structure, where(state)))
    assert objective.value(state) == pytest.approx(expected, rel=1e-13)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("seed", range(4))
def test_remainders_after_the_gradient_fall_with_slope_two(seed, d, name):
    mechanics, objective, state, direction = setting(seed, name, d)
    gradient = objective.gradient(state)
    assert not gradient[mechanics.mask == 0.0].any()
    slope = np.vdot(gradient, direction)
    remainders = [objective.change(state, mechanics.at(state.X + h * direction)) - h * slope for h in STEPS]
    assert -np.diff(np.log2(np.abs(remainders))) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("a", [1e-3, 0.3, 2.0])
def test_a_line_tells_the_change_and_slope_at_the_point_itself(a, seed, name):
    mechanics, objective, state, direction = setting(seed, name)
    trial, there = objective.line(state, direction)(a), mechanics.at(state.X + a * direction)
    size = abs(objective.value(there)) + abs(objective.value(state))
    assert trial.step == a
    assert trial.change == pytest.approx(objective.change(state, there), abs=1e-13 * size)
    slope = np.vdot(objective.gradient(there), direction)
    assert trial.slope == pytest.approx(slope, abs=1e-12 * size)


@pytest.mark.parametrize("seed", range(4))
def test_the_closed_form_of_large_scenes_is_the_line_that_states_tell(every_scene_is_large, seed):
    mechanics, objective, state, direction = setting(seed, "energy")
    for a in (0.0, 1e-3, 0.3, 2.0):
        trial, there = objective.line(state, direction)(a), mechanics.at(state.X + a * direction)
        assert trial.there is None
        assert trial.change == pytest.approx(objective.change(state, there), rel=1e-12, abs=1e-13)
        assert trial.slope == pytest.approx(np.vdot(there.g, direction), rel=1e-11)


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("seed", range(4))
def test_the_curvature_is_how_the_slope_along_a_line_changes(seed, name):
    _, objective, state, direction = setting(seed, name)
    line, h = objective.line(state, direction), 1e-6
    change = (line(h).slope - line(-h).slope) / (2.0 * h)
    if name == "residual":  # but for second derivatives of eta
        there = [state.mechanics.at(state.X + s * direction) for s in (h, -h)]
        change -= np.vdot(state.g, there[0].tangent_times(direction) - there[1].tangent_times(direction)) / (
            2 * h
        )
    assert objective.curvature(state, direction) == pytest.approx(change, rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("h", [1e-3, 1e-6, 1e-9, 1e-12])
def test_changes_of_the_energy_are_exact_within_the_noise_it_admits(h, seed):
    mechanics, objective, state, direction = setting(seed, "energy")
    there = mechanics.at(state.X + h * direction)
    before, after = (energy_by_loop(mechanics.structure, where(s)) for s in (state, there))
    noise = objective.noise(state)
    assert objective.change(state, there) == pytest.approx(float(after - before), rel=1e-13, abs=noise)
    line = objective.line(state, direction)
    assert line(h).change == pytest.approx(float(after - before), rel=1e-12, abs=2.0 * noise)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("h", [1e-3, 1e-6, 1e-9, 1e-12])
def test_changes_of_the_squared_residual_are_exact_to_the_rounding_of_the_forces(h, seed):
    mechanics, objective, state, direction = setting(seed, "residual")
    there = mechanics.at(state.X + h * direction)
    before, after = (residual_by_loop(mechanics.structure, where(s)) for s in (state, there))
    floor = Gauge(mechanics).rounding_floor(state)
    rounding = 4.0 * floor * np.abs(state.g).sum()
    assert objective.change(state, there) == pytest.approx(float(after - before), rel=1e-13, abs=rounding)


def test_an_element_that_does_not_move_adds_nothing_to_a_change_however_much_energy_it_holds():
    # The held element stores 5e15, the moved one changes by less than the spacing of doubles there.
    points = [(0.0, 0.0), (2.0, 0.0), (0.0, 1.0)]
    bars = [(0, 1, "strut", 1e16, 1.0), (0, 2, "strut", 1.0, 0.5)]
    mechanics = mechanics_of(body(points, bars, {0: "xy", 1: "xy"}))
    objective = OBJECTIVES["energy"]()
    state, there = mechanics.at(np.array([[0.0], [1.0]])), mechanics.at(np.array([[0.0], [1.125]]))
    assert objective.value(there) - objective.value(state) == 0.0
    assert objective.change(state, there) == (0.625**2 - 0.5**2) / 2.0
    direction = np.array([[0.0], [1.0]])
    assert objective.line(state, direction)(0.125).change == (0.625**2 - 0.5**2) / 2.0
