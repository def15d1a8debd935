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


def rigid_motions(X: np.ndarray, free: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis (m, r) of the rigid motions that the supports allow.

    X: (n, d) positions; free: (n, d) bool. Rows are the m free directions, node by node. A plane free
    body has r = 3, a spatial one 6; one whose nodes lie on a line has one rotation less.
    """
    motions = _orthonormal(all_motions(X - X.mean(axis=0)))
    if free.all():
        return motions
    held = motions[~free.reshape(-1)]
    held = np.concatenate((held, np.zeros_like(motions[: motions.shape[1]])))  # as many rows as motions
    _, values, rows = np.linalg.svd(held, full_matrices=False)
    rank = int((values > FLAT).sum())
    return _orthonormal(motions @ rows[rank:].T)[free.reshape(-1)]


def all_motions(X: np.ndarray) -> np.ndarray:
    """Return d translations and d (d - 1) / 2 rotations about the origin as columns, (n d, r).

    Columns are about as long as each other when X is centred; they are not orthonormal.
    """
    n, d = X.shape
    turns = (X @ TURNS[d]).reshape(n, d, -1)
    motions = np.empty((n, d, d + turns.shape[2]))
    motions[:, :, :d] = UNITS[d] * (1.0 / sqrt(n))
    np.multiply(turns, 1.0 / (norm(X) or 1.0), out=motions[:, :, d:])
    return motions.reshape(n * d, -1)


def _orthonormal(columns: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the columns' span."""
    left, values, _ = np.linalg.svd(columns, full_matrices=False)
    return left[:, values > FLAT * values[0]] if len(values) else columns
