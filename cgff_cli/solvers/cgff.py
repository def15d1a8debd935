"""CGFF: preconditioned Fletcher-Reeves conjugate gradients, eq. (13), for the energy or eq. (10).

    z_k = M^-1 g_k                       M: tangent stiffness, shifted until positive definite
    d_k = -z_k + beta_k d_{k-1}          beta_FR = <g, z>_k / <g, z>_{k-1}
    X_{k+1} = X_k + alpha_k d_k          alpha_k: strong Wolfe

until the forces balance. Where this departs from the paper's Table I: objective, preconditioner, line
search, stopping test, restarts.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.curvature import farthest_fall, separated
from cgff_cli.solvers.directions import RULES
from cgff_cli.solvers.line_search import strong_wolfe
from cgff_cli.solvers.objectives import OBJECTIVES
from cgff_cli.solvers.preconditioners import choose
from cgff_cli.solvers.scaling import Frame, centred_and_scaled
from cgff_cli.solvers.solution import History, Observer, Solution, concluded
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


def form_find(structure: Structure, options: SolveOptions, observer: Observer | None = None) -> Solution:
    """Return the equilibrium found from the structure's start shape, or the best that was reached."""
    scaled, frame = centred_and_scaled(structure)
    X, warning = separated(scaled, options.seed)
    run = _Run(Mechanics(scaled), X, frame, options, History(observer))
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
        self.rule = RULES[options.cg_beta]
        self.preconditioner = choose(mechanics, options)
        self.gauge = Gauge(mechanics)
        self.watch = Watch(options.tolerance, options.max_iterations)
        self.state = mechanics.at(X)
        self.evaluations = 1
        self.escapes = 0
        self.last: _Direction | None = None

    def loop(self) -> Verdict:
        """Iterate until a stopping test holds."""
        move = _Move(0.0, 0.0, 0.0, False)
        iteration = 0
        while True:
            g = self.objective.gradient(self.state)
            balance = self.gauge.measure(self.state)
            self._record(iteration, g, balance, move)
            verdict = self.watch.judge(balance, iteration, float(np.abs(self.state.X).max()))
            if verdict is None and self._is_stationary(g):
                return Verdict.STATIONARY
            if verdict is None:
                next_move = self._descend(g)
                if next_move is None:
                    return Verdict.ROUNDING_FLOOR if balance.at_floor else Verdict.STEP_VANISHED
            else:
                next_move = self._escape() if verdict.converged else None
                if next_move is None:
                    return verdict
            move = next_move
            iteration += 1

    def _descend(self, g: np.ndarray) -> "_Move | None":
        """Take one step of eq. (13); None when no direction gives one, however large the shift."""
        for _ in range(MAX_RESCUES):
            self.preconditioner.refresh(self.state)
            d, cg_beta, restarted = self._direction(g)
            alpha = self._step_length(g, d)
            if alpha > 0.0:
                self.state = self.mechanics.at(self.state.X + alpha * d)
                self.evaluations += 1
                return _Move(alpha * float(np.linalg.norm(d)), alpha, cg_beta, restarted)
            self.preconditioner.stiffen()
            self.last = None
        return None

    def _direction(self, g: np.ndarray) -> tuple[np.ndarray, float, bool]:
        """Return d_k, cg_beta, and whether the direction was reset to -z."""
        z = self.preconditioner.apply(g)
        gz = float(np.vdot(g, z))
        d, cg_beta, restarted = -z, 0.0, False
        if self.last is not None:
            cg_beta = self.rule(g, z, *self.last)
            d = cg_beta * self.last.d - z
            conjugate = abs(float(np.vdot(g, self.last.z))) <= LOST_CONJUGACY * gz
            restarted = not (conjugate and float(np.vdot(g, d)) <= -DOWNHILL * gz)
            if restarted:
                d, cg_beta = -z, 0.0
        self.last = _Direction(g, z, d)
        return d, cg_beta, restarted

    def _step_length(self, g: np.ndarray, d: np.ndarray) -> float:
        """Return a strong Wolfe step, or the full step where only the gradient can still tell; else 0."""
        line = self.objective.line(self.state, d)
        slope = float(np.vdot(g, d))
        first = self.preconditioner.first_step(line, slope)
        step = strong_wolfe(line, slope, self.objective.noise(self.state), first)
        self.evaluations += step.evaluations
        alpha = step.length
        g_norm = float(np.linalg.norm(g))
        there = self.objective.gradient(self.mechanics.at(self.state.X + (alpha or 1.0) * d))
        shrinkage = float(np.linalg.norm(there)) / g_norm
        if alpha == 0.0 and shrinkage < 1.0:
            alpha = 1.0
        if alpha > 0.0:
            self.preconditioner.adapt(alpha, shrinkage)
        return alpha

    def _escape(self) -> "_Move | None":
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
        self.last = None
        self.state = self.mechanics.at(self.state.X + alpha * d)
        self.evaluations += 1
        return _Move(abs(alpha), alpha, 0.0, True)

    def _is_stationary(self, g: np.ndarray) -> bool:
        """True where eq. (10) is stationary though forces do not balance: K eta = 0 with eta not 0."""
        if self.objective.name == "energy":
            return False
        force = float(np.abs(self.state.free_eta).max()) * float(self.gauge.nodal_stiffness.max())
        return float(np.abs(g).max()) <= STATIONARY * force

    def _record(self, iteration: int, g: np.ndarray, balance: Balance, move: "_Move") -> None:
        frame, energy = self.frame, self.objective.name == "energy"
        unit = frame.energy if energy else frame.force**2
        slope_unit = frame.force if energy else frame.force * frame.stiffness
        self.history.add(
            iteration,
            self.objective.value(self.state) * unit,
            balance.residual * frame.force,
            float(np.linalg.norm(g)) * slope_unit,
            move.step_norm * frame.length,
            move.alpha,
            move.cg_beta,
            self.evaluations,
            move.restarted,
        )


class _Direction(NamedTuple):
    """What a beta rule needs of the last iteration."""

    g: np.ndarray
    z: np.ndarray
    d: np.ndarray


class _Move(NamedTuple):
    """One step taken, for the history."""

    step_norm: float
    alpha: float
    cg_beta: float
    restarted: bool
