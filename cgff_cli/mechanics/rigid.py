"""Rigid motions: what moves a structure without deforming it. Directions run axis by axis."""

from functools import cache
from math import sqrt

import numpy as np

from cgff_cli.mechanics.norms import norm

FLAT = 1e-10
"""Relative size below which a rotation moves nothing (a collinear structure about its own line)."""

UNTURNED = 1e-12
"""Share of the forces that a rotation may seem to turn by rounding alone."""


def rigid_motions(X: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis (f, r) of the rigid motions that the supports allow.

    X: (d, n) positions; free: (d, n) bool. Rows are the f free directions. A plane free body has r = 3, a
    spatial one 6; one whose nodes lie on a line has one rotation less.
    """
    return (all_motions(X) @ _allowed(X, free))[free.reshape(-1)]


def idle_motions(X: np.ndarray, free: np.ndarray, F: np.ndarray, blur: float) -> np.ndarray:
    """Return an orthonormal basis (f, r) of the rigid motions that leave a balanced structure balanced.

    F: (d, n) loads and reactions. Moved rigidly, the forces in a body turn with it and those on it do not:
    K r is the rate at which r turns F, and a motion that turns none of it costs nothing to second order.
    blur: error of F in directions held at nodes that are free in others.
    """
    own = _allowed(X, free)
    turned = (_rotations(F, _size(X)) @ own[len(F) :])[free.reshape(-1)]
    _, values, rows = np.linalg.svd(turned, full_matrices=False)
    error = (UNTURNED * norm(F) + blur * sqrt(F.shape[1])) / _size(X) * norm(own)
    return (all_motions(X) @ (own @ rows[int((values > error).sum()) :].T))[free.reshape(-1)]


def all_motions(X: np.ndarray) -> np.ndarray:
    """Return d translations and d (d - 1) / 2 rotations about the centroid as columns, (d n, r).

    Columns are about as long as each other; they are not orthonormal.
    """
    (d, n), centred = X.shape, _centred(X)
    shifts = np.repeat(np.eye(d) * (1.0 / sqrt(n)), n, axis=0)
    return np.concatenate((shifts, _rotations(centred, norm(centred) or 1.0)), axis=1)


@cache
def turns(d: int) -> np.ndarray:
    """Return the rates (r d, d) at which unit rotations in each coordinate plane turn the axes."""
    planes = [(i, j) for i in range(d) for j in range(i + 1, d)]
    rates = np.zeros((len(planes), d, d))
    for r, (i, j) in enumerate(planes):
        rates[r, i, j], rates[r, j, i] = 1.0, -1.0
    return rates.reshape(-1, d)


def _rotations(vectors: np.ndarray, size: float) -> np.ndarray:
    """Return (d n, r) rates of (d, n) vectors under unit rotations, over `size`."""
    return (turns(len(vectors)).dot(vectors) * (1.0 / size)).reshape(-1, vectors.size).T


def _centred(X: np.ndarray) -> np.ndarray:
    return X - (np.add.reduce(X, 1) * (1.0 / X.shape[1]))[:, None]


def _size(X: np.ndarray) -> float:
    return norm(_centred(X)) or 1.0


def _allowed(X: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Return (c, r) combinations of the c columns of `all_motions`, orthonormal and at rest on supports."""
    motions = all_motions(X)
    chosen = np.eye(motions.shape[1])
    if not free.all():
        held = motions[~free.reshape(-1)]
        held = np.concatenate((held, np.zeros_like(chosen)))  # as many rows as motions
        _, values, rows = np.linalg.svd(held, full_matrices=False)
        chosen = rows[int((values > FLAT).sum()) :].T
    _, values, rows = np.linalg.svd((motions @ chosen)[free.reshape(-1)], full_matrices=False)
    kept = values > FLAT
    return chosen @ (rows[kept].T / values[kept])
