"""What a unit of rest length does to a shape and its forces, to first order, from K at hand.

At equilibrium U q - F = 0. With p = dt / dl0 at fixed lengths, -k under law `paper`, -k l / l0 under `hooke`
and 0 where slack, a change of rest lengths dl0 moves the nodes by dx and changes forces by dt,

    K dx = -rho^T (p dl0 u),    dt = k u . dx + p dl0.
"""

from typing import NamedTuple

import numpy as np

from cgff_cli.analysis.stability import Signs
from cgff_cli.mechanics.state import State

DRIVES = "not told: it drives a motion that has no stiffness beyond rounding"
ON_THE_BRINK = "not told: a cable of it is within rounding of going slack, so that two directions differ"


class Sensitivity(NamedTuple):
    """Per unit of rest length: motions of nodes (n, d) and changes of forces (b,), or None and a reason."""

    coordinates: np.ndarray | None
    forces: np.ndarray | None
    reason: str


def unit_response(
    state: State, taut: np.ndarray, signs: Signs, rows: np.ndarray, is_hooke: bool, doubt: float
) -> Sensitivity:
    """Return what a unit of rest length in all of some elements does, in the user's units.

    state: in balance; taut: (b,) bool, elements that resist; signs: of K at it; rows: the elements; doubt:
    the size of a stiffness that has no sign. A free body does not move as a whole.
    """
    m = state.mechanics
    if (taut != state.taut)[rows].any():
        return Sensitivity(None, None, ON_THE_BRINK)
    p = np.zeros(len(m.k))
    p[rows] = -(m.k * (state.l / m.l0 if is_hooke else 1.0) * taut)[rows]
    u = state.V / state.l
    pull = -m.connectivity.gather(p * u)
    dx = signs.solved(pull if m.mask is None else pull * m.mask, doubt)
    if dx is None:
        return Sensitivity(None, None, DRIVES)
    stretch = np.einsum("ab,ab->b", u, m.connectivity.differences(dx))
    moves = np.zeros_like(m.structure.coordinates)
    moves[slice(None) if m.moves is None else m.moves] = dx.T
    return Sensitivity(moves, (m.k * taut * stretch + p) * m.frame.stiffness, "")
