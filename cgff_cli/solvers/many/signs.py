"""What is known of rows that balance, by the doubts of `mechanics.signs` and `analysis.stability`."""

from math import sqrt

import numpy as np
from scipy.linalg.lapack import dpotrf

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.rigid import FLAT
from cgff_cli.mechanics.signs import BLUR, SETTLED
from cgff_cli.solvers.many.rows import Batch, Topology, flat, norms, rigid_motions
from cgff_cli.solvers.stopping import VANISHED

OPEN, NEUTRAL, STABLE = range(3)
WORDS = np.array([None, "neutral", "stable"], dtype=object)


def references(topology: Topology, r: Batch, s: Batch) -> tuple[np.ndarray, np.ndarray]:
    """Return reference and floor, (N,) each, as `Gauge.measure` does."""
    floor = ((r.k * s.rounding)[:, None] @ np.abs(topology.rho)).max((1, 2))
    reference = np.maximum(np.abs(s.t).max(1), r.load)
    vanished = (reference <= VANISHED * np.maximum(floor, EPS * r.at_start)) & (r.load == 0.0)
    whole = np.maximum((r.k * s.l).max(1), r.at_start)
    return np.where(vanished, whole, reference), np.where(vanished, np.maximum(floor, EPS * whole), floor)


def signs(topology: Topology, r: Batch, s: Batch, floor: np.ndarray) -> np.ndarray:
    """Return (N,) OPEN, NEUTRAL or STABLE for balanced states; floor: (N,) rounding errors of residuals.

    Stable is what keeps a Cholesky factor less all doubt. Of the rest, what is balanced to rounding, and
    where no rigid motion is idle but those of a free body, has the sign of its softest stiffness.
    """
    K, blurred, doubt, unsettled = _stiffness_and_doubts(topology, r, s, floor)
    M = K - np.maximum(doubt, unsettled)[:, None, None] * np.eye(K.shape[1])
    is_finite = np.isfinite(norms(flat(M)))  # dpotrf does not say
    factored = [dpotrf(a, overwrite_a=1)[1] == 0 for a in M.swapaxes(1, 2)]
    found = np.where(is_finite & np.array(factored, dtype=bool), STABLE, OPEN)
    left = np.flatnonzero((found == OPEN) & (s.norm <= floor) & is_finite)
    left = left[_rests(topology, r.load[left], s.X[left])]
    softest = np.linalg.eigvalsh(K[left])[:, 0]
    word = np.where(softest > doubt[left], STABLE, NEUTRAL)
    found[left] = np.where(softest < -blurred[left], OPEN, word)
    return found


def _stiffness_and_doubts(
    topology: Topology, r: Batch, s: Batch, floor: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Return K of what resists, stiff along motions of a free body; what rounding blurs, and has no sign.

    A cable that what is out of balance may slacken resists nothing. The last, (N,): a softest stiffness
    above it keeps its sign on the way to the exact equilibrium.
    """
    sure, slight = s.taut & (r.l0 > 0.0), VANISHED * np.maximum(floor, s.norm)
    may_slacken = (topology.least == 0.0) & sure & (s.t <= slight[:, None])
    K = topology.stiffness(r, s, s.q, s.taut & ~may_slacken, np.zeros_like(floor))
    if not len(topology.held):
        R = rigid_motions(s.X)
        K += ((r.load == 0.0) * r.S.mean(1) / R.shape[2])[:, None, None] * R.swapaxes(1, 2) @ R
    reach, shortest = np.abs(s.X).max((1, 2))[:, None], np.where(sure, s.l, np.inf).min(1)
    own = r.k * sure * (1.0 + (reach + np.abs(s.e)) / s.l)
    blurred = BLUR * sqrt(K.shape[1]) * norms(flat(K)) + 4.0 * EPS * own.max(1)
    unsettled = np.sqrt(SETTLED * r.S.max(1) / shortest * s.norm)
    return K, blurred, blurred + 4.0 * s.norm / shortest, unsettled


def _rests(topology: Topology, load: np.ndarray, X: np.ndarray) -> np.ndarray:
    """Return (N,) bool, whether loads and supports leave no rigid motion but those that K has got stiff."""
    if not len(topology.held):
        return load == 0.0
    R = rigid_motions(X).take(topology.held, axis=2)
    if R.shape[2] < R.shape[1]:
        return np.zeros(len(X), dtype=bool)
    return np.linalg.svd(R, compute_uv=False)[:, -1] > FLAT
