"""The loop of eq. (13): preconditioned conjugate gradients.

z_k = M^-1 g_k                       M: tangent stiffness, shifted until positive definite
d_k = -z_k + beta_k d_{k-1}          beta_FR = <g, z>_k / <g, z>_{k-1}
X_{k+1} = X_k + alpha_k d_k          alpha_k: strong Wolfe
"""

from collections.abc import Callable, Generator, Iterator
from functools import partial

import numpy as np

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import largest, norm
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.directions import RULES, Point
from cgff_cli.solvers.line_search import (
    ENOUGH_DECREASE,
    FLAT_ENOUGH,
    FLAT_ENOUGH_FOR_NEWTON,
    TENFOLD,
    Goal,
    strong_wolfe,
)
from cgff_cli.solvers.objectives import Trial
from cgff_cli.solvers.run import Iterate, Move, Run
from cgff_cli.solvers.stopping import NEGLIGIBLE, WAIT, Verdict

LOST = 1.0 / TENFOLD
"""Restart when <g_k, z_{k-1}> exceeds this share of <g_k, z_k> (Powell 1977, where it is 0.2), or when the
slope along d is flatter than this share of the slope along -z."""

Detour = Generator[Iterate, None, bool]
"""Iterates on a way elsewhere, but for its end; returns whether it leads anywhere."""

Onward = Callable[[Run], Detour]


def iterates(run: Run, onward: Onward) -> Iterator[Iterate]:
    """Yield every iterate of a run, the start first; at its end the run has a verdict.

    onward: moves a run that is stuck, or ended, to where it goes on from, if there is such a place.
    """
    run.state = run.preconditioner.better_start(run.state)
    path = descent(run)
    while True:
        yield run.iterate()
        run.verdict = run.watch.judge(run.state, run.iterations) or _stationary(run) or _worn_out(run)
        is_elsewhere = run.verdict is None and run.watch.is_stuck and (yield from onward(run))
        if run.verdict is None and not is_elsewhere and next(path, None) is None:
            run.verdict = run.watch.vanished()
        if run.verdict and not (yield from onward(run)):
            return
        if run.verdict or is_elsewhere:
            run.verdict, path = None, descent(run)


def descent(run: Run) -> Iterator[Move]:
    """Take steps of eq. (13), and yield each; ends where no step is left."""
    rule, M, gradient = RULES[run.options.cg_beta], run.preconditioner, run.objective.gradient
    old: tuple[Point, np.ndarray] | None = None
    failures = 0
    while failures == 0 or (failures < WAIT and not run.watch.at_floor):
        M.refresh(run.state)
        g = gradient(run.state)
        z = M.apply(g)
        new = Point(g, z, float(np.vdot(g, z)))
        d, slope, cg_beta, restarted = -z, -new.gz, 0.0, False
        if old is not None:
            restarted = abs(float(np.vdot(g, old[0].z))) > LOST * new.gz
            if not restarted:
                a, cg_beta, c = rule(new, *old, M.apply)
                d = a * z + cg_beta * old[1]
                if c != 0.0:
                    d += c * M.apply(g - old[0].g)
                slope = float(np.vdot(g, d))
                restarted = slope > -LOST * new.gz
            if restarted:
                d, slope, cg_beta = -z, -new.gz, 0.0
        found = _step(run, d, slope) if slope < 0.0 else None
        if found is None:
            old, failures = None, failures + 1
            M.stiffen()
            continue
        alpha, length, there = found
        M.adapt(alpha, run.objective.size(there) / (run.objective.size(run.state) or 1.0))
        run.go(there, Move(length, alpha, cg_beta, restarted))
        old, failures = (new, d), 0
        yield run.move


def _step(run: Run, d: np.ndarray, slope: float) -> tuple[float, float, State] | None:
    """Return a strong Wolfe step along d: alpha, its length, and the state there; None if all is rounding.

    The full step is tried first; only then is the line itself searched. Where changes of the objective are
    rounding error a full step that shrinks the gradient is as good.
    """
    objective, state = run.objective, run.state
    alpha, flat = 1.0, FLAT_ENOUGH_FOR_NEWTON
    if not run.preconditioner.is_newton:
        curvature = objective.curvature(state, d)
        alpha, flat = -slope / curvature if curvature > 0.0 else 1.0, FLAT_ENOUGH
    there = run.at(state.X + d if alpha == 1.0 else state.X + alpha * d)
    change, slope_there = objective.change(state, there), float(np.vdot(objective.gradient(there), d))
    if not (change <= ENOUGH_DECREASE * alpha * slope and abs(slope_there) <= -flat * slope):
        full = Trial(alpha, change, slope_there, there)
        goal = Goal(slope, partial(objective.noise, state), flat)
        found, count = strong_wolfe(objective.line(state, d), goal, full)
        run.evaluations += count
        if found.step == 0.0 and objective.size(there) < objective.size(state):
            found = full
        alpha = found.step
        there = found.there or run.at(state.X + alpha * d)
    length = alpha * norm(d)
    return (alpha, length, there) if length > EPS * state.reach else None


def _worn_out(run: Run) -> Verdict | None:
    """Return a verdict where quick steps no longer halve a residual that is hardly above its floor."""
    is_worn_out = run.preconditioner.is_newton and run.watch.is_stuck and run.watch.near_floor
    return Verdict.ROUNDING_FLOOR if is_worn_out else None


def _stationary(run: Run) -> Verdict | None:
    """Return a verdict where eq. (10) is stationary though forces do not balance: K eta = 0, eta not 0."""
    if run.minimises_energy:
        return None
    state = run.state
    force = largest(state.g) * run.watch.gauge.largest_stiffness
    if largest(run.objective.gradient(state)) > NEGLIGIBLE * force:
        return None
    return Verdict.ROUNDING_FLOOR if run.watch.at_floor else Verdict.STATIONARY
