"""What is known of rows that balance, by the doubts of `mechanics.signs` and `analysis.stability`."""

from math import sqrt

import numpy as np
from scipy.linalg.lapack import dpotrf

from cgff_cli.mechanics.elements import EPS, TINY
from cgff_cli.mechanics.signs import BLUR, SETTLED
from cgff_cli.solvers.batch.rows import Rows, Topology, dot, shifted
from cgff_cli.solvers.stopping import VANISHED

OPEN, BALANCED, NEUTRAL, STABLE = range(4)
"""What is known of a row: nothing, so that it is for form_find; that forces balance; its stability too."""


def measured(topology: Topology, s: Rows, reference: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return reference and floor, (N,) each, as `Gauge.measure` does where every force may vanish."""
    floor = ((s.k * topology.rounding(s))[:, None] @ np.abs(topology.rho_t.T)).max((1, 2))
    vanished = (reference <= VANISHED * np.maximum(floor, EPS * s.at_start)) & (s.load == 0.0)
    largest = np.maximum((s.k * s.l).max(1), s.at_start)
    return np.where(vanished, largest, reference), np.where(vanished, np.maximum(floor, EPS * largest), floor)


def signs(topology: Topology, s: Rows, floor: np.ndarray, refinements: int) -> np.ndarray:
    """Return (N,) what is known of balanced states; floor: (N,) rounding errors of their residuals.

    Stable is what keeps a Cholesky factor less all doubt. The rest takes Newton steps, as many as allowed,
    until it is balanced to rounding. BALANCED: rigid motions may be idle or not, or forces left over matter.
    """
    K, blurred, doubt, unsettled = stiffness_and_doubts(topology, s, floor)
    found = np.where(are_positive(K, -np.maximum(doubt, unsettled)), STABLE, BALANCED)
    found[~s.is_covered] = BALANCED
    left = np.flatnonzero(s.is_covered & (found == BALANCED))
    if not len(left):
        return found
    s, K, floor, blurred, doubt = s.take(left), K[left], floor[left], blurred[left], doubt[left]
    softest = np.linalg.eigvalsh(K)[:, 0]
    word = np.where(softest > doubt, STABLE, NEUTRAL)
    word[(word == NEUTRAL) & (s.norm > VANISHED * floor * sqrt(s.X.shape[2]))] = BALANCED
    far = np.flatnonzero((refinements > 0) & (s.norm > floor))
    if len(far):
        there = refined(topology, s.take(far), K[far], (blurred[far], doubt[far]))
        nearer = np.flatnonzero(there.norm < s.norm[far])
        far = far[nearer]
        if len(far):
            word[far] = signs(topology, there.take(nearer), floor[far], refinements - 1)
    word[(softest < -blurred) | (s.l <= 2.0 * TINY).any(1)] = OPEN
    found[left] = word
    return found


def stiffness_and_doubts(topology: Topology, s: Rows, floor: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return K of what resists, stiff along loose motions; what rounding blurs, and what has no sign.

    The last, (N,): a softest stiffness above it keeps its sign on the way to the exact equilibrium.
    """
    taut, rests = topology.taut(s), s.l0 > 0.0
    resists = taut & ~((topology.least == 0.0) & rests & (s.t <= VANISHED * floor[:, None]))
    K = topology.stiffness(s, s.q, resists)
    reach = np.abs(s.X).max((1, 2))[:, None]
    own = s.k * (taut & rests) * (1.0 + (reach + np.abs(s.e)) / s.l)
    flat = K.reshape(len(K), -1)
    blurred = BLUR * sqrt(K.shape[1]) * np.sqrt(dot(flat, flat)) + 4.0 * EPS * own.max(1)
    shortest = np.where(rests & taut, s.l, np.inf).min(1)
    K += topology.loose_motions(s)
    unsettled = np.sqrt(SETTLED * s.stiffest / shortest * s.norm)
    return K, blurred, blurred + 4.0 * s.norm / shortest, unsettled


def refined(topology: Topology, s: Rows, K: np.ndarray, doubts: tuple[np.ndarray, ...]) -> Rows:
    """Return the better of two Newton steps, along all that is stiff beyond rounding, and beyond doubt."""
    values, vectors = np.linalg.eigh(K)
    along = (s.g[:, None] @ vectors)[:, 0]
    rates = (np.where(np.abs(values) > least[:, None], along / values, 0.0) for least in doubts)
    steps = (-(vectors @ rate[:, :, None])[:, :, 0] for rate in rates)
    best, other = (topology.at(s, topology.moved(s.X, step)) for step in steps)
    best.put(other.norm < best.norm, other)
    return Rows(**{**vars(s), **vars(best)})


def are_positive(K: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Return (N,) bool, whether K + shift, (N, f, f) and (N,), has a Cholesky factor."""
    M = shifted(K.copy(), shift[:, None])
    return np.array([dpotrf(a, overwrite_a=1)[1] == 0 for a in M.swapaxes(1, 2)], dtype=bool)
