"""Rigid motions: what moves a structure without deforming it. Directions run axis by axis."""

from math import sqrt

import numpy as np

from cgff_cli.mechanics.norms import norm

FLAT = 1e-10
"""Relative size below which a rotation moves nothing (a collinear structure about its own line)."""

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
            held = motions[~self.free]
            held = np.concatenate((held, np.zeros((motions.shape[1],) * 2)))  # as many rows as motions
            _, values, rows = np.linalg.svd(held, full_matrices=False)
            chosen = rows[int((values > FLAT).sum()) :].T
            motions = (motions @ chosen)[self.free]
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
        turned = (_rotations(F, _size(self.X)) @ self._own[len(F) :])[self.free]
        _, values, rows = np.linalg.svd(turned, full_matrices=False)
        error = (UNTURNED * norm(F) + blur * sqrt(F.shape[1])) / _size(self.X) * norm(self._own)
        return self.basis @ rows[int((values > error).sum()) :].T


def all_motions(X: np.ndarray) -> np.ndarray:
    """Return d translations and d (d - 1) / 2 rotations about the centroid as columns, (d n, r).

    Columns are about as long as each other; they are not orthonormal.
    """
    d, n = X.shape
    shifts = np.zeros((d, n, d))
    np.einsum("ana->an", shifts)[:] = 1.0 / sqrt(n)  # a view of shifts
    return np.concatenate((shifts.reshape(d * n, d), _rotations(_centred(X), _size(X))), axis=1)


def rigid_stiffness(X: np.ndarray) -> np.ndarray:
    """Return R R^T, (d n, d n), of the columns R of `all_motions`, without forming them.

    Rotations add up to c (I (x) X^T X) less c X_c^T X_a in block (a, c), X about its centroid, c = 1 / |X|^2.
    """
    d, n = X.shape
    X = _centred(X)
    c = 1.0 / (float(np.vdot(X, X)) or 1.0)
    P = np.multiply.outer(X, -c * X)
    P = P.transpose(2, 1, 0, 3).reshape(d, n, d, n)
    on_each_axis = np.einsum("aiaj->aij", P)  # a view of P
    on_each_axis += X.T @ (c * X) + 1.0 / n
    return P.reshape(d * n, d * n)


def _rotations(vectors: np.ndarray, size: float) -> np.ndarray:
    """Return (d n, r) rates of (d, n) vectors under unit rotations, over `size`."""
    d, n = vectors.shape
    planes = [(i, j) for i in range(d) for j in range(i + 1, d)]
    rates = np.zeros((d, n, len(planes)))
    for r, (i, j) in enumerate(planes):
        rates[i, :, r], rates[j, :, r] = vectors[j], -vectors[i]
    return rates.reshape(d * n, -1) * (1.0 / size)


def _centred(X: np.ndarray) -> np.ndarray:
    return X - (np.add.reduce(X, 1) * (1.0 / X.shape[1]))[:, None]


def _size(X: np.ndarray) -> float:
    return norm(_centred(X)) or 1.0
