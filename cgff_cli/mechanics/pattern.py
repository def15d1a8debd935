"""Sparse symmetric matrices over the nodes: one pattern, found once, and only refilled.

An element between two rows of the matrix puts a value (or a d x d block) on each of their diagonal places
and one on each of the two places between them. Only for large scenes: this is what needs scipy.
"""

from typing import TYPE_CHECKING

import numpy as np

from cgff_cli.mechanics.state import Mechanics

if TYPE_CHECKING:
    from scipy.sparse import csc_array


class GraphPattern:
    """Compressed columns (indices, indptr) of a symmetric matrix with one row per chosen node.

    rows: (n,) int, node -> matrix row, -1 for a node that has none.
    """

    def __init__(self, start: np.ndarray, end: np.ndarray, rows: np.ndarray):
        from scipy.sparse import coo_array

        self.start, self.end = start, end
        self.nodes = np.flatnonzero(rows >= 0)
        self.size = len(self.nodes)
        self.between = np.flatnonzero((rows[start] >= 0) & (rows[end] >= 0))
        s, e = rows[start[self.between]], rows[end[self.between]]
        diagonal = np.arange(self.size)
        where = np.concatenate((diagonal, s, e)), np.concatenate((diagonal, e, s))
        count = len(where[0])
        shape = (self.size, self.size)
        numbered = coo_array((np.arange(count, dtype=float), where), shape=shape).tocsc()
        numbered.sort_indices()
        self.indices, self.indptr = numbered.indices, numbered.indptr
        columns = np.repeat(diagonal, np.diff(self.indptr))
        self.diagonal = np.flatnonzero(self.indices == columns)
        if numbered.nnz == count:
            self._source: np.ndarray | None = numbered.data.astype(np.intp)
        else:  # parallel elements share a place: add up by place instead of picking by source
            self._source = None
            places = columns * self.size + self.indices
            self._place = np.searchsorted(places, where[1] * self.size + where[0])

    def fill(
        self, at_start: np.ndarray, at_end: np.ndarray, across: np.ndarray, back: np.ndarray | None = None
    ) -> np.ndarray:
        """Return the (nnz, ...) data of the matrix.

        at_start, at_end: (b, ...) what each element adds on the diagonal at its nodes; across: (b, ...)
        what it adds in its start's row and its end's column; back: the other way round, `across` by default.
        """
        diagonal = self._per_node(at_start, at_end)[self.nodes]
        between = across[self.between]
        values = np.concatenate((diagonal, between, between if back is None else back[self.between]))
        if self._source is not None:
            return values[self._source]
        data = np.zeros((len(self.indices), *values.shape[1:]))
        np.add.at(data, self._place, values)
        return data

    def matrix(self, data: np.ndarray) -> "csc_array":
        """Return the matrix with (nnz,) data."""
        from scipy.sparse import csc_array

        return csc_array((data, self.indices, self.indptr), shape=(self.size, self.size))

    def _per_node(self, at_start: np.ndarray, at_end: np.ndarray) -> np.ndarray:
        n = int(max(self.start.max(), self.end.max(), self.nodes[-1])) + 1
        flat = at_start.reshape(len(at_start), -1), at_end.reshape(len(at_end), -1)
        sums = [
            np.bincount(self.start, flat[0][:, i], minlength=n)
            + np.bincount(self.end, flat[1][:, i], minlength=n)
            for i in range(flat[0].shape[1])
        ]
        return np.stack(sums, axis=1).reshape(n, *at_start.shape[1:])


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
        self.indices, self.indptr = self._expanded()
        columns = np.repeat(np.arange(self.size), np.diff(self.indptr))
        self.diagonal = np.flatnonzero(self.indices == columns)
        self._held = None if mechanics.mask is None else mechanics.mask.T.reshape(-1) == 0.0
        if self._held is not None:
            self._cut = np.flatnonzero(self._held[self.indices] | self._held[columns])

    def fill(self, V: np.ndarray, w: np.ndarray, q: np.ndarray, extra: np.ndarray, held: float) -> np.ndarray:
        """Return the data of K + extra: w V V^T + q I for each element; see mechanics.tangent.

        V: (d, b), w and q: (b,), extra: (rows, d, d) diagonal blocks.
        """
        blocks = np.einsum("b,ib,jb->bij", w, V, V)
        blocks += q[:, None, None] * np.eye(self.d)
        data = self.graph.fill(blocks, blocks, -blocks)
        data[self.graph.diagonal] += extra
        data = data.reshape(-1)[self._order]
        if self._held is not None:
            data[self._cut] = 0.0
            data[self.diagonal[self._held]] = held
        return data

    def _expanded(self) -> tuple[np.ndarray, np.ndarray]:
        """Return indices and indptr of the scalar matrix and remember the order of block entries."""
        from scipy.sparse import bsr_array

        graph, d = self.graph, self.d
        count = len(graph.indices)
        numbers = np.arange(count * d * d, dtype=float).reshape(count, d, d)
        shape = (self.size, self.size)
        scalar = bsr_array((numbers, graph.indices, graph.indptr), shape=shape).tocsr()
        self._order = scalar.data.astype(np.intp)
        return scalar.indices, scalar.indptr
