"""The connectivity matrix rho, eq. (1), as the two products that the mechanics needs.

rho is b x n: +1 at an element's begin node, -1 at its end node. Element vectors rho X change sign with
an element's direction; U, D, forces and energy do not.
"""

from functools import cached_property

import numpy as np

DENSE_ENTRIES = 20_000
"""Up to this many entries a dense rho is faster than any indexing, and needs no scipy."""


class Connectivity:
    """rho for b elements (rows begin, end) between n nodes."""

    def __init__(self, start: np.ndarray, end: np.ndarray, node_count: int):
        self.start, self.end, self.node_count = start, end, node_count
        self.is_small = len(start) * node_count <= DENSE_ENTRIES
        if self.is_small:
            self._rho = self.dense
            self._transpose = np.ascontiguousarray(self._rho.T)

    @cached_property
    def dense(self) -> np.ndarray:
        """rho as a (b, n) array, eq. (1)."""
        rho = np.zeros((len(self.start), self.node_count))
        rows = np.arange(len(self.start))
        rho[rows, self.start] += 1.0
        rho[rows, self.end] -= 1.0
        return rho

    @cached_property
    def _sparse(self):  # type: ignore[no-untyped-def]
        """rho and rho^T, both by rows: a product costs a fifth of indexing nodes by element."""
        from scipy.sparse import csr_array

        b = len(self.start)
        ends = np.stack((self.start, self.end), axis=1).reshape(-1)
        shape = (b, self.node_count)
        rho = csr_array((np.tile((1.0, -1.0), b), ends, 2 * np.arange(b + 1)), shape=shape)
        return rho, rho.T.tocsr()

    def differences(self, X: np.ndarray) -> np.ndarray:
        """Return rho X: (b, d) element vectors, begin minus end, of (n, d) positions."""
        if self.is_small:
            return self._rho @ X
        return self._sparse[0] @ X

    def gather(self, V: np.ndarray) -> np.ndarray:
        """Return rho^T V: (n, d) sums over each node's elements of (b, d) element vectors."""
        if self.is_small:
            return self._transpose @ V
        return self._sparse[1] @ V
