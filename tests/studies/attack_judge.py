"""What is true of a shape, from the scene's own mapping: shares nothing with the package."""

from typing import Any

import numpy as np

EPS = 2.0**-52
CLEAR, NONE = 1e-6, 1e-12
"""Relative sizes above and below which a number is clearly something, or clearly nothing."""


class Body:
    """The elements, loads and supports of a scene mapping as plain lists."""

    def __init__(self, scene: dict[str, Any]):
        rows = {name: row for row, name in enumerate(scene["nodes"])}
        self.X = np.array(list(scene["nodes"].values()))
        self.n, self.d = self.X.shape
        self.free = np.ones(self.X.shape, bool)
        for name, axes in scene.get("supports", {}).items():
            self.free[rows[name], ["xyz".index(axis) for axis in axes]] = False
        self.loads = np.zeros(self.X.shape, np.longdouble)
        for name, load in scene.get("loads", {}).items():
            self.loads[rows[name]] = load
        paper = scene["law"] == "paper"
        self.elements = [
            (rows[a], rows[b], EA if paper else EA / rest, rest, kind == "cable")
            for kind, EA, rest, pairs in (group.values() for group in scene["elements"].values())
            for a, b in pairs
        ]
        self.dofs = np.flatnonzero(self.free)

    def pulls(self, X: np.ndarray) -> list[tuple[float, float, np.ndarray]]:
        """Return length, force and pull on the first node of each element."""
        return [(*_force(X[j] - X[i], k, l0, cable),) for i, j, k, l0, cable in self.elements]

    def forces(self, X: np.ndarray) -> np.ndarray:
        """Return (n, d) loads and pulls in extended precision."""
        total = self.loads.copy()
        for (i, j, *_), (_, _, pull) in zip(self.elements, self.pulls(X.astype(np.longdouble)), strict=True):
            total[i] += pull
            total[j] -= pull
        return total

    def energy(self, X: np.ndarray) -> tuple[float, float]:
        """Return the energy and the sum of the sizes of its terms."""
        parts = [
            t * t / (2.0 * k) for (_, _, k, *_), (_, t, _) in zip(self.elements, self.pulls(X), strict=True)
        ]
        work = self.loads * X
        return float(sum(parts) - work.sum()), float(sum(parts) + np.abs(work).sum())

    def tangent(self, X: np.ndarray) -> np.ndarray:
        """Return second derivatives of the energy over the free directions, by complex steps per element."""
        K = np.zeros((self.n * self.d,) * 2)
        for i, j, k, l0, cable in self.elements:
            V, at = X[j] - X[i], (np.arange(self.d) + self.d * i, np.arange(self.d) + self.d * j)
            tiny = 1e-30 * (np.abs(V).max() or 1.0)
            columns = [_force(V + 1j * tiny * axis, k, l0, cable)[2].imag / tiny for axis in np.eye(self.d)]
            for row, this in enumerate(at):
                for column, that in enumerate(at):
                    K[np.ix_(this, that)] += (1.0 if row == column else -1.0) * np.array(columns).T
        return K[np.ix_(self.dofs, self.dofs)]

    def reference(self, X: np.ndarray) -> float:
        """Return the largest force or load; where all are rounding, the largest k l."""
        found = self.pulls(X)
        largest = max(max(abs(t) for _, t, _ in found), float(np.abs(self.loads).max()))
        vanished = largest <= 64.0 * self.floor(X) and not self.loads.any()
        return (
            max(e[2] * l for e, (l, _, _) in zip(self.elements, found, strict=True)) if vanished else largest
        )

    def floor(self, X: np.ndarray) -> float:
        """Return what coordinates rounded to double do to the forces."""
        sums = np.zeros(self.n)
        for (i, j, k, l0, _), (length, _, _) in zip(self.elements, self.pulls(X), strict=True):
            sums[[i, j]] += k * (np.abs(X[[i, j]]).max() + length + l0)
        return 4.0 * EPS * float(sums.max())

    def residual(self, X: np.ndarray) -> float:
        """Return the largest force out of balance over the free directions."""
        return float(np.abs(self.forces(X)[self.free]).max(initial=0.0))

    def doubtful(self, X: np.ndarray) -> bool:
        """Return whether an element has lost its length, or a cable is between taut and slack."""
        size = float(np.ptp(X, axis=0).max()) or 1.0
        return any(
            (l0 > 0.0 and l < 1e-5 * max(l0, size))
            or (cable and l0 > 0.0 and abs(l - l0) < 1e-7 * max(l, size))
            for (_, _, _, l0, cable), (l, _, _) in zip(self.elements, self.pulls(X), strict=True)
        )

    def has_points(self, X: np.ndarray) -> bool:
        """Return whether an element has no length to speak of, and so no direction."""
        size = float(np.ptp(X, axis=0).max()) or 1.0
        return any(length < 1e-5 * size for length, *_ in self.pulls(X))

    def refined(self, X: np.ndarray) -> np.ndarray:
        """Return the best of a few Newton steps from a shape, in double coordinates."""
        for _ in range(8):
            if not len(self.dofs) or self.residual(X) <= self.floor(X):
                break
            there = X.copy()
            step = np.linalg.pinv(self.tangent(X), 1e-11, hermitian=True) @ self.forces(X)[self.free].astype(
                float
            )
            there[self.free] += step
            if not self.residual(there) < self.residual(X):
                break
            X = there
        return X

    def rigid(self, X: np.ndarray) -> np.ndarray | None:
        """Return (m, r) an orthonormal basis of the rigid motions the supports allow; None where unclear."""
        Y = X - X.mean(axis=0)
        Y = Y / (np.abs(Y).max() or 1.0)
        motions = [np.tile(axis, (self.n, 1)) for axis in np.eye(self.d)]
        for i in range(self.d):
            for j in range(i):
                turn = np.zeros_like(Y)
                turn[:, i], turn[:, j] = Y[:, j], -Y[:, i]
                motions.append(turn)
        R = np.array(motions)
        allowed = _null(R[:, ~self.free].T)
        return None if allowed is None else _range(R[:, self.free].T @ allowed)

    def softest(self, X: np.ndarray) -> float | None:
        """Return least over largest stiffness apart from motions that nothing resists; None where unclear.

        Without any other motion it is 1.
        """
        K, rigid = self.tangent(X), self.rigid(X)
        if rigid is None or not len(K):
            return None if rigid is None else 1.0
        scale = float(np.abs(K).max()) or 1.0
        inert = _null(K @ rigid / scale) if rigid.shape[1] else np.zeros((0, 0))
        if inert is None:
            return None
        left = _null((rigid @ inert).T)
        if left is None or not left.shape[1]:
            return None if left is None else 1.0
        values = np.linalg.eigvalsh(left.T @ K @ left)
        return float(values[0]) / scale

    def counts(self, X: np.ndarray) -> dict[str, int]:
        """Return the counts of the analysis whose ranks leave no doubt."""
        found: dict[str, int] = {}
        columns, taut = np.zeros((self.n * self.d, len(self.elements))), []
        for e, ((i, j, _, l0, cable), (length, _, _)) in enumerate(
            zip(self.elements, self.pulls(X), strict=True)
        ):
            for row, sign in ((i, 1.0), (j, -1.0)):
                columns[row * self.d : (row + 1) * self.d, e] = sign * (X[j] - X[i]) / length
            taut.append(not cable or length >= l0)
        rank, rigid = _rank(columns[self.dofs][:, taut]), self.rigid(X)
        if (whole := _rank(columns)) is not None:
            found["nullity_U"] = len(taut) - whole
        if rank is not None:
            found["self_stress_states"] = sum(taut) - rank
            if rigid is not None:
                found["mechanisms"] = len(self.dofs) - rank - rigid.shape[1]
        if rigid is not None:
            found["rigid_motions"] = rigid.shape[1]
        return found


def _force(V, k, l0, cable):
    length = np.sqrt((V * V).sum())
    stretch = length - l0
    if (cable and stretch.real < 0.0) or length == 0.0:
        return length, stretch.real * 0.0, V * 0.0
    return length, k * stretch, k * stretch * V / length


def _split(matrix):
    """Return the right vectors and the rank of a matrix; no rank where its singular values leave doubt."""
    _, values, rows = np.linalg.svd(np.concatenate((matrix, np.zeros((matrix.shape[1],) * 2))))
    nothing = values < NONE
    return rows, (None if (~nothing & (values < CLEAR)).any() else int((~nothing).sum()))


def _rank(matrix):
    return 0 if not matrix.size else _split(matrix)[1]


def _null(matrix):
    rows, rank = _split(matrix)
    return None if rank is None else rows[rank:].T


def _range(matrix):
    rank = _rank(matrix)
    return None if rank is None else np.linalg.svd(matrix, full_matrices=False)[0][:, :rank]
