"""What the loop asks of a preconditioner, the one that does nothing, and the shift that tangents share."""

from typing import Protocol

import numpy as np

from cgff_cli.mechanics.state import State
from cgff_cli.solvers.curvature import steepest_fall

FIRST_SHIFT = 1e-3
LEAST_SHIFT = 1e-13
LONG_STEP, SHORT_STEP = 0.5, 0.2


class Preconditioner(Protocol):
    """M^-1 in z = M^-1 g."""

    factorizations: int
    predicts_full_steps: bool
    """Whether a step of length 1 is the one to expect."""

    def better_start(self, state: State) -> State:
        """Return a state of lower energy to start from, if one is cheap to have; else `state`."""

    def refresh(self, state: State) -> None:
        """Rebuild M at a state, if it is time to."""

    def apply(self, g: np.ndarray) -> np.ndarray:
        """Return M^-1 g, (n, d)."""

    def adapt(self, alpha: float, shrinkage: float, excess: float) -> None:
        """Learn from an accepted step.

        alpha: its length; shrinkage: ratio of gradient norms, new over old; excess: how many times the
        residual was above its goal before the step.
        """

    def stiffen(self) -> None:
        """Ask for shorter, safer steps after a failed one."""

    def is_beaten(self, waited: int) -> bool:
        """Return whether the tangent should take over, `waited` iterations after the last headway."""

    def steepest_fall(self, state: State) -> np.ndarray | None:
        """Return a unit direction of negative stiffness at a balanced state, or None."""


class Identity:
    """M = I: plain conjugate gradients."""

    factorizations = 0
    predicts_full_steps = False

    def better_start(self, state: State) -> State:
        """Return the state itself."""
        return state

    def refresh(self, state: State) -> None:
        """Do nothing."""

    def apply(self, g: np.ndarray) -> np.ndarray:
        """Return g."""
        return g

    def adapt(self, alpha: float, shrinkage: float, excess: float) -> None:
        """Do nothing."""

    def stiffen(self) -> None:
        """Do nothing."""

    def is_beaten(self, waited: int) -> bool:
        """Return False."""
        return False

    def steepest_fall(self, state: State) -> np.ndarray | None:
        """Return a unit direction of negative stiffness, or None; not looked for in large scenes."""
        return steepest_fall(state) if state.mechanics.connectivity.is_small else None


class Shift:
    """mu in M = K + mu S: a number without unit, adapted like the radius of a trust region.

    It falls after long steps, faster the more the gradient shrank, which makes the last iterations
    quadratic, and rises after short ones.
    """

    def __init__(self) -> None:
        self.mu = FIRST_SHIFT

    def better_start(self, state: State) -> State:
        """Return the state itself."""
        return state

    def adapt(self, alpha: float, shrinkage: float, excess: float) -> None:
        """Lower mu after a long step, raise it after a short one."""
        if alpha > LONG_STEP:
            self.mu = max(self.mu * min(0.1, shrinkage), LEAST_SHIFT)
        elif alpha < SHORT_STEP:
            self.mu *= 10.0

    def stiffen(self) -> None:
        """Raise mu a hundredfold."""
        self.mu *= 100.0

    def is_beaten(self, waited: int) -> bool:
        """Return False: it is the tangent."""
        return False
