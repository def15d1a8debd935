"""Rigid motions: what moves a structure without deforming it. Directions run axis by axis."""

from functools import cache
from math import sqrt

import numpy as np

from cgff_cli.mechanics.norms import norm

FLAT = 1e-10
"""Relative size below which a rotation moves nothing (a collinear structure about its own line)."""

CLEARLY = 1e-6
"""Least eigenvalue of H^T H, H what supports hold of rigid motions, at which they plainly hold them all."""

UNTURNED = 1e-12
"""Share of the forces that a rotation may seem to turn by rounding alone."""


class RigidMotions:
    """The rigid motions that supports allow. X: (d, n) positions; free: (d, n) bool.

    basis: (f, r) orthonormal, rows are the f free directions. A plane free body has r = 3, a spatial one 6;
    one whose nodes lie on a line has one rotation less.
    """

    def __init__(self, X: np.ndarray, free: np.ndarray):
        self.X, self.free = X, free.reshape(-1)
        motions, chosen = all_motions(X), None
        if not self.free.all():
            chosen = _at_rest(motions[~self.free])
            motions = motions[self.free] @ chosen
        self.basis = motions[:, :0]
        if motions.size:
            left, values, rows = np.linalg.svd(motions, full_matrices=False)
            count = int((values > FLAT).sum())
            self.basis, own = left[:, :count], rows[:count].T / values[:count]
            self._own = own if chosen is None else chosen @ own  # of the columns of all_motions

    def idle(self, F: np.ndarray, blur: float) -> np.ndarray:
        """Return an orthonormal basis (f, i) of those that leave a balanced structure balanced.

        F: (d, n) loads and reactions. Moved rigidly, the forces in a body turn with it and those on it do
        not: K r is the rate at which r turns F, and a motion that turns none of it costs nothing to second
        order. blur: error of F in directions held at nodes that are free in others.
        """
        if not self.basis.size:
            return self.basis
        size = norm(_centred(self.X)) or 1.0
        turned = (_rates(np.concatenate((np.zeros((1, F.shape[1])), F))) @ self._own)[self.free] / size
        _, values, rows = np.linalg.svd(turned, full_matrices=False)
        error = (UNTURNED * norm(F) + blur * sqrt(F.shape[1])) / size * norm(self._own)
        return self.basis @ rows[int((values > error).sum()) :].T


def all_motions(X: np.ndarray) -> np.ndarray:
    """Return d translations and d (d - 1) / 2 rotations about the centroid as columns, (d n, r).

    Columns are about as long as each other; they are not orthonormal.
    """
    (d, n), about = X.shape, _centred(X)
    P = np.full((d + 1, n), 1.0 / sqrt(n))
    P[1:] = about * (1.0 / (norm(about) or 1.0))
    return _rates(P)


def _at_rest(held: np.ndarray) -> np.ndarray:
    """Return orthonormal combinations (r, c) of motions that rest where held; held: (h, r) rates there."""
    r = held.shape[1]
    if np.linalg.eigvalsh(held.T @ held)[0] > CLEARLY:
        return np.zeros((r, 0))
    _, values, rows = np.linalg.svd(np.concatenate((held, np.zeros((r, r)))), full_matrices=False)
    return rows[int((values > FLAT).sum()) :].T


def _rates(P: np.ndarray) -> np.ndarray:
    """Return (d n, r) rates at which rigid motions move P, (1 + d, n): a row of units, and vectors."""
    d, n = len(P) - 1, P.shape[1]
    G = generators(d)
    return (G.reshape(-1, d + 1) @ P).reshape(d, -1, n).swapaxes(1, 2).reshape(d * n, -1)


@cache
def generators(d: int) -> np.ndarray:
    """Return (d, r, 1 + d): by which share of P's rows each motion moves each axis."""
    planes = [(i, j) for i in range(d) for j in range(i + 1, d)]
    G = np.zeros((d, d + len(planes), 1 + d))
    for a in range(d):
        G[a, a, 0] = 1.0
    for r, (i, j) in enumerate(planes, start=d):
        G[i, r, 1 + j], G[j, r, 1 + i] = 1.0, -1.0
    return G


def _centred(X: np.ndarray) -> np.ndarray:
    return X - (np.add.reduce(X, 1) * (1.0 / X.shape[1]))[:, None]
