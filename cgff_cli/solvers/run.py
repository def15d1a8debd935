"""One run of CGFF: where it is, what it minimises and with what, and what it has cost so far."""

from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.objectives import OBJECTIVES
from cgff_cli.solvers.preconditioners import choose
from cgff_cli.solvers.preconditioners.base import Preconditioner
from cgff_cli.solvers.stopping import Gauge, Verdict, Watch


class Move(NamedTuple):
    """One step taken: |alpha d|, alpha, cg_beta, and whether the direction was reset."""

    step_norm: float
    alpha: float
    cg_beta: float
    restarted: bool


START = Move(0.0, 0.0, 0.0, False)


class Iterate(NamedTuple):
    """Where a run is after `number` iterations, how it came there, and the evaluations so far."""

    number: int
    state: State
    move: Move
    evaluations: int


class Run:
    """A state and the means to improve it; the verdict is None while it goes on."""

    def __init__(
        self,
        mechanics: Mechanics,
        options: SolveOptions,
        start: State,
        preconditioner: Preconditioner | None = None,
    ):
        self.mechanics, self.options = mechanics, options
        self.objective = OBJECTIVES[options.objective]()
        self.preconditioner = preconditioner or choose(mechanics, options)
        self.watch = Watch(Gauge(mechanics), options.tolerance, options.max_iterations)
        self.iterations = 0
        self.evaluations = 1
        self.escapes = self.detours = 0
        self.state = start
        self.move = START
        self.verdict: Verdict | None = None

    @property
    def minimises_energy(self) -> bool:
        """Whether the energy is minimised, not eq. (10)."""
        return self.objective.name == "energy"

    def at(self, X: np.ndarray) -> State:
        """Return the state at X, counted."""
        self.evaluations += 1
        return self.mechanics.at(X)

    def go(self, state: State, move: Move) -> None:
        """Take a step."""
        self.state, self.move = state, move
        self.iterations += 1

    def jump(self, X: np.ndarray, alpha: float = 0.0) -> None:
        """Go on from another shape."""
        step = norm(X - self.state.X)
        self.go(self.at(X), Move(step, alpha, 0.0, True))

    def iterate(self) -> Iterate:
        """Return where the run is."""
        return Iterate(self.iterations, self.state, self.move, self.evaluations)
