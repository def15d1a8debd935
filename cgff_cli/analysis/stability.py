"""Stable or not: the sign of the tangent stiffness on the complement of the idle rigid motions."""

from collections.abc import Callable
from math import isfinite, sqrt
from typing import Any, Protocol

import numpy as np

from cgff_cli.mechanics.signs import SETTLED, Spectrum
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.stopping import VANISHED

LEAST = 6
"""Eigenvalues of the tangent stiffness that are told."""

MOST_REFINEMENTS = 3
"""Newton steps that bring forces left over down to rounding before signs are told."""


class Signs(Protocol):
    """What stability asks of K at a state; see mechanics.signs.Spectrum."""

    values: np.ndarray
    softest: float
    blurred: float
    doubt: float
    shortest: float
    count: int
    is_sure: bool

    def newton_steps(self) -> list[np.ndarray]:
        """Return steps, (d, m), towards the equilibrium near by."""

    def solved(self, F: np.ndarray, doubt: float) -> np.ndarray | None:
        """Return x, (d, m), with K x = F and no idle motion; None where F drives what has no stiffness."""

    def negative(self, doubt: float) -> int | None:
        """Return how many stiffnesses are below -doubt, None where that is not at hand."""

    def counted(self, doubt: float) -> int | None:
        """Return the same, None where rounding hides it."""

    def modes(self, count: int) -> tuple[np.ndarray, np.ndarray, bool]:
        """Return the least stiffnesses (c,), their shapes (c, d, m), and whether these are they."""


SignsOf = Callable[[State, np.ndarray, float], Signs]


def stability(state: State, floor: float, signs: SignsOf = Spectrum) -> dict[str, Any]:
    """Return whether a balanced state is a strict minimum of the energy, apart from rigid motions.

    stability: "stable", "unstable", or "neutral" where the softest deformation has no stiffness beyond what
    rounding explains; smallest_stiffness: that stiffness, force per length. It is a statement about the
    equilibrium, not about how closely it was solved for: where the remaining residual could matter, a few
    Newton steps on a copy bring it down to rounding first. Rigid motions that turn a load or a reaction
    count: a pendulum is stable hanging and unstable upright. A cable whose force is within rounding (floor)
    of none resists nothing: it may be shortened for free.
    """
    found = signs(state, resists(state, floor), floor)
    for _ in range(MOST_REFINEMENTS):
        if _is_settled(state, found) or state.norm <= floor:
            break
        there = min((state.mechanics.at(state.X + s) for s in found.newton_steps()), key=lambda s: s.norm)
        if not there.norm < state.norm:
            break
        state = there
        found = signs(state, resists(state, floor), floor)
    return told(_kind(found), state, floor) | stiffnesses(state, found, found.doubt)


def stiffnesses(state: State, found: Signs, doubt: float) -> dict[str, Any]:
    """Return what K's least eigenvalues tell, in the user's units; doubt: the size that has no sign."""
    values = found.values[:LEAST] * state.mechanics.frame.stiffness
    return {
        "smallest_stiffness": float(values[0]) if len(values) else None,
        "negative_eigenvalues": found.negative(doubt),
        "tangent_eigenvalues": values.tolist(),
    }


def _kind(found: Signs) -> str:
    if found.softest < -found.doubt:
        return "unstable"
    return "stable" if found.softest > found.doubt and found.is_sure else "neutral"


def told(kind: str, state: State, floor: float) -> dict[str, Any]:
    """Return `stable` and `stability`; null where a state so far from balance leaves the sign in doubt."""
    if kind == "neutral" and state.norm > VANISHED * floor * sqrt(state.X.shape[1]):
        return {"stable": None, "stability": None}
    return {"stable": kind == "stable", "stability": kind}


def _is_settled(state: State, found: Signs) -> bool:
    """Return whether the exact equilibrium near by has the same idle motions and sign of its softest."""
    if not found.is_sure or not isfinite(found.softest):
        return found.is_sure
    change = float(state.mechanics.nodal_stiffness.max()) / found.shortest
    return found.softest * found.softest > SETTLED * change * state.norm


def resists(state: State, floor: float) -> np.ndarray:
    """Return (b,) bool: not slack, nor a cable whose force is within rounding, or what is left, of none."""
    m = state.mechanics
    may_slacken = m.structure.tension_only & (m.l0 > 0.0)
    return state.taut & ~(may_slacken & (state.t <= VANISHED * max(floor, state.norm)))
