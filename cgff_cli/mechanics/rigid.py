"""Rigid motions: what moves a structure without deforming it."""

import numpy as np

FLAT = 1e-10
"""Relative size below which a rotation moves nothing (a collinear structure about its own line)."""


def rigid_motions(X: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis (m, r) of the rigid motions that the supports allow.

    X: (n, d) positions; free: (n, d) bool. Rows are the m free directions, node by node. A plane free
    body has r = 3, a spatial one 6; one whose nodes lie on a line has one rotation less.
    """
    motions = _orthonormal(_all_motions(X))
    if free.all():
        return motions
    held = motions[~free.reshape(-1)]
    _, values, rows = np.linalg.svd(held, full_matrices=True)
    rank = int((values > FLAT).sum())
    return _orthonormal(motions @ rows[rank:].T)[free.reshape(-1)]


def _all_motions(X: np.ndarray) -> np.ndarray:
    """Return d translations and d (d - 1) / 2 rotations about the centroid as columns, (n d, r)."""
    n, d = X.shape
    Y = X - X.mean(axis=0)
    Y = Y / (np.abs(Y).max() or 1.0)
    columns = [np.broadcast_to(axis, (n, d)) for axis in np.eye(d)]
    for i in range(d):
        for j in range(i + 1, d):
            turn = np.zeros((n, d))
            turn[:, i], turn[:, j] = -Y[:, j], Y[:, i]
            columns.append(turn)
    return np.stack([column.reshape(-1) for column in columns], axis=1)


def _orthonormal(columns: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the columns' span."""
    left, values, _ = np.linalg.svd(columns, full_matrices=False)
    return left[:, values > FLAT * values[0]] if len(values) else columns
