"""The stopping tests one by one, in their order, and the rounding floor against forty digits."""

from types import SimpleNamespace

import mpmath
import numpy as np
import pytest

import cgff_cli
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.cgff import run_of
from cgff_cli.solvers.descent import iterates
from cgff_cli.solvers.objectives import Energy
from cgff_cli.solvers.rescues import onward
from cgff_cli.solvers.stopping import Balance, Gauge, Verdict, Watch
from cgff_cli.structure import from_scene
from tests.bodies import exact, random_body
from tests.solvers.scenes import SHIPPED, shipped
from tests.states import by_node, mechanics_of


class Told(Gauge):
    """A gauge that measures what it is told: residuals over a force of 1, and one floor."""

    def __init__(self, floor: float = 1e-14):
        super().__init__(mechanics_of(random_body(0)))
        self.floor = floor

    def may_end(self, state, tolerance):
        return True

    def is_balanced(self, state, tolerance):
        return state.norm <= tolerance

    def measure(self, state):
        return Balance(state.norm, 1.0, self.floor, False)


def judged(watch: Watch, residual: float, iteration: int):
    return watch.judge(SimpleNamespace(norm=residual), iteration)


@pytest.mark.parametrize(
    ("residual", "iteration", "verdict"),
    [
        (0.5, 0, None),
        (1e-8, 0, Verdict.CONVERGED),
        (1.1e-8, 0, None),
        (1e-9, 10, Verdict.CONVERGED),
        (0.5, 9, None),
        (0.5, 10, Verdict.MAX_ITERATIONS),
        (float("nan"), 10, Verdict.DIVERGED),
        (float("inf"), 10, Verdict.DIVERGED),
    ],
)
def test_the_first_test_that_holds_gives_the_verdict(residual, iteration, verdict):
    assert judged(Watch(Told(), 1e-8, 10), residual, iteration) is verdict


def test_the_floor_counts_as_reached_after_three_iterations_without_halving_the_residual():
    watch = Watch(Told(), 1e-16, 100)
    residuals = [1e-8, 0.9e-14, 0.8e-14, 0.9e-14, 0.7e-14]
    verdicts = [judged(watch, residual, row) for row, residual in enumerate(residuals)]
    assert verdicts == [None, None, None, None, Verdict.ROUNDING_FLOOR]


def test_while_the_residual_still_halves_the_floor_is_not_reached():
    watch = Watch(Told(), 1e-30, 100)
    assert {judged(watch, 1e-14 / 2.1**row, row) for row in range(20)} == {None}


def test_above_the_floor_no_patience_ends_but_it_is_stuck():
    watch = Watch(Told(), 1e-16, 100)
    assert {judged(watch, 1e-12, row) for row in range(50)} == {None}
    assert watch.is_stuck


@pytest.mark.parametrize("tolerance", [1e-2, 1e-6, 1e-10, 1e-14])
@pytest.mark.parametrize("name", SHIPPED)
def test_the_cheap_bound_never_hides_an_end(name, tolerance):
    run, _ = run_of(from_scene(shipped(name)), SolveOptions(tolerance=tolerance))
    for iterate in iterates(run, onward):
        gauge, state = run.watch.gauge, iterate.state
        balance = gauge.measure(state)
        ends = balance.residual <= tolerance * balance.reference or balance.at_floor
        assert gauge.may_end(state, tolerance) or not ends


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("seed", range(20))
def test_the_rounding_floor_bounds_the_rounding_of_the_forces_and_is_not_far_above(seed, d):
    structure = random_body(seed, d)
    mechanics = mechanics_of(structure)
    state = mechanics.at(mechanics.start)
    eta = -by_node(mechanics, state.g)
    with mpmath.workdps(40):
        X = exact(structure.coordinates)
        total = [[mpmath.mpf(f) for f in load] for load in structure.loads.tolist()]
        for e, (i, j) in enumerate(zip(structure.start, structure.end, strict=True)):
            V = [b - a for a, b in zip(X[i], X[j], strict=True)]
            length = mpmath.sqrt(sum(v * v for v in V))
            stretch = length - float(structure.rest_lengths[e])
            if not structure.tension_only[e] or stretch >= 0:
                for axis, v in enumerate(V):
                    total[i][axis] += float(structure.stiffness[e]) * stretch * v / length
                    total[j][axis] -= float(structure.stiffness[e]) * stretch * v / length
        rounding = max(
            abs(float(total[row][axis] - float(eta[row, axis])))
            for row, axis in zip(*np.nonzero(structure.free), strict=True)
        )
    floor = Gauge(mechanics).rounding_floor(state)
    assert rounding <= floor
    assert floor < 1e-13 * structure.stiffness.sum()


@pytest.mark.parametrize(
    "options",
    [
        pytest.param({"objective": "residual"}, id="residual"),
        pytest.param({"method": "table1"}, id="table1"),
        pytest.param({"objective": "residual", "preconditioner": "none"}, id="residual, no preconditioner"),
    ],
)
@pytest.mark.parametrize("name", SHIPPED)
def test_evaluations_are_the_shapes_at_which_forces_were_worked_out(monkeypatch, name, options):
    shapes: list[np.ndarray] = []
    at = Mechanics.at

    def counted(self, X):
        shapes.append(X)
        return at(self, X)

    monkeypatch.setattr(Mechanics, "at", counted)
    result = cgff_cli.solve(shipped(name), **options)
    assert result.counts["evaluations"] == len(shapes)


@pytest.mark.parametrize("name", SHIPPED)
def test_under_the_energy_a_trial_on_a_line_counts_as_an_evaluation_though_it_may_form_no_state(
    monkeypatch, every_scene_is_large, name
):
    trials: list[float] = []
    shapes: list[np.ndarray] = []
    line, at = Energy.line, Mechanics.at

    def counted_line(self, state, d):
        phi = line(self, state, d)
        return lambda a: (trials.append(a), phi(a))[1]

    def counted_at(self, X):
        shapes.append(X)
        return at(self, X)

    monkeypatch.setattr(Energy, "line", counted_line)
    monkeypatch.setattr(Mechanics, "at", counted_at)
    result = cgff_cli.solve(shipped(name), preconditioner="tangent", analysis="never")
    assert result.counts["evaluations"] == len(shapes) + len(trials)
