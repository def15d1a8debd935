"""CGFF: preconditioned Fletcher-Reeves conjugate gradients, eq. (13), for the energy or eq. (10).

    z_k = M^-1 g_k                       M: tangent stiffness, shifted until positive definite
    d_k = -z_k + beta_k d_{k-1}          beta_FR = <g, z>_k / <g, z>_{k-1}
    X_{k+1} = X_k + alpha_k d_k          alpha_k: strong Wolfe

until the forces balance. Where this departs from the paper's Table I: objective, preconditioner, line
search, stopping test, restarts.
"""

from dataclasses import replace

import numpy as np

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.curvature import farthest_fall, separated
from cgff_cli.solvers.directions import RULES
from cgff_cli.solvers.line_search import FLAT, FLAT_ENOUGH_FOR_NEWTON, Goal, strong_wolfe
from cgff_cli.solvers.moves import Direction, Move, parabola_step
from cgff_cli.solvers.objectives import OBJECTIVES, Line
from cgff_cli.solvers.preconditioners import choose
from cgff_cli.solvers.scaling import Frame, centred_and_scaled
from cgff_cli.solvers.softening import LOOSE, MOST_DETOURS, STAGE_LIMIT, WAIT, softened
from cgff_cli.solvers.solution import History, Observer, Solution, Watcher, concluded
from cgff_cli.solvers.stopping import Balance, Gauge, Verdict, Watch
from cgff_cli.structure import Structure

LOST_CONJUGACY = 0.1
"""Restart when <g_k, z_{k-1}> exceeds this share of <g_k, z_k> (Powell 1977, where it is 0.2)."""

DOWNHILL = 0.01
"""Restart when the slope along d is flatter than this share of the slope along -z."""

STATIONARY = 1e-12
"""Gradient of eq. (10) this small against stiffness times residual is zero."""

MAX_RESCUES = 6
"""Restarts with a hundredfold shift, in a row, before a vanished step is believed."""

MAX_ESCAPES = 20
"""Unstable equilibria left behind along their negative stiffness before one is reported as such."""


def form_find(
    structure: Structure,
    options: SolveOptions,
    observer: Observer | None = None,
    watcher: Watcher | None = None,
) -> Solution:
    """Return the equilibrium found from the structure's start shape, or the best that was reached."""
    scaled, frame = centred_and_scaled(structure)
    X, warning = separated(scaled, options.seed)
    run = _Run(Mechanics(scaled), X, frame, options, History(observer, watcher))
    try:
        verdict = run.loop()
    except KeyboardInterrupt:
        verdict = Verdict.INTERRUPTED
    local = Mechanics(replace(structure, coordinates=structure.coordinates - frame.centre))
    return concluded(
        local.at(run.state.X * frame.length),
        frame.centre,
        verdict,
        options.tolerance,
        run.history,
        evaluations=run.evaluations,
        factorizations=run.preconditioner.factorizations,
        warnings=() if warning is None else (warning,),
    )


