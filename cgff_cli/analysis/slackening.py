"""At which multiple of the loads a cable goes slack, as far as its force is linear in them.

The loads F move the structure by dx, K dx = F, and so change forces by dt = k u . dx. A factor lambda on the
loads makes t + (lambda - 1) dt of t: of a cable whose dt is negative that is 0 at lambda = 1 - t / dt. Beyond
the least of these K is another one, and what was told of it holds no longer.
"""

from collections.abc import Sequence

import numpy as np

from cgff_cli.analysis.buckling import SLIGHT
from cgff_cli.analysis.stability import Signs
from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import largest
from cgff_cli.mechanics.signs import DRIVEN
from cgff_cli.mechanics.state import State

ROOM = 30.0
"""Times that a stretch exceeds what rounding may make of none, to count. Against 40 digits, nets, towers and
prisms of strains of 1e-8 to 1e-2 are off by up to 10 times that, and that is up to 1e-6 of a stretch."""

AT_ONCE = 1e-6
"""Relative difference of factors within which cables go slack together."""

_NAMED = 3
"""Cables named in a sentence."""

_NONE = "no taut cable loses its force however large the loads, as far as it is linear in them"
_BLURRED = "not told: rounding hides how the loads change forces"


def first_slack(
    state: State, taut: np.ndarray, signs: Signs, doubt: float, dx: np.ndarray
) -> tuple[float | None, np.ndarray, str]:
    """Return the least load factor above 1 at which a cable goes slack, and which do; or None and why.

    taut: (b,) bool, elements that resist at the state, in balance; signs, doubt, dx: of K, and what the
    loads move, see `moved_by_loads`. Cables that are slack stay so; one without rest length never is.
    """
    m, none = state.mechanics, np.zeros(0, int)
    moved = signs.solved(_rounding(state, dx), doubt)
    if moved is None:
        return None, none, _BLURRED
    stretch = _stretch(state, dx)
    blur = np.abs(_stretch(state, moved)) + EPS * largest(dx)
    shortened = m.structure.tension_only & (m.l0 > 0.0) & taut & (stretch < -ROOM * blur)
    factors = np.full(len(stretch), np.inf)
    factors[shortened] = 1.0 - state.e[shortened] / stretch[shortened]
    least = float(factors.min(initial=np.inf))
    if not least < 1.0 / SLIGHT:
        return None, none, _NONE
    return least, np.flatnonzero(factors <= least * (1.0 + AT_ONCE)), ""


def slack_words(cables: Sequence[str], factor: float) -> str:
    """Return which cables go slack at which multiple of the loads, in words."""
    named = ", ".join(cables[:_NAMED])
    more = f" and {len(cables) - _NAMED} more" if len(cables) > _NAMED else ""
    goes = "goes" if len(cables) == 1 else "go"
    return f"{named}{more} {goes} slack at {factor:.6g} times the loads"


def _stretch(state: State, dx: np.ndarray) -> np.ndarray:
    """Return u . dx, (b,), how much longer motions (d, m) make elements."""
    return np.einsum("ab,ab->b", state.V, state.mechanics.connectivity.differences(dx)) / state.l


def _rounding(state: State, dx: np.ndarray) -> np.ndarray:
    """Return forces, (d, m), as large as K dx may be wrong by, of signs in which no element is missing."""
    m = state.mechanics
    size = EPS * m.scale_stiffness * np.abs(dx).max(axis=0) + DRIVEN * m.largest_load
    forces = size * np.cos(np.arange(dx.size) ** 2.0).reshape(dx.shape)
    return forces if m.mask is None else forces * m.mask
