"""The paper's Table I, to the letter, for comparison; it is not a method to trust.

    d_0 = -grad f(X_0)
    repeat  X_{k+1} = X_k + alpha d_k
            if f(X_{k+1}) < f(X_k):  d_{k+1} = -grad f_{k+1} + beta d_k, beta Fletcher-Reeves;
                                     alpha <- alpha / b;  k <- k + 1
            else:                    alpha <- alpha b
    until   |alpha d_k| <= eps

with f = |eta|^2 / 2, eq. (10). The paper's "d_k" of the stopping test already contains alpha; b is one
constant step factor; alpha is applied once. Nothing is centred, scaled, preconditioned or restarted, and a
direction that turns uphill makes alpha shrink until the test holds. However it ends, the verdict is asked of
the forces: it may say that steps vanished, whatever the test claims.
"""

import numpy as np

from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.directions import fletcher_reeves
from cgff_cli.solvers.objectives import Residual
from cgff_cli.solvers.solution import History, Observer, Solution, Watcher, concluded
from cgff_cli.solvers.stopping import Gauge, Verdict
from cgff_cli.structure import Structure

FLAT = 1e-9
"""Gradient this small against stiffness times residual counts as stationary."""

MOST_FAILED = 20_000
"""Trials that may fail: ten for each iteration of the default limit. With b near 1 they would never end."""


def form_find(
    structure: Structure,
    options: SolveOptions,
    observer: Observer | None = None,
    watcher: Watcher | None = None,
) -> Solution:
    """Return where Table I ends from the structure's start shape, judged by the forces it leaves."""
    run = _Run(Mechanics(structure), options, History(observer, watcher))
    try:
        with np.errstate(over="ignore", invalid="ignore"):
            verdict = run.judged(run.loop())
    except KeyboardInterrupt:
        verdict = Verdict.INTERRUPTED
    centre = run.state.X.mean(axis=0)
    return concluded(
        structure, run.state.X - centre, centre, verdict, options.tolerance, run.history, run.evaluations
    )


class _Run:
    def __init__(self, mechanics: Mechanics, options: SolveOptions, history: History):
        self.mechanics, self.options, self.history = mechanics, options, history
        self.objective = Residual(mechanics)
        self.state = mechanics.at(mechanics.structure.coordinates)
        self.evaluations = 1

    def loop(self) -> Verdict:
        """Run Table I until its own test (told as vanished steps), or a limit, ends it."""
        alpha, b, cg_beta, k, failed = self.options.alpha, self.options.step_factor, 0.0, 0, 0
        f = self.objective.value(self.state)
        g = self.objective.gradient(self.state)
        d = -g
        self._record(k, f, g, 0.0, 0.0, 0.0)
        while True:
            step = alpha * float(np.linalg.norm(d))
            if not step < float("inf"):
                return Verdict.DIVERGED
            if step <= self.options.eps:
                return Verdict.STEP_VANISHED
            if k >= self.options.max_iterations or failed >= MOST_FAILED:
                return Verdict.MAX_ITERATIONS
            there = self.mechanics.at(self.state.X + alpha * d)
            self.evaluations += 1
            f_there = self.objective.value(there)
            if not f_there < f:
                alpha *= b
                failed += 1
                continue
            self.state, f, g_old = there, f_there, g
            g = self.objective.gradient(there)
            cg_beta = fletcher_reeves(g, g, g_old, g_old, d)
            d = cg_beta * d - g
            k += 1
            self._record(k, f, g, step, alpha, cg_beta)
            alpha /= b

    def judged(self, ending: Verdict) -> Verdict:
        """Return what was really reached when the loop ended."""
        gauge = Gauge(self.mechanics)
        balance = gauge.measure(self.state)
        if balance.residual <= self.options.tolerance * balance.reference:
            return Verdict.CONVERGED
        if balance.at_floor:
            return Verdict.ROUNDING_FLOOR
        force = balance.residual * gauge.largest_stiffness
        flat = float(np.abs(self.objective.gradient(self.state)).max()) <= FLAT * force
        return Verdict.STATIONARY if flat and ending is Verdict.STEP_VANISHED else ending

    def _record(self, k: int, f: float, g: np.ndarray, step: float, alpha: float, cg_beta: float) -> None:
        residual = float(np.abs(self.state.free_eta).max())
        norm = float(np.linalg.norm(g))
        self.history.add(k, f, residual, norm, step, alpha, cg_beta, self.evaluations, False)
        if self.history.watcher is not None:
            self.history.watcher(
                k, self.evaluations, self.state.X - self.mechanics.structure.coordinates.mean(axis=0)
            )
