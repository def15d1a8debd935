"""What rivals are given and watched by: the clock, the tests that stop them, the exact Jacobian."""

from time import sleep

import numpy as np
import pytest

from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.rivals.scipy_solvers import System
from cgff_cli.rivals.task import Stop, Task, Trace, centred
from cgff_cli.solvers.cgff import form_find
from cgff_cli.solvers.stopping import Gauge, Watch
from tests.bodies import random_body


def trace_of(structure, watch=None, time_limit=60.0, distance=None) -> Trace:
    return Trace(Mechanics(centred(structure)), watch, time_limit, distance)


def system_of(structure) -> System:
    groups = np.zeros(len(structure.start), dtype=int)
    best = form_find(structure, SolveOptions(max_iterations=0))
    return System(Task(structure, groups, SolveOptions(), best), trace_of(structure))


def test_the_clock_stands_still_while_a_shape_is_measured():
    structure = random_body(1)
    trace = trace_of(structure, distance=lambda X: sleep(0.05) or 1.0)
    trace.start()
    for k in range(3):
        trace.add(k, k, centred(structure).coordinates)
    assert trace.seconds < 0.05


def test_a_shape_without_finite_size_ends_the_run():
    structure = random_body(1)
    with pytest.raises(Stop) as stop:
        trace_of(structure).add(1, 1, np.full_like(structure.coordinates, np.nan))
    assert stop.value.verdict == "diverged"


def test_evaluations_are_limited():
    structure = random_body(1)
    trace = trace_of(structure, Watch(Gauge(Mechanics(structure)), 1e-12, 5))
    trace.add(4, 4, centred(structure).coordinates)
    with pytest.raises(Stop) as stop:
        trace.add(5, 5, centred(structure).coordinates)
    assert stop.value.verdict == "max_iterations"


@pytest.mark.parametrize("held", [True, False])
@pytest.mark.parametrize("d", [2, 3])
def test_the_jacobians_are_the_derivative_of_the_residual(d: int, held: bool):
    system = system_of(random_body(3, d, held=held, loaded=held))
    x = system.start
    columns = []
    for k in range(len(x)):
        step = np.zeros_like(x)
        step[k] = 1e-6
        columns.append((system.residual(x + step) - system.residual(x - step)) / 2e-6)
    expected = np.array(columns).T
    size = np.abs(expected).max()
    assert np.abs(system.jacobian(x) - expected).max() < 1e-8 * size
    assert np.abs(system.sparse_jacobian(x).toarray() - expected).max() < 1e-8 * size


def test_the_energy_has_the_residual_as_its_gradient():
    system = system_of(random_body(4))
    x, step = system.start, np.random.default_rng(0).normal(size=len(system.start))
    ahead, behind = (system.energy_and_gradient(x + sign * 1e-6 * step)[0] for sign in (1.0, -1.0))
    slope = float(system.energy_and_gradient(x)[1] @ step)
    assert (ahead - behind) / 2e-6 == pytest.approx(slope, rel=1e-7)
