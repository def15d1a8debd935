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

from collections.abc import Iterator

import numpy as np

from cgff_cli.mechanics.frame import UNSCALED
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import DEFAULTS, SolveOptions
from cgff_cli.solvers.directions import Point, fletcher_reeves
from cgff_cli.solvers.line_search import TENFOLD
from cgff_cli.solvers.objectives import Residual
from cgff_cli.solvers.run import START, Iterate, Move
from cgff_cli.solvers.solution import History, Observer, Solution
from cgff_cli.solvers.stopping import NEGLIGIBLE, Gauge, Verdict
from cgff_cli.structure import Structure


def form_find(structure: Structure, options: SolveOptions, observer: Observer | None = None) -> Solution:
    """Return where Table I ends from the structure's start shape, judged by the forces it leaves."""
    run = TableOne(structure, options)
    history = History(run.mechanics, run.objective, observer)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        try:
            for iterate in run.iterates():
                history.add(iterate)
            verdict = run.judged()
        except KeyboardInterrupt:
            verdict = Verdict.INTERRUPTED
        return Solution(run.state, verdict, options.tolerance, run.evaluations, record=history)


class TableOne:
    """One run of it, in the user's own units and place."""

    def __init__(self, structure: Structure, options: SolveOptions):
        self.mechanics, self.options = Mechanics(structure, UNSCALED), options
        self.objective = Residual()
        self.state = self.mechanics.at(self.mechanics.start)
        self.evaluations = 1
        self.ending = Verdict.STEP_VANISHED

    def iterates(self) -> Iterator[Iterate]:
        """Yield every accepted shape, the start first, until its own test or a limit ends it."""
        alpha, b, k, failed = self.options.alpha, self.options.step_factor, 0, 0
        f, g = self.objective.value(self.state), self.objective.gradient(self.state)
        d = -g
        yield Iterate(k, self.state, START, self.evaluations)
        while True:
            step = alpha * norm(d)
            if not step < float("inf"):
                self.ending = Verdict.DIVERGED
                return
            if step <= self.options.eps:
                return
            if k >= self.options.max_iterations or failed >= TENFOLD * DEFAULTS.max_iterations:
                self.ending = Verdict.MAX_ITERATIONS
                return
            there = self.mechanics.at(self.state.X + alpha * d)
            self.evaluations += 1
            f_there = self.objective.value(there)
            if not f_there < f:
                alpha *= b
                failed += 1
                continue
            old = Point(g, g, float(np.vdot(g, g)))
            self.state, f, g = there, f_there, self.objective.gradient(there)
            _, cg_beta, _ = fletcher_reeves(Point(g, g, float(np.vdot(g, g))), old, d, np.asarray)
            d = cg_beta * d - g
            k += 1
            yield Iterate(k, there, Move(step, alpha, cg_beta, False), self.evaluations)
            alpha /= b

    def judged(self) -> Verdict:
        """Return what was really reached when the loop ended."""
        gauge = Gauge(self.mechanics)
        balance = gauge.measure(self.state)
        reached = balance.reached(self.options.tolerance)
        if reached is not None:
            return reached
        force = balance.residual * gauge.largest_stiffness
        flat = float(np.abs(self.objective.gradient(self.state)).max()) <= NEGLIGIBLE * force
        return Verdict.STATIONARY if flat and self.ending is Verdict.STEP_VANISHED else self.ending
