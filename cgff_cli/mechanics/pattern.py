"""Sparse symmetric matrices over the nodes: one pattern, found once, and only refilled.

An element between two rows of the matrix puts a value (or a d x d block) on each of their diagonal places
and one on each of the two places between them. Which of these go where is a sparse matrix of ones, so that
filling is a product with it. Only for large scenes: this is what needs scipy.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from cgff_cli.mechanics.state import Mechanics

if TYPE_CHECKING:
    from scipy.sparse import csc_array, csr_array


class GraphPattern:
    """Compressed columns (indices, indptr) of a symmetric matrix with one row per chosen node.

    rows: (n,) int, node -> matrix row, -1 for a node that has none.
    sums: (nnz, 4 b) ones, from what elements put at their starts, at their ends, across and back, to data
    """

    def __init__(self, start: np.ndarray, end: np.ndarray, rows: np.ndarray):
        from scipy.sparse import csr_array

        self.start, self.end, self.nodes = start, end, np.flatnonzero(rows >= 0)
        self.size, self.count = len(self.nodes), len(rows)
        s, e, b = rows[start], rows[end], len(start)
        own = np.arange(self.size)
        row, column = np.concatenate((s, e, s, e, own)), np.concatenate((s, e, e, s, own))
        sources = np.flatnonzero((row >= 0) & (column >= 0))
        row, column = row[sources], column[sources]
        order = _sorted(row, np.arange(len(row)), self.size)
        order = _sorted(column, order, self.size)
        row, column, sources = row[order], column[order], sources[order]
        first = np.flatnonzero(np.diff(row, prepend=-1) | np.diff(column, prepend=-1))
        self.indices = row[first].astype(np.int32)
        self.indptr = np.searchsorted(column[first], np.arange(self.size + 1)).astype(np.int32)
        self.diagonal = np.flatnonzero(self.indices == column[first])
        # A node without elements still has a place: a source that counts nothing.
        counts, sources = (sources < 4 * b).astype(float), np.minimum(sources, 4 * b - 1)
        ends = np.append(first, len(sources))
        self.sums = csr_array((counts, sources.astype(np.int32), ends), shape=(len(first), 4 * b))

    def fill(
        self, at_start: np.ndarray, at_end: np.ndarray, across: np.ndarray, back: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the (nnz,) data of the matrix.

        at_start, at_end: (b,) what each element adds on the diagonal at its nodes; across: (b,) what it adds
        in its start's row and its end's column; back: the other way round, `across` by default.
        """
        return self.sums @ np.concatenate((at_start, at_end, across, across if back is None else back))

    def per_node(self, at_start: np.ndarray, at_end: np.ndarray) -> np.ndarray:
        """Return the (size,) sums of what elements put at their nodes, both (b,)."""
        sums = np.bincount(self.start, at_start, self.count) + np.bincount(self.end, at_end, self.count)
        return sums[self.nodes]

    def matrix(self, data: np.ndarray) -> "csc_array":
        """Return the matrix with (nnz,) data."""
        return _columns(self, data)

    def blocks(self) -> "csr_array":
        """Return (nnz, b): where an element adds to the data, and where it takes away."""
        from scipy.sparse import csr_array

        b, source = len(self.start), self.sums.indices
        signs = np.where(source < 2 * b, self.sums.data, -self.sums.data)
        return csr_array((signs, source % b, self.sums.indptr), shape=(len(self.indices), b))


def _columns(pattern: "GraphPattern | TangentPattern", data: np.ndarray) -> "csc_array":
    from scipy.sparse import csc_array

    return csc_array((data, pattern.indices, pattern.indptr), shape=(pattern.size, pattern.size))


def _sorted(keys: np.ndarray, order: np.ndarray, size: int) -> np.ndarray:
    """Return `order` sorted by keys (m,) below size, equal ones as they were: in time linear in m."""
    from scipy.sparse import coo_array

    m = len(order)
    counted = coo_array((np.ones(m, dtype=np.int8), (keys[order], np.arange(m))), shape=(size, m)).tocsr()
    return order[counted.indices]


class TangentPattern:
    """The tangent stiffness over the nodes that can move, node by node, as compressed columns.

    Directions in which such a node is held keep a row with nothing but `held` on the diagonal.
    """

    def __init__(self, mechanics: Mechanics):
        structure, moves = mechanics.structure, mechanics.moves
        n, self.d = structure.coordinates.shape
        rows = np.arange(n) if moves is None else np.where(moves, np.cumsum(moves) - 1, -1)
        self.graph = GraphPattern(structure.start, structure.end, rows)
        self.size = self.graph.size * self.d
        self._sums = self.graph.blocks()
        self._upper = np.triu_indices(self.d)
        self.indices, self.indptr = self._expanded()
        columns = np.repeat(np.arange(self.size), np.diff(self.indptr))
        self.diagonal = np.flatnonzero(self.indices == columns)
        self._held = None if mechanics.mask is None else mechanics.mask.T.reshape(-1) == 0.0
        if self._held is not None:
            self._cut = np.flatnonzero(self._held[self.indices] | self._held[columns])

    def fill(
        self,
        V: np.ndarray,
        w: np.ndarray,
        q: np.ndarray,
        shift: np.ndarray | float = 0.0,
        pins: Sequence[tuple[int, np.ndarray]] = (),
        held: float = 1.0,
    ) -> np.ndarray:
        """Return the data of K + shift: w V V^T + q I for each element; see mechanics.tangent.

        V: (d, b), w and q: (b,), shift: (rows,); pins: rows and (d, d) blocks to add to their diagonals.
        """
        i, j = self._upper
        wV, trace = w * V, np.flatnonzero(i == j)
        blocks = np.empty((len(q), len(i)))
        for place, (a, c) in enumerate(zip(i, j, strict=True)):
            blocks[:, place] = wV[a] * V[c]
        blocks[:, trace] += q[:, None]
        sums = self._sums @ blocks
        sums[self.graph.diagonal[:, None], trace] += np.reshape(shift, (-1, 1))
        for row, block in pins:
            sums[self.graph.diagonal[row]] += block[i, j]
        data = sums.reshape(-1)[self._order]
        if self._held is not None:
            data[self._cut] = 0.0
            data[self.diagonal[self._held]] = held
        return data

    def matrix(self, data: np.ndarray) -> "csc_array":
        """Return the matrix with (nnz,) data."""
        return _columns(self, data)

    def _expanded(self) -> tuple[np.ndarray, np.ndarray]:
        """Return indices and indptr of the scalar matrix and remember where its entries stand in the sums."""
        from scipy.sparse import bsr_array

        graph, d = self.graph, self.d
        place = np.zeros((d, d))
        place[self._upper] = np.arange(len(self._upper[0]))
        place = np.maximum(place, place.T)
        numbers = np.arange(len(graph.indices))[:, None, None] * float(len(self._upper[0])) + place
        shape = (self.size, self.size)
        scalar = bsr_array((numbers, graph.indices, graph.indptr), shape=shape).tocsr()
        self._order = scalar.data.astype(np.intp)
        return scalar.indices, scalar.indptr
