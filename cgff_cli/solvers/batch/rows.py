"""Rows: structures of one topology and different numbers, side by side. What a State is to one of them.

Arrays hold the row first: (N, d, m) at the m nodes that move, (N, d, b) and (N, b) at elements, (N, f) in
free directions. Matrices are multiplied and factored row by row, all else is elementwise or a sum over a
row's own entries, so that no bit of a row depends on what stands beside it.
"""

from types import SimpleNamespace

import numpy as np
from scipy.linalg.lapack import dgesv, dposv

from cgff_cli.mechanics import elements, tangent
from cgff_cli.mechanics.connectivity import DenseConnectivity, dense
from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.equilibrium import internal_forces
from cgff_cli.mechanics.rigid import FLAT
from cgff_cli.structure import Structure


class Rows(SimpleNamespace):
    """Columns by name, each with the row first."""

    def take(self, which: np.ndarray, *names: str) -> "Rows":
        """Return some rows, copied; of all columns, or of those named."""
        return Rows(**{name: vars(self)[name][which] for name in names or vars(self)})

    def fill(self, places: np.ndarray, other: "Rows") -> None:
        """Replace rows in the columns that `other` has."""
        for name, column in vars(other).items():
            getattr(self, name)[places] = column

    def put(self, which: np.ndarray, other: "Rows") -> None:
        """Take over some rows of the columns that `other` has; which: (N,) bool."""
        places = np.flatnonzero(which)
        self.fill(places, other.take(places))


def joined(parts: list[Rows]) -> Rows:
    """Return rows with the same columns, one after another."""
    return Rows(**{name: np.concatenate([vars(part)[name] for part in parts]) for name in vars(parts[0])})


class Topology:
    """What all rows share: who is joined to whom, what is held, which elements are cables."""

    def __init__(self, structure: Structure):
        s = self.structure = structure
        n, self.d = s.coordinates.shape
        moves = np.asarray(s.free.any(axis=1))
        self.all_free, self.has_held = bool(s.free.all()), not bool(moves.all())
        self.moving, self.still = np.flatnonzero(moves), np.flatnonzero(~moves)
        self.rho_t = dense(s.start, s.end, n)
        self.connectivity = DenseConnectivity(
            s.start, s.end, s.coordinates.T, moves if self.has_held else None
        )
        self.least = elements.least_extensions(s.tension_only)
        self.free, self.fixed = np.flatnonzero(s.free.T), np.flatnonzero(~s.free.T)
        m = len(self.moving)
        self.dofs = np.flatnonzero(s.free[moves].T)
        axis, node = np.divmod(self.dofs, m)
        self.node = node
        block = axis[:, None] * self.d + axis
        pairs = self.connectivity.pairs.reshape(-1, m * m)
        self.pairs, which = np.unique(pairs, axis=1, return_inverse=True)
        which = which.reshape(-1)[node[:, None] * m + node]
        self.places = (block * self.pairs.shape[1] + which).reshape(-1)
        self.work = np.empty((0, 1, 1)), np.empty((0, 1))

    def framed(self, X: np.ndarray, k: np.ndarray, l0: np.ndarray, loads: np.ndarray) -> Rows:
        """Return what stays the same while rows move, each in its own frame, as `mechanics.frame` has it.

        X and loads: (N, n, d); k and l0: (N, b). all: (N, d, n) every node at the start.
        """
        centre = np.add.reduce(X, 1) * (1.0 / X.shape[1])
        X = X - centre[:, None]
        length = _power_of_two(np.maximum(np.abs(X).max((1, 2)), l0.max(1)))
        stiffness = _power_of_two(k.max(1))
        X = np.ascontiguousarray((X / length[:, None, None]).swapaxes(1, 2))
        k, l0 = k / stiffness[:, None], l0 / length[:, None]
        loads = np.ascontiguousarray((loads / (stiffness * length)[:, None, None]).swapaxes(1, 2))
        F = loads.take(self.moving, axis=2).reshape(len(X), -1).take(self.dofs, axis=1)
        nodal = (k[:, None] @ np.abs(self.rho_t.T)).take(self.moving, axis=2)[:, 0]
        is_pinned = self._is_pinned(X)
        is_afloat = ~loads.any((1, 2)) & ~is_pinned
        V = X @ self.rho_t
        return Rows(
            centre=centre,
            length=length,
            stiffness=stiffness,
            all=X,
            start=X.take(self.moving, axis=2),
            held=X.take(self.still, axis=2) @ self.rho_t[self.still],
            k=k,
            l0=l0,
            kl0=k * l0,
            F=F,
            load=np.abs(F).max(1, initial=0.0),
            S=np.where(nodal > 0.0, nodal, nodal.mean(1)[:, None]).take(self.node, axis=1),
            stiffest=nodal.max(1),
            loose=np.where(is_afloat, np.add.reduce(k, 1) / k.shape[1], 0.0),
            is_covered=is_afloat if self.all_free else is_pinned,
            at_start=(k * elements.lengths(V.swapaxes(0, 1))).max(1),
        )

    def at(self, rows: Rows, X: np.ndarray) -> Rows:
        """Return the columns of a State at (N, d, m) positions; g is (N, f), in free directions."""
        V = self.connectivity.differences(X)
        if self.has_held:
            V += rows.held
        l = elements.lengths(V.swapaxes(0, 1))
        e = elements.extensions(l - rows.l0, self.least)
        t = elements.forces(rows.k, e)
        q = elements.force_densities(t, l)
        pull = internal_forces(self.connectivity, V, q[:, None]).reshape(len(X), -1)
        g = pull.take(self.dofs, axis=1) - rows.F
        return Rows(X=X, V=V, l=l, e=e, t=t, q=q, g=g, norm=np.sqrt(dot(g, g)))

    def moved(self, X: np.ndarray, step: np.ndarray) -> np.ndarray:
        """Return (N, d, m) positions after a step (N, f) in free directions."""
        there = X.copy()
        there.reshape(len(X), -1)[:, self.dofs] += step
        return there

    def everywhere(self, rows: Rows, X: np.ndarray) -> np.ndarray:
        """Return (N, d, n) positions of all nodes."""
        if not self.has_held:
            return X
        full = rows.all.copy()
        full[:, :, self.moving] = X
        return full

    def stiffness(self, s: Rows, q: np.ndarray, taut: np.ndarray) -> np.ndarray:
        """Return K, (N, f, f), eq. (11), good until the next call.

        s: states; q: (N, b) force densities in place of their own; taut: (N, b) bool.
        """
        l2 = s.l * s.l
        w = s.kl0 / (l2 * s.l) * taut + (s.q - q) / l2
        B = tangent.blocks(np.ascontiguousarray(s.V.swapaxes(0, 1)), w, q)
        sums, K = self._work(len(w))
        np.matmul(B.reshape(-1, *w.shape).swapaxes(0, 1), self.pairs, out=sums)
        sums.reshape(len(w), -1).take(self.places, axis=1, out=K, mode="clip")
        return K.reshape(len(w), len(self.dofs), -1)

    def _work(self, N: int) -> tuple[np.ndarray, ...]:
        """Return arrays for sums and entries of N matrices: fresh memory costs more than filling it."""
        if len(self.work[0]) < N:
            self.work = np.empty((N, self.d * self.d, self.pairs.shape[1])), np.empty((N, len(self.places)))
        return tuple(array[:N] for array in self.work)

    def taut(self, s: Rows) -> np.ndarray:
        """Return (N, b) bool, not slack."""
        return elements.taut(s.l - s.l0, self.least)

    def loose_motions(self, rows: Rows) -> np.ndarray:
        """Return (N, f, f) stiffnesses R R^T of rigid motions R that supports allow, 0 where loads act."""
        R = _all_motions(self.everywhere(rows, rows.X))
        if not self.all_free:
            _, values, combined = np.linalg.svd(self._held(R), full_matrices=False)
            R = R.take(self.free, axis=1) @ (combined * (values <= FLAT)[:, :, None]).swapaxes(1, 2)
            R, values, _ = np.linalg.svd(R, full_matrices=False)
            R *= (values > FLAT)[:, None]
        return (rows.loose[:, None, None] * R) @ R.swapaxes(1, 2)

    def _held(self, R: np.ndarray) -> np.ndarray:
        """Return motions at what is held, with as many rows more as there are motions."""
        return np.concatenate(
            (R.take(self.fixed, axis=1), np.zeros((len(R), R.shape[2], R.shape[2]))), axis=1
        )

    def _is_pinned(self, X: np.ndarray) -> np.ndarray:
        """Return (N,) bool, whether supports allow no rigid motion of (N, d, n) positions."""
        if self.all_free:
            return np.zeros(len(X), dtype=bool)
        values = np.linalg.svd(self._held(_all_motions(X)), compute_uv=False)
        return np.asarray((values > FLAT).all(1))

    def rounding(self, s: Rows) -> np.ndarray:
        """Return (N, b) how far rounding blurs each extension."""
        reach = np.abs(self.everywhere(s, s.X)).max(1)
        far = np.maximum(reach.take(self.structure.start, axis=1), reach.take(self.structure.end, axis=1))
        return EPS * (far + s.l + np.abs(s.e))


def dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return (N,) inner products of (N, f) vectors."""
    return np.add.reduce(a * b, 1)


def solved(M: np.ndarray, g: np.ndarray, which: np.ndarray, trusted: np.ndarray) -> tuple[np.ndarray, ...]:
    """Return M^-1 g, (N, f), of some rows, else 0; and (N,) bool: which M have no Cholesky factor.

    M: (N, f, f); which, trusted: (N,) bool; where trusted, M may be indefinite.
    """
    z, failed = np.zeros_like(g), np.zeros(len(g), dtype=bool)
    A, b = list(M.swapaxes(1, 2)), list(g)
    for row in np.flatnonzero(which).tolist():
        _, z[row], info = dposv(A[row], b[row])
        if info and trusted[row]:
            _, _, z[row], info = dgesv(A[row], b[row])
        failed[row] = info
    return z, failed


def shifted(K: np.ndarray, shift: np.ndarray) -> np.ndarray:
    """Return K, (N, f, f), with a shift, (N, f), added to the diagonals in place."""
    K.reshape(len(K), -1)[:, :: K.shape[2] + 1] += shift
    return K


def _power_of_two(values: np.ndarray) -> np.ndarray:
    """Return the powers of two in (value / 2, value], or 1 for zero."""
    return np.where(values > 0.0, np.ldexp(1.0, np.frexp(values)[1] - 1), 1.0)


def _all_motions(X: np.ndarray) -> np.ndarray:
    """Return `mechanics.rigid.all_motions` of (N, d, n) positions, (N, d n, r)."""
    N, d, n = X.shape
    X = X - (np.add.reduce(X, 2) * (1.0 / n))[:, :, None]
    size = np.sqrt(np.add.reduce((X * X).reshape(N, -1), 1))
    X /= np.where(size > 0.0, size, 1.0)[:, None, None]
    planes = [(i, j) for i in range(d) for j in range(i + 1, d)]
    R = np.zeros((N, d, n, d + len(planes)))
    for i in range(d):
        R[:, i, :, i] = (1.0 / n) ** 0.5
    for r, (i, j) in enumerate(planes, d):
        R[:, i, :, r], R[:, j, :, r] = X[:, j], -X[:, i]
    return R.reshape(N, d * n, -1)
