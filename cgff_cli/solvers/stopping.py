"""How a run can end, and the tests that end it, in the order they are asked.

Everything is judged on forces. `residual` is the largest out-of-balance force component over the free
directions, `reference` the largest element force or load, `floor` the rounding error of `residual`.
"""

from enum import StrEnum
from math import sqrt
from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import Mechanics, State

VANISHED = 16.0
"""Forces below this many rounding floors are taken for zero."""

FAR = 1e100
"""Residual, against stiffness times size, that no shape within reach can have."""

FAR_ABOVE = 1e4
"""A residual this many times a rough bound on the floor needs no exact floor to compare with."""

WAIT = 8
"""Iterations without halving the residual after which a run is stuck (12 did as well)."""

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

    @property
    def near_floor(self) -> bool:
        """True where it is no more than may be taken for zero."""
        return self.residual <= VANISHED * self.floor

    @property
    def relative(self) -> float:
        """Residual over reference; the residual itself where there is nothing to compare it with."""
        return self.residual / self.reference if self.reference > 0.0 else self.residual


class Gauge:
    """Measures states of one structure; what does not change is computed once."""

    def __init__(self, mechanics: Mechanics):
        self.mechanics = mechanics
        self.largest_stiffness = float(mechanics.nodal_stiffness.max(initial=0.0))
        self.root = sqrt(mechanics.start.size or 1)
        self.far_above = FAR_ABOVE * EPS * self.largest_stiffness
        self.still = norm(mechanics.all) + float(mechanics.l0.max())
        self.largest_load = mechanics.largest_load

    def may_end(self, state: State, tolerance: float) -> bool:
        """Return whether a residual may be within the tolerance or the floor: a cheap bound first.

        Its largest component is at least the norm over the root of their number, the reference at most the
        norm of all forces, and the floor is far below k times a size that the norm of X bounds.
        """
        balanced = tolerance * (norm(state.t) + self.largest_load)
        return state.norm <= self.root * max(balanced, self.far_above * (self.still + 4.0 * norm(state.X)))

    def measure(self, state: State) -> Balance:
        """Return the balance of a state; the floor is left 0 while the residual is far above it."""
        residual = float(np.abs(state.g).max(initial=0.0))
        reference = max(float(np.abs(state.t).max()), self.largest_load)
        far_above = self.far_above * state.size
        if residual > far_above and reference > VANISHED * far_above:
            return Balance(residual, reference, 0.0, False)
        floor = self.rounding_floor(state)
        nothing = VANISHED * max(floor, EPS * self.mechanics.largest_at_start)
        if reference > nothing or self.largest_load > 0.0:  # a load is exact, however small
            return Balance(residual, reference, floor, False)
        largest = max(float((self.mechanics.k * state.l).max()), self.mechanics.largest_at_start)
        return Balance(residual, largest, max(floor, EPS * largest), True)

    def rounding_floor(self, state: State) -> float:
        """Return the rounding error of the largest residual component: its elements' forces', summed."""
        structure, blurred = self.mechanics.structure, self.mechanics.k * state.rounding
        n = len(structure.free)
        return float(
            (np.bincount(structure.start, blurred, n) + np.bincount(structure.end, blurred, n)).max()
        )


class Watch:
    """Asks the stopping tests once per iteration, and remembers the best balance so far."""

    def __init__(self, gauge: Gauge, tolerance: float, max_iterations: int):
        self.gauge, self.tolerance, self.max_iterations = gauge, tolerance, max_iterations
        self.best = float("inf")
        self.waited = 0
        self.balance: Balance | None = None

    def judge(self, state: State, iteration: int) -> Verdict | None:
        """Return the verdict that ends the run, or None to go on.

        Order: diverged, converged, rounding floor (reached, and three iterations without halving it), limit.
        """
        self.balance = None
        if not state.norm < FAR:
            return Verdict.DIVERGED
        gauge = self.gauge
        if gauge.may_end(state, self.tolerance):
            self.balance = gauge.measure(state)
            if self.balance.residual <= self.tolerance * self.balance.reference:
                return Verdict.CONVERGED
        if state.norm <= 0.5 * self.best:
            self.best, self.waited = state.norm, 0
        else:
            self.waited += 1
        if self.waited >= PATIENCE and self.at_floor:
            return Verdict.ROUNDING_FLOOR
        return Verdict.MAX_ITERATIONS if iteration >= self.max_iterations else None

    @property
    def near_floor(self) -> bool:
        """Whether the state last judged is balanced but for forces that may be taken for zero."""
        return self.balance is not None and self.balance.near_floor

    def vanished(self, state: State) -> Verdict:
        """Return what it means that no step is left."""
        near = self.gauge.measure(state).near_floor
        return Verdict.ROUNDING_FLOOR if near else Verdict.STEP_VANISHED

    @property
    def is_stuck(self) -> bool:
        """Whether the balance has not halved for so long that another way is worth its price."""
        return self.waited >= WAIT

    @property
    def at_floor(self) -> bool:
        """Whether the state last judged is balanced to rounding."""
        return self.balance is not None and self.balance.at_floor


def sentence(verdict: Verdict, balance: Balance, tolerance: float) -> str:
    """Return what was reached, and which test ended the run, in one sentence."""
    measure = "the largest k l, as every force vanishes" if balance.vanished else "the largest force"
    found = f"out-of-balance force {balance.relative:.1e} of {measure}"
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
