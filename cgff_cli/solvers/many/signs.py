"""What is known of rows that balance, by the doubts of `mechanics.signs` and `analysis.stability`."""

from math import sqrt

import numpy as np
from scipy.linalg.lapack import dpotrf

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.rigid import FLAT
from cgff_cli.mechanics.signs import BLUR, SETTLED
from cgff_cli.solvers.many.rows import Rows, Topology, all_motions, dot, flat, shifted
from cgff_cli.solvers.stopping import VANISHED

OPEN, BALANCED, NEUTRAL, STABLE = range(4)
"""What is known of a row: nothing, so that it is for form_find; that forces balance; its stability too."""


def measured(topology: Topology, r: Rows, s: Rows) -> tuple[np.ndarray, np.ndarray]:
    """Return reference and floor, (N,) each, as `Gauge.measure` does."""
    floor = ((r.k * topology.rounding(s))[:, None] @ topology.ends).max((1, 2))
    reference = np.maximum(np.abs(s.t).max(1), r.load)
    vanished = (reference <= VANISHED * np.maximum(floor, EPS * r.at_start)) & (r.load == 0.0)
    largest = np.maximum((r.k * s.l).max(1), r.at_start)
    return np.where(vanished, largest, reference), np.where(vanished, np.maximum(floor, EPS * largest), floor)


def signs(topology: Topology, r: Rows, s: Rows, floor: np.ndarray) -> np.ndarray:
    """Return (N,) what is known of balanced states; floor: (N,) rounding errors of their residuals.

    Stable is what keeps a Cholesky factor less all doubt. Of the rest, what is balanced to rounding, and
    where no rigid motion is idle but those of a free body, has the sign of its softest stiffness.
    """
    K, blurred, doubt, unsettled = _stiffness_and_doubts(topology, r, s, floor)
    M = shifted(K.copy(), -np.maximum(doubt, unsettled)[:, None])
    factored = [dpotrf(a, overwrite_a=1)[1] == 0 for a in M.swapaxes(1, 2)]
    found = np.where(np.array(factored, dtype=bool), STABLE, BALANCED)
    left = np.flatnonzero((found == BALANCED) & (s.norm <= floor))
    left = left[_rests(topology, r.take(left), s.X[left])]
    softest = np.linalg.eigvalsh(K[left])[:, 0]
    word = np.where(softest > doubt[left], STABLE, NEUTRAL)
    found[left] = np.where(softest < -blurred[left], OPEN, word)
    return found


def _stiffness_and_doubts(topology: Topology, r: Rows, s: Rows, floor: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return K of what resists, stiff along motions of a free body; what rounding blurs, and has no sign.

    The last, (N,): a softest stiffness above it keeps its sign on the way to the exact equilibrium.
    """
    taut, rests, slight = topology.taut(r, s), r.l0 > 0.0, VANISHED * np.maximum(floor, s.norm)
    resists = taut & ~((topology.least == 0.0) & rests & (s.t <= slight[:, None]))
    K = topology.stiffness(r, s, s.q, resists)
    reach = np.abs(s.X).max((1, 2))[:, None]
    own = r.k * (taut & rests) * (1.0 + (reach + np.abs(s.e)) / s.l)
    entries = flat(K)
    blurred = BLUR * sqrt(K.shape[1]) * np.sqrt(dot(entries, entries)) + 4.0 * EPS * own.max(1)
    if not len(topology.fixed):
        R = all_motions(s.X)
        K += ((r.load == 0.0) * r.k.mean(1))[:, None, None] * R.swapaxes(1, 2) @ R
    shortest = np.where(rests & taut, s.l, np.inf).min(1)
    unsettled = np.sqrt(SETTLED * r.S.max(1) / shortest * s.norm)
    return K, blurred, blurred + 4.0 * s.norm / shortest, unsettled


def _rests(topology: Topology, r: Rows, X: np.ndarray) -> np.ndarray:
    """Return (N,) bool, whether loads and supports leave no rigid motion but those that K has got stiff."""
    if not len(topology.fixed):
        return r.load == 0.0
    held = all_motions(X).take(topology.fixed, axis=2)
    if held.shape[2] < held.shape[1]:
        return np.zeros(len(X), dtype=bool)
    return np.linalg.svd(held, compute_uv=False)[:, -1] > FLAT
