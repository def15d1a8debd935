"""Lanczos' method: the largest values of a symmetric operator, and their vectors."""

from collections.abc import Callable

import numpy as np

Operator = Callable[[np.ndarray], np.ndarray]

MOST_VECTORS = 200

CLOSE = 1e-8
"""Residual of a vector, relative, at which it is found."""


def largest_of(inverse: Operator, start: np.ndarray, count: int, room: int) -> tuple[np.ndarray, bool]:
    """Return orthonormal vectors to a symmetric operator's largest values, and whether the largest was found.

    They are (f, c), c up to count: as many as were found, one at least. Lanczos' method from the columns of
    start, (f, width), side by side, with all vectors kept and orthogonalised twice. room: dimension of where
    it acts.
    """
    Q, T, width = np.linalg.qr(start)[0], np.zeros((0, 0)), start.shape[1]
    while True:
        z, size = inverse(Q[:, -width:]), Q.shape[1]
        column = Q.T @ z
        T = np.block([[T, column[:-width]], [column[:-width].T, column[-width:]]])
        z -= Q @ column
        z -= Q @ (Q.T @ z)
        onward, beside = np.linalg.qr(z)
        values, vectors = np.linalg.eigh(0.5 * (T + T.T))
        left = np.linalg.norm(beside @ vectors[-width:, -count:], axis=0)
        lacks = (left > CLOSE * np.abs(values[-count:])) & (size < room)
        if not lacks.any() or size >= MOST_VECTORS:
            break
        width = min(width, room - size)
        Q = np.concatenate((Q, onward[:, :width]), axis=1)
    found = int(np.argmax(lacks[::-1])) if lacks.any() else count
    x = Q @ vectors[:, -max(found, 1) :]
    for _ in range(2):  # where K is all but singular its inverse is hardly linear, and x is the better for it
        x = np.linalg.qr(inverse(x))[0]
    return x, found > 0