class _Run:
    """One run of the loop: where it is, what it remembers of the last direction, and its counts."""

    def __init__(
        self, mechanics: Mechanics, X: np.ndarray, frame: Frame, options: SolveOptions, history: History
    ):
        self.mechanics, self.frame, self.history = mechanics, frame, history
        self.objective = OBJECTIVES[options.objective](mechanics)
        self.options, self.rule = options, RULES[options.cg_beta]
        self.preconditioner = choose(mechanics, options)
        self.gauge = Gauge(mechanics)
        self.watch = Watch(options.tolerance, options.max_iterations)
        self.evaluations = 1
        self.state = mechanics.at(X)
        self.g = self.objective.gradient(self.state)
        self.escapes = self.detours = 0
        self.last: Direction | None = None

    def loop(self) -> Verdict:
        """Iterate until a stopping test holds."""
        start = self.preconditioner.better_start(self.state)
        if start is not self.state:
            self.state, self.g = start, self.objective.gradient(start)
        move = Move(0.0, 0.0, 0.0, False)
        iteration = 0
        while True:
            balance = self.gauge.measure(self.state)
            self._record(iteration, balance, move)
            verdict = self.watch.judge(balance, iteration)
            if verdict is None and self._is_stationary():
                return Verdict.ROUNDING_FLOOR if balance.at_floor else Verdict.STATIONARY
            if verdict is None:
                taken = self._detour() or self._descend(balance)
                verdict = Verdict.ROUNDING_FLOOR if balance.at_floor else Verdict.STEP_VANISHED
            else:
                taken = self._escape() if verdict.converged else None
            if taken is None:
                return verdict
            move = taken
            iteration += 1

    def _descend(self, balance: Balance) -> Move | None:
        """Take one step of eq. (13); None when no direction gives one, however large the shift."""
        excess = balance.residual / (self.options.tolerance * balance.reference)
        for _ in range(1 if balance.at_floor else MAX_RESCUES):
            self.preconditioner.refresh(self.state)
            d, cg_beta, restarted = self._direction()
            alpha = self._step(d, excess)
            if alpha > 0.0:
                return Move(alpha * norm(d), alpha, cg_beta, restarted)
            self.preconditioner.stiffen()
            self.last = None
        return None

    def _direction(self) -> tuple[np.ndarray, float, bool]:
        """Return d_k, cg_beta, and whether the direction was reset to -z."""
        g = self.g
        z = self.preconditioner.apply(g)
        gz = float(np.vdot(g, z))
        d, cg_beta, restarted = -z, 0.0, False
        if self.last is not None:
            restarted = abs(float(np.vdot(g, self.last.z))) > LOST_CONJUGACY * gz
            if not restarted:
                cg_beta = self.rule(g, z, *self.last)
                d = cg_beta * self.last.d - z
                restarted = float(np.vdot(g, d)) > -DOWNHILL * gz
            if restarted:
                d, cg_beta = -z, 0.0
        self.last = Direction(g, z, d)
        return d, cg_beta, restarted

    def _step(self, d: np.ndarray, excess: float) -> float:
        """Move along d by a strong Wolfe step and return its length, 0 for no move beyond rounding.

        The full step is tried at its own state, which is kept if it serves; only then is the line itself
        searched. Where changes of the objective are rounding error a full step that shrinks the gradient
        is as good.
        """
        line: Line | None = None
        newton = self.preconditioner.predicts_full_steps
        flat = FLAT_ENOUGH_FOR_NEWTON if newton else FLAT
        goal = Goal(float(np.vdot(self.g, d)), self.objective.noise(self.state), flat)
        alpha = 1.0
        if not newton:
            line = self.objective.line(self.state, d)
            alpha = parabola_step(line, goal.slope)
            self.evaluations += 1
        there, g = self._at(self.state.X + alpha * d)
        change = self.objective.change(self.state, there)
        full = there, g
        if not goal.is_met(alpha, change, float(np.vdot(g, d))):
            line = line or self.objective.line(self.state, d)
            step = strong_wolfe(line, goal, alpha)
            self.evaluations += step.evaluations
            alpha = step.length
            if alpha > 0.0:
                there, g = self._at(self.state.X + alpha * d)
        shrinkage = norm(g) / norm(self.g)
        if alpha == 0.0 and shrinkage < 1.0:
            (there, g), alpha = full, 1.0
        if alpha * norm(d) <= EPS * norm(self.state.X):
            return 0.0
        if alpha > 0.0:
            self.preconditioner.adapt(alpha, shrinkage, excess)
            self.state, self.g = there, g
        return alpha

    def _at(self, X: np.ndarray) -> tuple[State, np.ndarray]:
        """Return the state at X and the gradient there."""
        self.evaluations += 1
        state = self.mechanics.at(X)
        return state, self.objective.gradient(state)

    def _escape(self) -> Move | None:
        """Leave an unstable equilibrium along its most negative stiffness; None if it is a minimum."""
        if self.objective.name != "energy" or self.escapes >= MAX_ESCAPES:
            return None
        d = self.preconditioner.steepest_fall(self.state)
        if d is None:
            return None
        alpha = farthest_fall(self.objective.line(self.state, d))
        if alpha == 0.0:
            return None
        self.escapes += 1
        (self.state, self.g), self.last = self._at(self.state.X + alpha * d), None
        return Move(abs(alpha), alpha, 0.0, True)

    def _detour(self) -> Move | None:
        """Pass a narrow valley by way of softer structures; None where there is no need.

        The energy may rise: a stretch too small to see costs more than all the loads can do.
        """
        stuck = self.watch.waited >= WAIT and self.options.preconditioner != "none"
        if not stuck or self.objective.name != "energy" or self.detours >= MOST_DETOURS:
            return None
        self.detours += 1
        self.watch.waited = 0
        X = self.state.X
        options = replace(self.options, tolerance=LOOSE, max_iterations=STAGE_LIMIT)
        for softer in softened(self.mechanics.structure):
            stage = _Run(Mechanics(softer), X, self.frame, options, History())
            stage.detours = MOST_DETOURS
            stage.loop()
            X = stage.state.X
            self.evaluations += stage.evaluations
            self.preconditioner.factorizations += stage.preconditioner.factorizations
        if X is self.state.X:
            return None
        step = norm(X - self.state.X)
        (self.state, self.g), self.last = self._at(X), None
        self.preconditioner.stiffen()
        return Move(step, 0.0, 0.0, True)

    def _is_stationary(self) -> bool:
        """True where eq. (10) is stationary though forces do not balance: K eta = 0 with eta not 0."""
        if self.objective.name == "energy":
            return False
        force = float(np.abs(self.state.free_eta).max()) * self.gauge.largest_stiffness
        return float(np.abs(self.g).max()) <= STATIONARY * force

    def _record(self, iteration: int, balance: Balance, move: Move) -> None:
        frame, energy = self.frame, self.objective.name == "energy"
        unit = frame.energy if energy else frame.force * frame.force
        slope_unit = frame.force if energy else frame.force * frame.stiffness
        self.history.add(
            iteration,
            self.objective.value(self.state) * unit,
            balance.residual * frame.force,
            norm(self.g) * slope_unit,
            move.step_norm * frame.length,
            move.alpha,
            move.cg_beta,
            self.evaluations,
            move.restarted,
        )
        if self.history.watcher is not None:
            self.history.watcher(iteration, self.evaluations, self.state.X * frame.length)
