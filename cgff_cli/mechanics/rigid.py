"""Rigid motions: what moves a structure without deforming it."""

from math import sqrt

import numpy as np

from cgff_cli.mechanics.norms import norm


def _turns(d: int) -> np.ndarray:
    """Return (d, d r): a position times this is its d velocities under each of the r unit rotations."""
    planes = [(i, j) for i in range(d) for j in range(i + 1, d)]
    turns = np.zeros((d, d, len(planes)))
    for r, (i, j) in enumerate(planes):
        turns[j, i, r], turns[i, j, r] = -1.0, 1.0
    return turns.reshape(d, -1)


UNITS = {d: np.eye(d) for d in (2, 3)}
TURNS = {d: _turns(d) for d in (2, 3)}

FLAT = 1e-10
"""Relative size below which a rotation moves nothing (a collinear structure about its own line)."""

UNTURNED = 1e-12
"""Share of the forces that a rotation may seem to turn by rounding alone."""


def rigid_motions(X: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis (m, r) of the rigid motions that the supports allow.

    X: (n, d) positions; free: (n, d) bool. Rows are the m free directions, node by node. A plane free
    body has r = 3, a spatial one 6; one whose nodes lie on a line has one rotation less.
    """
    return (all_motions(X) @ _allowed(X, free))[free.reshape(-1)]


def idle_motions(X: np.ndarray, free: np.ndarray, F: np.ndarray, blur: float) -> np.ndarray:
    """Return an orthonormal basis (m, r) of the rigid motions that leave a balanced structure balanced.

    F: (n, d) loads and reactions. Moved rigidly, the forces in a body turn with it and those on it do not:
    K r is the rate at which r turns F, and a motion that turns none of it costs nothing to second order.
    blur: error of F in directions held at nodes that are free in others.
    """
    own = _allowed(X, free)
    rates = _rotation_rates(X, F).reshape(F.size, -1)
    turned = (rates @ own[F.shape[1] :])[free.reshape(-1)]
    _, values, rows = np.linalg.svd(turned, full_matrices=False)
    error = (UNTURNED * norm(F) + blur * sqrt(len(F))) / _size(X) * norm(own)
    return (all_motions(X) @ (own @ rows[int((values > error).sum()) :].T))[free.reshape(-1)]


def all_motions(X: np.ndarray) -> np.ndarray:
    """Return d translations and d (d - 1) / 2 rotations about the centroid as columns, (n d, r).

    Columns are about as long as each other; they are not orthonormal.
    """
    n, d = X.shape
    X = X - X.mean(axis=0)
    motions = np.empty((n, d, d * (d + 1) // 2))
    motions[:, :, :d] = UNITS[d] * (1.0 / sqrt(n))
    motions[:, :, d:] = _rotation_rates(X, X)
    return motions.reshape(n * d, -1)


def _rotation_rates(X: np.ndarray, vectors: np.ndarray) -> np.ndarray:
    """Return (n, d, r) velocities of vectors under rotations that move the nodes X by about unit length."""
    n, d = vectors.shape
    return (vectors @ TURNS[d]).reshape(n, d, -1) * (1.0 / _size(X))


def _size(X: np.ndarray) -> float:
    return norm(X - X.mean(axis=0)) or 1.0


def _allowed(X: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Return (c, r) combinations of the c columns of `all_motions` orthonormal and at rest on supports."""
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
