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


class Batch(SimpleNamespace):
    """Columns by name, each with the row first."""

    def take(self, which: np.ndarray) -> "Batch":
        """Return some rows, copied; which: (N,) bool, or their numbers."""
        chosen = np.flatnonzero(which) if which.dtype == bool else which
        return Batch(**{name: column.take(chosen, axis=0) for name, column in vars(self).items()})


class Topology:
    """What all rows share: who is joined to whom, what is free, which elements are cables.

    columns: (b, c) rho^T rho of every element between the c pairs of nodes that elements join, and a pair
    that none does; places: where the f f entries of K stand among sums of d d blocks over these.
    """

    def __init__(self, structure: Structure):
        self.start, self.end = structure.start, structure.end
        n, d = structure.coordinates.shape
        self.least = elements.least_extensions(structure.tension_only)
        self.free, self.held = np.flatnonzero(structure.free.T), np.flatnonzero(~structure.free.T)
        self.rho = np.ascontiguousarray(dense(self.start, self.end, n).T)
        axis, node = np.divmod(self.free, n)
        moving, node = np.unique(node, return_inverse=True)
        pairs = self.rho[:, moving, None] * self.rho[:, None, moving]
        joins = np.triu(pairs.any(axis=0))
        c = int(joins.sum())
        self.columns = np.pad(pairs[:, joins], ((0, 0), (0, 1)))
        kinds = np.full(joins.shape, c)
        kinds[joins] = np.arange(c)
        kinds = np.minimum(kinds, kinds.T)[node[:, None], node]
        self.places = ((axis[:, None] * d + axis) * (c + 1) + kinds).reshape(-1)

    def begun(self, X: np.ndarray, k: np.ndarray, l0: np.ndarray, loads: np.ndarray) -> Batch:
        """Return starts, each about its centroid, and what stays the same while rows move.

        X, loads: (N, n, d); k, l0: (N, b). S: (N, f) stiffness of all elements at a node; load: the largest.
        Units are the user's: nothing here is compared with a number that has one.
        """
        centre = np.add.reduce(X, 1) * (1.0 / X.shape[1])
        F = flat(loads.swapaxes(1, 2)).take(self.free, axis=1)
        S = (k[:, None] @ np.abs(self.rho))[:, 0].take(self.free % X.shape[1], axis=1)
        X = np.ascontiguousarray((X - centre[:, None]).swapaxes(1, 2))
        at_start = (k * elements.lengths((X @ self.rho.T).swapaxes(0, 1))).max(1)
        return Batch(X=X, k=k, l0=l0, F=F, S=S, load=np.abs(F).max(1), centre=centre, at_start=at_start)

    def at(self, r: Batch, step: np.ndarray) -> Batch:
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
        return Batch(X=X, V=V, l=l, e=e, t=t, q=q, g=g, norm=norms(g), taut=taut, rounding=rounding)

    def stiffness(self, r: Batch, s: Batch, q: np.ndarray, taut: np.ndarray, mu: np.ndarray) -> np.ndarray:
        """Return K, (N, f, f), eq. (11), and mu S; q, taut: (N, b) in place of the states' own."""
        l2 = s.l * s.l
        w = r.k * r.l0 / (l2 * s.l) * taut + (s.q - q) / l2
        B = tangent.blocks(np.ascontiguousarray(s.V.swapaxes(0, 1)), w, q)
        entries, f = flat(B.swapaxes(0, 1) @ self.columns).take(self.places, axis=1), len(self.free)
        entries[:, :: f + 1] += mu[:, None] * r.S
        return entries.reshape(len(w), f, f)


def flat(A: np.ndarray) -> np.ndarray:
    """Return (N, ...) arrays with a row of entries for each, a view where there is one."""
    return A.reshape(len(A), prod(A.shape[1:]))


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return (N,) inner products of (N, f) vectors."""
    return np.add.reduce(a * b, 1)


def norms(a: np.ndarray) -> np.ndarray:
    """Return (N,) Euclidean norms of (N, f) vectors."""
    return np.sqrt(dot(a, a))


def solved(M: np.ndarray, g: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return M^-1 g, (N, f), and (N,) bool: which M, (N, f, f), that factors replace, are not positive."""
    found = [dposv(a, b, overwrite_a=1) for a, b in zip(M.swapaxes(1, 2), g, strict=True)]
    z = np.array([z for _, z, _ in found]).reshape(g.shape)
    return z, np.array([info != 0 for *_, info in found], dtype=bool)


def rigid_motions(X: np.ndarray) -> np.ndarray:
    """Return unit translations, and rotations over the size, (N, r, d n), of (N, d, n) positions."""
    N, d, n = X.shape
    turns = generators(d)[:, d:, 1:].swapaxes(0, 1).reshape(-1, d)
    turned = turns @ (X / np.abs(X).max((1, 2), keepdims=True))
    shifts = np.broadcast_to(np.repeat(np.eye(d), n, axis=1), (N, d, d * n))
    return np.concatenate((shifts, turned.reshape(N, d * (d - 1) // 2, d * n)), axis=1)
