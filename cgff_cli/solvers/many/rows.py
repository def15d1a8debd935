"""Structures of one topology side by side: what a State is to one of them.

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
from cgff_cli.mechanics.rigid import turns
from cgff_cli.structure import Structure


class Rows(SimpleNamespace):
    """Columns by name, each with the row first."""

    def take(self, which: np.ndarray) -> "Rows":
        """Return some rows, copied; which: (N,) bool, or their numbers."""
        chosen = np.flatnonzero(which) if which.dtype == bool else which
        return Rows(**{name: column.take(chosen, axis=0) for name, column in vars(self).items()})


def joined(parts: list[Rows]) -> Rows:
    """Return rows with the same columns, one after another."""
    return Rows(**{name: np.concatenate([vars(part)[name] for part in parts]) for name in vars(parts[0])})


class Topology:
    """What all rows share: who is joined to whom, what is free, which elements are cables.

    A pair of nodes has the same elements, and so the same sums of blocks in K, as many others: none. columns:
    (b, c) the c different sums, places: where each of the (f, f) entries of K stands among the (d d, c).
    """

    def __init__(self, structure: Structure):
        s = self.structure = structure
        n, self.d = s.coordinates.shape
        self.least = elements.least_extensions(s.tension_only)
        self.free, self.fixed = np.flatnonzero(s.free.T), np.flatnonzero(~s.free.T)
        self.rho = np.ascontiguousarray(dense(s.start, s.end, n).T)
        self.ends = np.abs(self.rho)
        axis, node = np.divmod(self.free, n)
        moving, node = np.unique(node, return_inverse=True)
        rho, m = self.rho[:, moving], len(moving)
        pairs = (rho[:, :, None] * rho[:, None, :]).reshape(-1, m * m)
        self.columns, which = np.unique(pairs, axis=1, return_inverse=True)
        which = which.reshape(-1)[node[:, None] * m + node]
        self.places = ((axis[:, None] * self.d + axis) * self.columns.shape[1] + which).reshape(-1)

    def framed(self, X: np.ndarray, k: np.ndarray, l0: np.ndarray, loads: np.ndarray) -> Rows:
        """Return what stays the same while rows move, and X, each in its own frame, as `mechanics.frame`.

        X and loads: (N, n, d); k and l0: (N, b). S: stiffness of the node, in which shifts are measured.
        """
        centre = np.add.reduce(X, 1) * (1.0 / X.shape[1])
        X = (X - centre[:, None]).swapaxes(1, 2)
        length = _power_of_two(np.maximum(np.abs(X).max((1, 2)), l0.max(1)))
        stiffness = _power_of_two(k.max(1))
        X = np.ascontiguousarray(X / length[:, None, None])
        k, l0 = k / stiffness[:, None], l0 / length[:, None]
        F = flat((loads / (stiffness * length)[:, None, None]).swapaxes(1, 2))
        F, nodal = F.take(self.free, axis=1), (k[:, None] @ self.ends)[:, 0]
        S = np.where(nodal > 0.0, nodal, nodal.mean(1)[:, None]).take(self.free % X.shape[2], axis=1)
        at_start = (k * elements.lengths((X @ self.rho.T).swapaxes(0, 1))).max(1)
        load = np.abs(F).max(1)
        frame = {"centre": centre, "length": length, "stiffness": stiffness}
        return Rows(X=X, k=k, l0=l0, kl0=k * l0, F=F, S=S, load=load, at_start=at_start, **frame)

    def at(self, rows: Rows, X: np.ndarray) -> Rows:
        """Return the columns of a State at (N, d, n) positions; g is (N, f)."""
        s = self.structure
        V = X.take(s.start, axis=2) - X.take(s.end, axis=2)
        l = elements.lengths(V.swapaxes(0, 1))
        e = elements.extensions(l - rows.l0, self.least)
        t = elements.forces(rows.k, e)
        q = elements.force_densities(t, l)
        pull = (V * q[:, None]) @ self.rho
        g = flat(pull).take(self.free, axis=1) - rows.F
        return Rows(X=X, V=V, l=l, e=e, t=t, q=q, g=g, norm=np.sqrt(dot(g, g)))

    def moved(self, X: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return (N, d, n) positions after a step (N, f) in free directions."""
        there = X.copy()
        flat(there)[:, self.free] += step
        return there

    def stiffness(self, rows: Rows, s: Rows, q: np.ndarray, taut: np.ndarray) -> np.ndarray:
        """Return K, (N, f, f), eq. (11).

        s: states of the rows; q: (N, b) force densities in place of their own; taut: (N, b) bool.
        """
        l2 = s.l * s.l
        w = rows.kl0 / (l2 * s.l) * taut + (s.q - q) / l2
        B = tangent.blocks(np.ascontiguousarray(s.V.swapaxes(0, 1)), w, q)
        sums = B.swapaxes(0, 1) @ self.columns
        K = flat(sums).take(self.places, axis=1)
        return K.reshape(len(w), len(self.free), len(self.free))

    def taut(self, rows: Rows, s: Rows) -> np.ndarray:
        """Return (N, b) bool, not slack."""
        return elements.taut(s.l - rows.l0, self.least)

    def rounding(self, s: Rows) -> np.ndarray:
        """Return (N, b) how far rounding blurs each extension."""
        reach, ends = np.abs(s.X).max(1), self.structure
        far = np.maximum(reach.take(ends.start, axis=1), reach.take(ends.end, axis=1))
        return EPS * (far + s.l + np.abs(s.e))


def flat(A: np.ndarray) -> np.ndarray:
    """Return (N, ...) arrays in a row each, a view where they are."""
    return A.reshape(len(A), prod(A.shape[1:]))


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return (N,) inner products of (N, f) vectors."""
    return np.add.reduce(a * b, 1)


def shifted(K: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Return K, (N, f, f), with a shift, (N, f), added to the diagonals in place."""
    flat(K)[:, :: K.shape[2] + 1] += shift
    return K


def solved(M: np.ndarray, g: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return M^-1 g, (N, f), and (N,) bool: which M, (N, f, f), that factors replace, are not positive."""
    found = [dposv(a, b, overwrite_a=1) for a, b in zip(M.swapaxes(1, 2), g, strict=True)]
    z = np.array([z for _, z, _ in found]).reshape(g.shape)
    return z, np.array([info != 0 for *_, info in found], dtype=bool)


def all_motions(X: np.ndarray) -> np.ndarray:
    """Return `mechanics.rigid.all_motions` of (N, d, n) positions, (N, r, d n)."""
    N, d, n = X.shape
    X = X - np.add.reduce(X, 2, keepdims=True) * (1.0 / n)
    size = np.sqrt(np.add.reduce(X * X, (1, 2)))
    X /= np.where(size > 0.0, size, 1.0)[:, None, None]
    shifts = np.repeat(np.eye(d) * (1.0 / n) ** 0.5, n, axis=1)
    return np.concatenate((np.broadcast_to(shifts, (N, d, d * n)), (turns(d) @ X).reshape(N, d * (d - 1) // 2, d * n)), axis=1)


def _power_of_two(values: np.ndarray) -> np.ndarray:
    """Return the powers of two in (value / 2, value]."""
    return np.ldexp(1.0, np.frexp(values)[1] - 1)
