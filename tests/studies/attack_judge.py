"""What is true of a shape, from the scene's own mapping: shares nothing with the package."""

from typing import Any

import numpy as np

EPS = 2.0**-52
CLEAR, NONE = 1e-6, 1e-12
"""Relative sizes above and below which a number is clearly something, or clearly nothing."""
KINK = 1e-7
"""A cable within this share of the size of its rest length may be taut or slack."""


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

    def tangent(self, X: np.ndarray, lean: float = 0.0) -> np.ndarray:
        """Return second derivatives of the energy over the free directions, by complex steps per element.

        lean: cables that may be taut or slack are as they are (0), all taut (1) or all slack (-1).
        """
        band = lean * KINK * self.size(X)
        K = np.zeros((self.n * self.d,) * 2)
        for i, j, k, l0, cable in self.elements:
            V, at = X[j] - X[i], (np.arange(self.d) + self.d * i, np.arange(self.d) + self.d * j)
            tiny = 1e-30 * (np.abs(V).max() or 1.0)
            steps = V + 1j * tiny * np.eye(self.d)
            columns = [_force(step, k, l0, cable, band)[2].imag / tiny for step in steps]
            for row, this in enumerate(at):
                for column, that in enumerate(at):
                    K[np.ix_(this, that)] += (1.0 if row == column else -1.0) * np.array(columns).T
        return K[np.ix_(self.dofs, self.dofs)]

    def reference(self, X: np.ndarray) -> float:
        """Return the largest force or load; where all are rounding, the largest k l of the start."""
        largest = max(max(abs(t) for _, t, _ in self.pulls(X)), float(np.abs(self.loads).max()))
        if largest > 256.0 * max(self.floor(X), self.floor(self.X)) or self.loads.any():
            return largest
        return max(e[2] * max(l, e[3]) for e, (l, *_) in zip(self.elements, self.pulls(self.X), strict=True))

    def floor(self, X: np.ndarray) -> float:
        """Return what coordinates rounded to double do to lengths, directions and so the forces."""
        sums = np.zeros(self.n)
        for (i, j, k, l0, _), (length, t, _) in zip(self.elements, self.pulls(X), strict=True):
            far = np.abs(X[[i, j]]).max()
            sums[[i, j]] += k * (far + length + l0) + (abs(t) * far / length if t else 0.0)
        return 4.0 * EPS * float(sums.max() + np.abs(self.loads).max())

    def size(self, X: np.ndarray) -> float:
        """Return the longest side of the box around a shape."""
        return float(np.ptp(X, axis=0).max()) or 1.0

    def residual(self, X: np.ndarray) -> float:
        """Return the largest force out of balance over the free directions."""
        return float(np.abs(self.forces(X)[self.free]).max(initial=0.0))

    def has_points(self, X: np.ndarray, idle: bool = True) -> bool:
        """Return whether an element (idle: one that needs no direction too) is too short to have one."""
        least = max(1e-5 * self.size(X), 1e7 * EPS * float(np.abs(X).max()))
        return any(
            length < least and (idle or (l0 > 0.0 and t != 0.0))
            for (*_, l0, _), (length, t, _) in zip(self.elements, self.pulls(X), strict=True)
        )

    def has_kinks(self, X: np.ndarray) -> bool:
        """Return whether a cable may be taut or slack."""
        return any(
            cable and l0 > 0.0 and abs(length - l0) < KINK * self.size(X)
            for (*_, l0, cable), (length, *_) in zip(self.elements, self.pulls(X), strict=True)
        )

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

    def softest(self, X: np.ndarray) -> tuple[float, float] | None:
        """Return least over largest stiffness with doubtful cables slack, and taut; None where unclear.

        Motions that nothing resists are left out; without any other motion it is 1. Loads may resist
        a rigid motion by less than rounding: unclear.
        """
        low, high = (self._least(self.tangent(X, lean), self.rigid(X)) for lean in (-1.0, 1.0))
        return None if low is None or high is None else (low, high)

    def _least(self, K: np.ndarray, rigid: np.ndarray | None) -> float | None:
        if rigid is None or not len(K):
            return None if rigid is None else 1.0
        scale = float(np.abs(K).max()) or 1.0
        inert = _null(K @ rigid / scale) if rigid.shape[1] else np.zeros((0, 0))
        undecided = inert is None or (inert.shape[1] and self.loads.any())
        left = None if undecided else _null((rigid @ inert).T)
        if left is None or not left.shape[1]:
            return None if left is None else 1.0
        return float(np.linalg.eigvalsh(left.T @ K @ left)[0]) / scale

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
        rank, rigid = None if self.has_kinks(X) else _rank(columns[self.dofs][:, taut]), self.rigid(X)
        if (whole := _rank(columns)) is not None:
            found["nullity_U"] = len(taut) - whole
        if rank is not None:
            found["self_stress_states"] = sum(taut) - rank
            if rigid is not None:
                found["mechanisms"] = len(self.dofs) - rank - rigid.shape[1]
        if rigid is not None:
            found["rigid_motions"] = rigid.shape[1]
        return found


def _force(V, k, l0, cable, band=0.0):
    length = np.sqrt((V * V).sum())
    stretch = length - l0
    if cable and l0 > 0.0 and stretch.real < -band:
        return length, stretch.real * 0.0, V * 0.0
    if length == 0.0:
        return length, k * stretch, V * (0.0 if l0 else k)
    if cable and stretch.real < 0.0:
        stretch -= stretch.real
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
