"""How a run can end, and the tests that end it, in the order they are asked.

Everything is judged on forces. `residual` is the largest out-of-balance force component over the free
directions, `reference` the largest element force or load, `floor` the rounding error of `residual`.
"""

from enum import StrEnum
from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.state import Mechanics, State

VANISHED = 16.0
"""Forces below this many rounding floors are taken for zero."""

FAR = 1e100
"""Residual, against stiffness times size, that no shape within reach can have."""

FAR_ABOVE = 1e4
"""A residual this many times a rough bound on the floor needs no exact floor to compare with."""

PATIENCE = 3
"""Iterations at the floor without halving the residual before it counts as reached."""


class Verdict(StrEnum):
    """What a run reached; only the first two are an equilibrium."""

    CONVERGED = "converged"
    ROUNDING_FLOOR = "rounding_floor"
    STATIONARY = "stationary_not_equilibrium"
    STEP_VANISHED = "step_vanished"
    MAX_ITERATIONS = "max_iterations"
    DIVERGED = "diverged"
    INTERRUPTED = "interrupted"

    @property
    def converged(self) -> bool:
        """True where the forces balance."""
        return self in (Verdict.CONVERGED, Verdict.ROUNDING_FLOOR)


class Balance(NamedTuple):
    """How far the forces of a state are from balance, and what that is measured by.

    vanished: every force is rounding error (slack, or no prestress), so that there is no force to compare
    with and reference is the largest k l.
    """

    residual: float
    reference: float
    floor: float
    vanished: bool

    @property
    def at_floor(self) -> bool:
        """True where the residual is no more than rounding error."""
        return self.residual <= self.floor


class Gauge:
    """Measures states of one structure; what does not change is computed once."""

    def __init__(self, mechanics: Mechanics):
        structure = mechanics.structure
        self.mechanics = mechanics
        self.ends = np.concatenate((structure.start, structure.end))
        self.largest_stiffness = float(mechanics.nodal_stiffness.max())
        self.largest_load = float(np.abs(structure.loads).max())

    def measure(self, state: State) -> Balance:
        """Return the balance of a state; the floor is left 0 while the residual is far above it."""
        residual = float(np.abs(state.free_eta).max())
        reference = max(float(np.abs(state.t).max()), self.largest_load)
        far_above = FAR_ABOVE * EPS * self.largest_stiffness * state.size
        if residual > far_above and reference > VANISHED * far_above:
            return Balance(residual, reference, 0.0, False)
        floor = self.rounding_floor(state)
        if reference > VANISHED * floor or self.largest_load > 0.0:  # a load is exact, however small
            return Balance(residual, reference, floor, False)
        return Balance(residual, float((self.mechanics.structure.stiffness * state.l).max()), floor, True)

    def rounding_floor(self, state: State) -> float:
        """Return the rounding error of the largest residual component: its elements' forces', summed."""
        blurred = np.tile(self.mechanics.structure.stiffness * state.rounding, 2)
        return float(np.bincount(self.ends, blurred).max())


class Watch:
    """Asks the stopping tests once per iteration, and remembers the best balance at the floor."""

    def __init__(self, tolerance: float, max_iterations: int):
        self.tolerance = tolerance
        self.max_iterations = max_iterations
        self.best = float("inf")
        self.waited = 0

    def judge(self, balance: Balance, iteration: int) -> Verdict | None:
        """Return the verdict that ends the run, or None to go on.

        Order: diverged, converged, rounding floor (reached, and three iterations without halving it), limit.
        """
        if not balance.residual < FAR:
            return Verdict.DIVERGED
        if balance.residual <= self.tolerance * balance.reference:
            return Verdict.CONVERGED
        if balance.residual <= 0.5 * self.best:
            self.best, self.waited = balance.residual, 0
        else:
            self.waited += 1
        if balance.at_floor and self.waited >= PATIENCE:
            return Verdict.ROUNDING_FLOOR
        return Verdict.MAX_ITERATIONS if iteration >= self.max_iterations else None


def sentence(verdict: Verdict, balance: Balance, tolerance: float) -> str:
    """Return what was reached, and which test ended the run, in one sentence."""
    share = balance.residual / balance.reference if balance.reference > 0.0 else balance.residual
    measure = "the largest k l, as every force vanishes" if balance.vanished else "the largest force"
    found = f"out-of-balance force {share:.1e} of {measure}"
    return {
        Verdict.CONVERGED: f"equilibrium: {found}, within the tolerance {tolerance:g}",
        Verdict.ROUNDING_FLOOR: f"equilibrium to rounding: {found}, which is rounding error; "
        f"the tolerance {tolerance:g} is below what double precision can tell here",
        Verdict.STATIONARY: f"no equilibrium: the objective is stationary, but {found} remains",
        Verdict.STEP_VANISHED: f"no equilibrium: steps vanished, but {found} remains",
        Verdict.MAX_ITERATIONS: f"no equilibrium yet: iteration limit reached with {found}",
        Verdict.DIVERGED: "no equilibrium: the shape grew without bound",
        Verdict.INTERRUPTED: f"no equilibrium yet: stopped on request with {found}",
    }[verdict]
