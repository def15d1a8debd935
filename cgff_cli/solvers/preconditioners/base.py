"""What the loop asks of a preconditioner, and answers that do nothing: plain conjugate gradients."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from math import sqrt

import numpy as np

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.signs import steepest_fall
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.mechanics.tangent import Parts
from cgff_cli.solvers.line_search import HUNDREDFOLD, TENFOLD
from cgff_cli.solvers.stopping import NEGLIGIBLE


class Preconditioner:
    """M^-1 in z = M^-1 g; as it stands, M = I.

    factorizations : what it cost so far
    is_newton      : whether a step of length 1 is the one to expect
    has_detours    : whether a run that is stuck with it may go another way
    """

    factorizations = 0
    is_newton = False
    has_detours = False

    def better_start(self, state: State) -> State:
        """Return a state of lower energy to start from, if one is cheap to have; else `state`."""
        return state

    def refresh(self, state: State) -> None:
        """Rebuild M at a state, if it is time to."""

    def apply(self, g: np.ndarray) -> np.ndarray:
        """Return M^-1 g, (d, m)."""
        return g

    def adapt(self, alpha: float, shrinkage: float) -> None:
        """Learn from an accepted step: its length, and the ratio of gradient norms, new over old."""

    def stiffen(self) -> None:
        """Ask for shorter, safer steps after a failed one."""

    def steepest_fall(self, state: State) -> np.ndarray | None:
        """Return a unit direction of negative stiffness at a balanced state, or None; of small scenes."""
        return steepest_fall(state) if state.mechanics.is_small else None


FIRST_SHIFT = 1e-3
"""mu at the start, and the share of stiffness that frames lend to what has none: with 1e-2 and with 1e-6
scenes are lost (tests/studies/hard_suite.py)."""

LONG_STEP = 0.5

QUARTER = 0.25
"""Steps below this share of the full one are short; a gradient shrunk to this share earns M trust: another
step, or no test of its signs (0.2 and 0.1 did as well: tests/studies/hard_suite.py)."""

Solve = Callable[[np.ndarray], np.ndarray]


class Tangent(Preconditioner, ABC):
    """M = K + mu S, S each node's total stiffness, or its square for eq. (10).

    mu is a number without unit, adapted like the radius of a trust region. It falls after long steps, faster
    the more the gradient shrank, which makes the last iterations quadratic, and rises after short ones.
    Where K + mu S is indefinite, far from a stable equilibrium, the negative force densities of compressed
    elements are left out of it: what remains is positive semidefinite element by element. Raising mu past the
    most negative stiffness instead took one iteration in ten more on the prism from random starts.
    """

    is_newton = True
    has_detours = True

    def __init__(self, mechanics: Mechanics, squared: bool):
        self.mechanics, self.squared = mechanics, squared
        self.factorizations = 0
        self.mu = FIRST_SHIFT
        self.solve: Solve | None = None
        self.progress = float("inf")

    @abstractmethod
    def system(self, parts: Parts, shift: float, *, trusted: bool = False) -> Solve | None:
        """Return M^-1 as a function of (d, m), M = K of its parts and shift S.

        None where M has no Cholesky factor; trusted: it need not be tried. Rigid motions that nothing resists
        do not count, and solutions hold none of those at X.
        """

    def refresh(self, state: State, q: np.ndarray | None = None) -> None:
        """Form M at a state; q: (b,) nonnegative force densities to begin with in place of its own.

        With those K is positive semidefinite element by element, so that its signs need no looking at.
        """
        trusted = q is not None or self.progress < QUARTER
        self.solve = self.system(state.parts(q), self.mu, trusted=trusted)
        while self.solve is None:
            self.solve = self.system(state.parts(np.maximum(state.q, 0.0)), self.mu)
            self.mu *= 1.0 if self.solve else TENFOLD

    def apply(self, g: np.ndarray) -> np.ndarray:
        """Return M^-1 g, (d, m)."""
        return g if self.solve is None else self.solve(g)

    def adapt(self, alpha: float, shrinkage: float) -> None:
        """Lower mu after a long step, raise it after a short one."""
        self.progress = shrinkage if alpha == 1.0 else 1.0
        if alpha > LONG_STEP:
            self.mu = max(self.mu * min(1.0 / TENFOLD, shrinkage), NEGLIGIBLE)
        elif alpha < QUARTER:
            self.mu *= TENFOLD

    def stiffen(self) -> None:
        """Raise mu a hundredfold, and trust nothing."""
        self.mu *= HUNDREDFOLD
        self.progress = 1.0

    def settle(self) -> None:
        """Lower mu to where an answer is near: half of the digits."""
        self.mu, self.progress = sqrt(EPS), 1.0
