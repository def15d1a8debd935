"""Structures of one topology side by side: what Mechanics and State are to one of them.

Arrays hold the row first: (N, d, n) at nodes, (N, d, b) and (N, b) at elements, (N, f) in free directions.
Matrices are multiplied and factored row by row, all else is elementwise or a sum over a row's own entries,
so that no bit of a row depends on what stands beside it.
"""

from math import prod
from types import SimpleNamespace

import numpy as np
from scipy.linalg.lapack import dposv

from cgff_cli.mechanics import elements, tangent
from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.rigid import generators
from cgff_cli.structure import Structure


class BatchRows(SimpleNamespace):
    """Columns by name, each with the row first."""

    def take(self, which: np.ndarray) -> "BatchRows":
        """Return some rows, copied; which: (N,) bool, or their numbers."""
        chosen = np.flatnonzero(which) if which.dtype == bool else which
        return BatchRows(**{name: column.take(chosen, axis=0) for name, column in vars(self).items()})


def joined(parts: list[BatchRows]) -> BatchRows:
    """Return rows with the same columns, one after another."""
    return BatchRows(
        **{name: np.concatenate([vars(part)[name] for part in parts]) for name in vars(parts[0])}
    )


class Topology:
    """What all rows share: who is joined to whom, what is free, which elements are cables.

    Most pairs of nodes have the same elements between them, none. columns: (b, c) elements of the c kinds of
    pairs; places: where the f f entries of K stand among sums over these of d d entries of blocks.
    """

    def __init__(self, structure: Structure):
        self.start, self.end = structure.start, structure.end
        n, d = structure.coordinates.shape
        self.least = elements.least_extensions(structure.tension_only)
        self.free, self.held = np.flatnonzero(structure.free.T), np.flatnonzero(~structure.free.T)
        self.rho = np.ascontiguousarray(dense(self.start, self.end, n).T)
        axis, node = np.divmod(self.free, n)
        moving, node = np.unique(node, return_inverse=True)
        rho, m = self.rho[:, moving], len(moving)
        pairs = (rho[:, :, None] * rho[:, None, :]).reshape(-1, m * m)
        self.columns, kinds = np.unique(pairs, axis=1, return_inverse=True)
        kinds = kinds.reshape(-1)[node[:, None] * m + node]
        self.places = ((axis[:, None] * d + axis) * self.columns.shape[1] + kinds).reshape(-1)

    def framed(self, X: np.ndarray, k: np.ndarray, l0: np.ndarray, loads: np.ndarray) -> BatchRows:
        """Return starts and what stays the same while rows move, each in a frame as in `mechanics.frame`.

        X, loads: (N, n, d); k, l0: (N, b). S: (N, f) stiffness of all elements at a node; load: the largest.
        """
        centre = np.add.reduce(X, 1) * (1.0 / X.shape[1])
        X = (X - centre[:, None]).swapaxes(1, 2)
        length = np.ldexp(1.0, np.frexp(np.maximum(np.abs(X).max((1, 2)), l0.max(1)))[1])
        stiffness = np.ldexp(1.0, np.frexp(k.max(1))[1])
        X, l0 = np.ascontiguousarray(X / length[:, None, None]), l0 / length[:, None]
        k = k / stiffness[:, None]
        F = flat((loads / (stiffness * length)[:, None, None]).swapaxes(1, 2)).take(self.free, axis=1)
        S = (k[:, None] @ np.abs(self.rho))[:, 0].take(self.free % X.shape[2], axis=1)
        frame = {"centre": centre, "length": length, "stiffness": stiffness}
        return BatchRows(X=X, k=k, l0=l0, F=F, S=S, load=np.abs(F).max(1), **frame)

    def at(self, r: BatchRows, step: np.ndarray) -> BatchRows:
        """Return the columns of a State at the ends of steps, (N, f); g is (N, f)."""
        X = r.X.copy()
        flat(X)[:, self.free] += step
        V = X.take(self.start, axis=2) - X.take(self.end, axis=2)
        l = elements.lengths(V.swapaxes(0, 1))
        stretch = l - r.l0
        e = elements.extensions(stretch, self.least)
        t = elements.forces(r.k, e)
        q = elements.force_densities(t, l)
        g = flat((V * q[:, None]) @ self.rho).take(self.free, axis=1) - r.F
        reach = np.abs(X).max(1)
        far = np.maximum(reach.take(self.start, axis=1), reach.take(self.end, axis=1))
        taut, rounding = elements.taut(stretch, self.least), EPS * (far + l + np.abs(e))
        return BatchRows(X=X, V=V, l=l, e=e, t=t, q=q, g=g, norm=norms(g), taut=taut, rounding=rounding)

    def stiffness(self, r: BatchRows, s: BatchRows, q: np.ndarray, taut: np.ndarray) -> np.ndarray:
        """Return K, (N, f, f), eq. (11), of states; q, taut: (N, b) in place of their own."""
        l2 = s.l * s.l
        w = r.k * r.l0 / (l2 * s.l) * taut + (s.q - q) / l2
        B = tangent.blocks(np.ascontiguousarray(s.V.swapaxes(0, 1)), w, q)
        entries = flat(B.swapaxes(0, 1) @ self.columns).take(self.places, axis=1)
        return entries.reshape(len(w), len(self.free), len(self.free))


def flat(A: np.ndarray) -> np.ndarray:
    """Return (N, ...) arrays with a row of entries for each, a view where there is one."""
    return A.reshape(len(A), prod(A.shape[1:]))


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return (N,) inner products of (N, f) vectors."""
    return np.add.reduce(a * b, 1)


def norms(a: np.ndarray) -> np.ndarray:
    """Return (N,) Euclidean norms of (N, f) vectors."""
    return np.sqrt(dot(a, a))


def shifted(K: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Return K, (N, f, f), with a shift, (N, f), added to the diagonals in place."""
    flat(K)[:, :: K.shape[2] + 1] += shift
    return K


def solved(M: np.ndarray, g: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return M^-1 g, (N, f), and (N,) bool: which M, (N, f, f), that factors replace, are not positive."""
    found = [dposv(a, b, overwrite_a=1) for a, b in zip(M.swapaxes(1, 2), g, strict=True)]
    z = np.array([z for _, z, _ in found]).reshape(g.shape)
    return z, np.array([info != 0 for *_, info in found], dtype=bool)


def rigid_motions(X: np.ndarray) -> np.ndarray:
    """Return unit translations and rotations, (N, r, d n), of (N, d, n) positions about their frame."""
    N, d, n = X.shape
    shifts = np.broadcast_to(np.repeat(np.eye(d), n, axis=1), (N, d, d * n))
    turns = generators(d)[:, d:, 1:].swapaxes(0, 1).reshape(-1, d)
    return np.concatenate((shifts, (turns @ X).reshape(N, d * (d - 1) // 2, d * n)), axis=1)
