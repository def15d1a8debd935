"""CGFF: preconditioned Fletcher-Reeves conjugate gradients, eq. (13), for the energy or eq. (10).

    z_k = M^-1 g_k                       M: tangent stiffness, shifted until positive definite
    d_k = -z_k + beta_k d_{k-1}          beta_FR = <g, z>_k / <g, z>_{k-1}
    X_{k+1} = X_k + alpha_k d_k          alpha_k: strong Wolfe

until the forces balance. Where this departs from the paper's Table I: objective, preconditioner, line
search, stopping test, restarts.
"""

import numpy as np

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.curvature import separated
from cgff_cli.solvers.line_search import FLAT, FLAT_ENOUGH_FOR_NEWTON, Goal, strong_wolfe
from cgff_cli.solvers.moves import Direction, Move, parabola_step
from cgff_cli.solvers.objectives import Line
from cgff_cli.solvers.rescues import begin, detour, escape, relieve
from cgff_cli.solvers.run import Run
from cgff_cli.solvers.scaling import centred_and_scaled
from cgff_cli.solvers.solution import History, Observer, Solution, Watcher, concluded
from cgff_cli.solvers.stopping import Balance, Verdict
from cgff_cli.structure import Structure

LOST_CONJUGACY = 0.1
"""Restart when <g_k, z_{k-1}> exceeds this share of <g_k, z_k> (Powell 1977, where it is 0.2)."""

DOWNHILL = 0.01
"""Restart when the slope along d is flatter than this share of the slope along -z."""

STATIONARY = 1e-12
"""Gradient of eq. (10) this small against stiffness times residual is zero."""

MAX_RESCUES = 6
"""Restarts with a hundredfold shift, in a row, before a vanished step is believed."""


def form_find(
    structure: Structure,
    options: SolveOptions,
    observer: Observer | None = None,
    watcher: Watcher | None = None,
) -> Solution:
    """Return the equilibrium found from the structure's start shape, or the best that was reached."""
    scaled, frame = centred_and_scaled(structure)
    X, warning = separated(scaled, options.seed)
    run = Run(Mechanics(scaled), X, frame, options, History(observer, watcher))
    try:
        begin(run, loop)
        verdict = loop(run)
    except KeyboardInterrupt:
        verdict = Verdict.INTERRUPTED
        if not run.history.rows:  # on the way to a better start
            run.record(0, run.gauge.measure(run.state), Move(0.0, 0.0, 0.0, False))
    return concluded(
        structure,
        run.state.X * frame.length,
        frame.centre,
        verdict,
        options.tolerance,
        run.history,
        evaluations=run.evaluations,
        factorizations=run.preconditioner.factorizations,
        warnings=() if warning is None else (warning,),
    )


def loop(run: Run) -> Verdict:
    """Iterate until a stopping test holds."""
    move = Move(0.0, 0.0, 0.0, False)
    iteration = 0
    while True:
        balance = run.gauge.measure(run.state)
        run.record(iteration, balance, move)
        verdict = run.watch.judge(balance, iteration)
        if verdict is None and _is_stationary(run):
            return Verdict.ROUNDING_FLOOR if balance.at_floor else Verdict.STATIONARY
        if verdict is None:
            relieve(run, run.watch.waited)
            taken = detour(run, loop) or _descend(run, balance)
            verdict = Verdict.ROUNDING_FLOOR if balance.at_floor else Verdict.STEP_VANISHED
        else:
            taken = escape(run) if verdict.converged else None
        if taken is None:
            return verdict
        move = taken
        iteration += 1


def _descend(run: Run, balance: Balance) -> Move | None:
    """Take one step of eq. (13); None when no direction gives one, however large the shift."""
    excess = balance.residual / balance.reference / run.options.tolerance
    for _ in range(1 if balance.at_floor else MAX_RESCUES):
        run.preconditioner.refresh(run.state)
        d, cg_beta, restarted = _direction(run)
        alpha = _step(run, d, excess)
        if alpha > 0.0:
            return Move(alpha * norm(d), alpha, cg_beta, restarted)
        run.preconditioner.stiffen()
        run.last = None
    return None


def _direction(run: Run) -> tuple[np.ndarray, float, bool]:
    """Return d_k, cg_beta, and whether the direction was reset to -z."""
    g = run.g
    z = run.preconditioner.apply(g)
    gz = float(np.vdot(g, z))
    d, cg_beta, restarted = -z, 0.0, False
    if run.last is not None:
        restarted = abs(float(np.vdot(g, run.last.z))) > LOST_CONJUGACY * gz
        if not restarted:
            cg_beta = run.rule(g, z, *run.last)
            d = cg_beta * run.last.d - z
            restarted = float(np.vdot(g, d)) > -DOWNHILL * gz
        if restarted:
            d, cg_beta = -z, 0.0
    run.last = Direction(g, z, d)
    return d, cg_beta, restarted


def _step(run: Run, d: np.ndarray, excess: float) -> float:
    """Move along d by a strong Wolfe step and return its length, 0 for no move beyond rounding.

    The full step is tried at its own state, which is kept if it serves; only then is the line itself
    searched. Where changes of the objective are rounding error a full step that shrinks the gradient
    is as good.
    """
    line: Line | None = None
    newton = run.preconditioner.predicts_full_steps
    flat = FLAT_ENOUGH_FOR_NEWTON if newton else FLAT
    goal = Goal(float(np.vdot(run.g, d)), run.objective.noise(run.state), flat)
    alpha = 1.0
    if not newton:
        line = run.objective.line(run.state, d)
        alpha = parabola_step(line, goal.slope)
        run.evaluations += 1
    there, g = run.at(run.state.X + alpha * d)
    change = run.objective.change(run.state, there)
    full = there, g
    if not goal.is_met(alpha, change, float(np.vdot(g, d))):
        line = line or run.objective.line(run.state, d)
        step = strong_wolfe(line, goal, alpha)
        run.evaluations += step.evaluations
        alpha = step.length
        if alpha > 0.0:
            there, g = run.at(run.state.X + alpha * d)
    shrinkage = norm(g) / (norm(run.g) or 1.0)
    if alpha == 0.0 and shrinkage < 1.0:
        (there, g), alpha = full, 1.0
    if alpha * norm(d) <= EPS * norm(run.state.X):
        return 0.0
    if alpha > 0.0:
        run.preconditioner.adapt(alpha, shrinkage, excess)
        run.state, run.g = there, g
    return alpha


def _is_stationary(run: Run) -> bool:
    """True where eq. (10) is stationary though forces do not balance: K eta = 0 with eta not 0."""
    if run.is_energy():
        return False
    force = float(np.abs(run.state.free_eta).max()) * run.gauge.largest_stiffness
    return float(np.abs(run.g).max()) <= STATIONARY * force
