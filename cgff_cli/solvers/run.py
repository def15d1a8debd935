"""Where a CGFF run is: shape, gradient, last direction, and what it has cost so far."""

import numpy as np

from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.directions import RULES
from cgff_cli.solvers.moves import Direction, Move
from cgff_cli.solvers.objectives import OBJECTIVES
from cgff_cli.solvers.preconditioners import choose
from cgff_cli.solvers.preconditioners.base import Preconditioner
from cgff_cli.solvers.scaling import Frame
from cgff_cli.solvers.solution import History
from cgff_cli.solvers.stopping import Balance, Gauge, Watch


class Run:
    """One run of the loop: where it is, what it remembers of the last direction, and its counts."""

    def __init__(
        self,
        mechanics: Mechanics,
        X: np.ndarray,
        frame: Frame,
        options: SolveOptions,
        history: History,
        preconditioner: Preconditioner | None = None,
    ):
        self.mechanics, self.frame, self.history = mechanics, frame, history
        self.objective = OBJECTIVES[options.objective](mechanics)
        self.options, self.rule = options, RULES[options.cg_beta]
        self.preconditioner = preconditioner or choose(mechanics, options)
        self.gauge = Gauge(mechanics)
        self.watch = Watch(options.tolerance, options.max_iterations)
        self.evaluations = 1
        self.state = mechanics.at(X)
        self.g = self.objective.gradient(self.state)
        self.escapes = self.detours = 0
        self.last: Direction | None = None

    def at(self, X: np.ndarray) -> tuple[State, np.ndarray]:
        """Return the state at X and the gradient there."""
        self.evaluations += 1
        state = self.mechanics.at(X)
        return state, self.objective.gradient(state)

    def is_energy(self) -> bool:
        """Return whether the energy is minimised, not eq. (10)."""
        return self.objective.name == "energy"

    def record(self, iteration: int, balance: Balance, move: Move) -> None:
        """Append a row to the history, in the user's units."""
        frame, energy = self.frame, self.is_energy()
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
