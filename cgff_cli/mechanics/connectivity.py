"""The connectivity matrix rho, eq. (1), as the two products that the mechanics needs.

rho is b x n: +1 at an element's begin node, -1 at its end node. Element vectors rho X change sign with
an element's direction; U, D, forces and energy do not. Only nodes that can move have a column here: what
the others add to the element vectors does not change.
"""

from functools import cached_property
from typing import Literal

import numpy as np

DENSE_ENTRIES = 20_000
"""Up to this many entries a dense rho is faster than any indexing, and needs no scipy."""


def dense(start: np.ndarray, end: np.ndarray, node_count: int) -> np.ndarray:
    """Return rho^T, (n, b), eq. (1), of elements from nodes start to nodes end, both (b,)."""
    rho_t = np.zeros((node_count, len(start)))
    columns = np.arange(len(start))
    rho_t[start, columns] = 1.0
    rho_t[end, columns] = -1.0
    return rho_t


class _Graph:
    """Which nodes elements join; start, end: (b,) node rows, X: (d, n), moves: (n,) bool or None for all."""

    def __init__(self, start: np.ndarray, end: np.ndarray, X: np.ndarray, moves: np.ndarray | None):
        self.ends, self.moves, (self.d, self.n) = (start, end), moves, X.shape
        self.fixed: np.ndarray | None = None

    @cached_property
    def places(self) -> np.ndarray:
        """(4 d d b,) where d x d blocks go in a flat matrix over the directions of nodes that move.

        In order: at either end of an element, from start to end, and back; what a node that does not move
        would have goes behind the last entry.
        """
        moves = np.ones(self.n, dtype=bool) if self.moves is None else self.moves
        m = int(moves.sum())
        row, column = (axes[:, None] * m for axes in np.divmod(np.arange(self.d * self.d), self.d))
        nodes, size = np.cumsum(moves) - 1, self.d * m
        start, end = self.ends
        pairs = ((start, start), (end, end), (start, end), (end, start))
        found = [
            np.where(moves[i] & moves[j], (row + nodes[i]) * size + column + nodes[j], size * size)
            for i, j in pairs
        ]
        return np.concatenate(found, axis=None)


class DenseConnectivity(_Graph):
    """rho over the nodes that move; rho_t: (m, b), fixed: (d, b) what the others add to the vectors, or 0."""

    is_small: Literal[True] = True

    def __init__(self, start: np.ndarray, end: np.ndarray, X: np.ndarray, moves: np.ndarray | None):
        super().__init__(start, end, X, moves)
        self.rho_t = dense(start, end, self.n)
        if moves is not None:
            self.fixed = X[:, ~moves] @ self.rho_t[~moves]
            self.rho_t = self.rho_t[moves]
        self.rho = np.ascontiguousarray(self.rho_t.T)

    @cached_property
    def pairs(self) -> np.ndarray | None:
        """(b, m m) rho^T rho of every element by itself; None where that is more than a dense rho may be."""
        b, m = self.rho.shape
        if b * m * m > DENSE_ENTRIES:
            return None
        return (self.rho[:, :, None] * self.rho[:, None, :]).reshape(b, m * m)

    def differences(self, X: np.ndarray) -> np.ndarray:
        """Return rho X: (d, ..., b) begin minus end of (d, ..., m) positions of the nodes that move."""
        return X.dot(self.rho_t)

    def gather(self, V: np.ndarray) -> np.ndarray:
        """Return rho^T V: (d, ..., m) sums over each node's elements of (d, ..., b) element vectors."""
        return V.dot(self.rho)


class SparseConnectivity(_Graph):
    """The same for large structures; one axis at a time, so that each is contiguous."""

    is_small: Literal[False] = False
    pairs: None = None

    def __init__(self, start: np.ndarray, end: np.ndarray, X: np.ndarray, moves: np.ndarray | None):
        from scipy.sparse import csr_array

        super().__init__(start, end, X, moves)
        moving = np.ones(self.n, dtype=bool) if moves is None else moves
        b, m = len(start), int(moving.sum())
        rows = np.where(moving, np.cumsum(moving) - 1, m)  # what does not move stands last, at 0
        self._rows = rows[start], rows[end]
        if moves is not None:
            still = np.where(moves, 0.0, X)
            self.fixed = still[:, start] - still[:, end]
        ends = np.stack(self._rows, axis=1).reshape(-1)
        rho = csr_array((np.tile((1.0, -1.0), b), ends, 2 * np.arange(b + 1)), shape=(b, m + 1))
        self._rho_t = rho.T.tocsr()[:m]

    def differences(self, X: np.ndarray) -> np.ndarray:
        """Return rho X, (d, b), of (d, m) positions of the nodes that move."""
        X = np.concatenate((X, np.zeros((len(X), 1))), axis=1)
        start, end = self._rows
        return X.take(start, axis=1) - X.take(end, axis=1)

    def gather(self, V: np.ndarray) -> np.ndarray:
        """Return rho^T V, (d, m), of (d, b) element vectors."""
        return np.stack([self._rho_t @ v for v in V])


Connectivity = DenseConnectivity | SparseConnectivity


def connectivity(start: np.ndarray, end: np.ndarray, X: np.ndarray, moves: np.ndarray | None) -> Connectivity:
    """Return rho for (d, n) positions; moves: (n,) bool, None where all nodes move."""
    small = len(start) * X.shape[1] <= DENSE_ENTRIES
    return (DenseConnectivity if small else SparseConnectivity)(start, end, X, moves)
