"""How a run can end, and the tests that end it, in the order they are asked.

Everything is judged on forces. `residual` is the largest out-of-balance force component over the free
directions, `reference` the largest element force or load, `floor` the rounding error of `residual`.
"""

from enum import StrEnum
from math import sqrt
from typing import NamedTuple

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import largest, norm
from cgff_cli.mechanics.state import Mechanics, State

VANISHED = 16.0
"""Forces below this many rounding floors are taken for zero (10 did as well: tests/studies/hard_suite.py)."""

NEGLIGIBLE = 1e-13
"""Share of a sum of products that is rounding: a gradient of eq. (10) that small against stiffness times
residual is zero, a shift of the tangent that small does nothing (1e-12 did as well:
tests/studies/hard_suite.py)."""

WAIT = 8
"""Iterations without halving the residual, or failed steps in a row, after which a run is stuck (6 to 10 did
as well: tests/studies/hard_suite.py)."""

PATIENCE = 3
"""Iterations at the floor without halving the residual before it counts as reached; detours of a run (5 and
8 did as well: tests/studies/hard_suite.py)."""


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

    def reached(self, tolerance: float) -> Verdict | None:
        """Return which kind of equilibrium this is, None where it is none."""
        if self.residual <= tolerance * self.reference:
            return Verdict.CONVERGED
        return Verdict.ROUNDING_FLOOR if self.at_floor else None


class Gauge:
    """Measures states of one structure; what does not change is computed once."""

    def __init__(self, mechanics: Mechanics):
        self.mechanics = mechanics
        self.largest_stiffness = largest(mechanics.nodal_stiffness)
        self.root = sqrt(mechanics.start.size or 1)
        self.still = 2.0 * norm(mechanics.all) + float(mechanics.l0.max())

    def bound(self, state: State) -> float:
        """Return a bound on the floor: the norm of X bounds coordinates, lengths and extensions."""
        return EPS * self.largest_stiffness * 2.0 * (self.still + 2.0 * state.reach)

    def may_end(self, state: State, tolerance: float) -> bool:
        """Return whether a residual may be within the tolerance or the floor.

        Its largest component is at least the norm over the root of their number, the reference at most the
        norm of all forces.
        """
        balanced = tolerance * (norm(state.t) + self.mechanics.largest_load)
        return state.norm <= self.root * max(balanced, VANISHED * VANISHED * self.bound(state))

    def is_balanced(self, state: State, tolerance: float) -> bool:
        """Return whether the residual is within the tolerance; the floor is measured where it matters."""
        force = self._largest_force(state)
        if force <= VANISHED * self.bound(state):
            force = self.measure(state).reference
        return largest(state.g) <= tolerance * force

    def measure(self, state: State) -> Balance:
        """Return the balance of a state."""
        mechanics, floor, force = self.mechanics, self.rounding_floor(state), self._largest_force(state)
        residual = largest(state.g)
        nothing = VANISHED * max(floor, EPS * mechanics.largest_at_start)
        if force > nothing or mechanics.largest_load > 0.0:  # a load is exact, however small
            return Balance(residual, force, floor, False)
        whole = max(largest(mechanics.k * state.l), mechanics.largest_at_start)
        return Balance(residual, whole, max(floor, EPS * whole), True)

    def rounding_floor(self, state: State) -> float:
        """Return the rounding error of the largest residual component: its elements' forces', summed."""
        return float(self.mechanics.structure.at_nodes(self.mechanics.k * state.rounding).max())

    def _largest_force(self, state: State) -> float:
        return max(largest(state.t), self.mechanics.largest_load)


class Watch:
    """Asks the stopping tests once per iteration, and remembers the best balance so far."""

    def __init__(self, gauge: Gauge, tolerance: float, max_iterations: int):
        self.gauge, self.tolerance, self.max_iterations = gauge, tolerance, max_iterations
        self.best = float("inf")
        self.waited = 0
        self.state: State | None = None
        self.balance: Balance | None = None

    def judge(self, state: State, iteration: int) -> Verdict | None:
        """Return the verdict that ends the run, or None to go on.

        Order: diverged, converged, rounding floor (reached, and three iterations without halving it), limit.
        """
        self.state, self.balance = state, None
        if not state.norm < float("inf"):
            return Verdict.DIVERGED
        if self.gauge.may_end(state, self.tolerance) and self.gauge.is_balanced(state, self.tolerance):
            return Verdict.CONVERGED
        if state.norm <= 0.5 * self.best:
            self.best, self.waited = state.norm, 0
        else:
            self.waited += 1
        if self.waited >= PATIENCE and self.at_floor:
            return Verdict.ROUNDING_FLOOR
        return Verdict.MAX_ITERATIONS if iteration >= self.max_iterations else None

    def vanished(self) -> Verdict:
        """Return what it means that no step is left."""
        return Verdict.ROUNDING_FLOOR if self.near_floor else Verdict.STEP_VANISHED

    @property
    def is_stuck(self) -> bool:
        """Whether the balance has not halved for so long that another way is worth its price."""
        return self.waited >= WAIT

    @property
    def at_floor(self) -> bool:
        """Whether the state last judged is balanced to rounding."""
        return self._measured().at_floor

    @property
    def near_floor(self) -> bool:
        """Whether it is balanced but for forces that may be taken for zero."""
        return self._measured().near_floor

    def _measured(self) -> Balance:
        if self.balance is None and self.state is not None:
            self.balance = self.gauge.measure(self.state)
        return self.balance or Balance(float("inf"), 0.0, 0.0, False)


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
