"""States of self-stress: the forces that balance at every free direction, from coordinates alone.

U t = F, eq. (3), with the columns of U unit vectors and t the forces. Members may share one value, a force
density or a force: they are one column then, again of length 1, so that singular values compare with 1
whoever shares. What an element carries is `forces` of an x.
"""

from functools import cached_property
from typing import Any

import numpy as np

from cgff_cli.analysis.nulls import DENSE, SQUARED, rank, shifted_factor
from cgff_cli.analysis.ranks import unit_equilibrium_matrix
from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import largest, norm
from cgff_cli.mechanics.state import State
from cgff_cli.options import DEFAULTS

MOST_ENTRIES = 10_000_000
"""Entries up to which a matrix is decomposed whole: seconds (tests/studies/prestress.py)."""

REFINEMENTS = 6
"""Steps that bring what a sparse A leaves over down to rounding, but for motions softer than the shift."""


class SelfStress:
    """A x = F over the free directions of a shape; tolerance: singular values up to it are states.

    classes : (b,) int, members of one class share a value      share : (b,) what they carry of one unit
    size    : (m,) length of each class's column for one unit   F     : (f,) loads, in the frame's units
    A       : (f, m) dense where that is small, else sparse columns
    """

    def __init__(self, state: State, classes: np.ndarray | None, equal_force: bool, tolerance: float):
        m, self.state, self.tolerance, self.equal_force = state.mechanics, state, tolerance, equal_force
        b = len(state.l)
        self.classes = np.arange(b) if classes is None else classes
        self.count = np.bincount(self.classes).astype(float)
        self.share = np.ones(b) if equal_force else state.l
        self.size = np.sqrt(np.bincount(self.classes, self.share**2))
        free = m.structure.free.T.reshape(-1)
        U = unit_equilibrium_matrix(state)[free]
        self.F = (m.structure.loads.T.reshape(-1) * (1.0 / m.frame.force))[free]
        self.A = self._gathered(U)
        if not isinstance(self.A, np.ndarray) and min(self.A.shape) <= DENSE:
            self.A = self.A.toarray() if self.A.shape[0] * self.A.shape[1] <= MOST_ENTRIES else self.A

    def _gathered(self, U: Any) -> Any:
        """Return the columns of U, those of a class as one; what cancels but for rounding is 0."""
        if len(self.count) == len(self.classes):
            return U
        weights = self.share / self.size[self.classes]
        blur = ADDED_UP * float((self.state.rounding / self.state.l).max())
        if isinstance(U, np.ndarray):
            S = np.zeros((len(weights), len(self.count)))
            S[np.arange(len(S)), self.classes] = weights
            A = U @ S
            return np.where(np.abs(A) > blur, A, 0.0)
        from scipy.sparse import csc_array

        A = (U @ csc_array((weights, (np.arange(len(weights)), self.classes)))).tocsc()
        A.data[np.abs(A.data) <= blur] = 0.0
        A.eliminate_zeros()
        return A

    @property
    def is_loaded(self) -> bool:
        """Whether there are loads in free directions."""
        return bool(self.F.any())

    @property
    def is_dense(self) -> bool:
        """Whether all of A is decomposed."""
        return isinstance(self.A, np.ndarray)

    @cached_property
    def parts(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """A = left diag(values) right, right (m, m): its last rows span what A takes to zero."""
        f, m = self.A.shape
        square = np.concatenate((self.A, np.zeros((max(m - f, 0), m))))
        left, values, right = np.linalg.svd(square, full_matrices=False)
        return left[:f], values, right

    @cached_property
    def rank(self) -> int | None:
        """How many singular values are no states; None where too many are too soft to tell."""
        return (
            int((self.parts[1] > self.tolerance).sum())
            if self.is_dense
            else rank(self.A, self.tolerance).number
        )

    @property
    def states(self) -> int | None:
        """How many independent states there are: columns less rank."""
        return None if self.rank is None else len(self.size) - self.rank

    @property
    def gap(self) -> float | None:
        """Least singular value kept over the greatest left out; None where either is lacking."""
        kept = self.rank
        if not self.is_dense or kept is None or not 0 < kept < min(self.A.shape):
            return None
        least_kept, left_out = self.parts[1][kept - 1 : kept + 1]
        return float(least_kept / left_out) if left_out > 0.0 else None

    @property
    def softest(self) -> float | None:
        """The least singular value, where that is computed and there are no fewer rows than columns."""
        return float(self.parts[1][-1]) if self.is_dense and self.A.shape[0] >= self.A.shape[1] else None

    @property
    def basis(self) -> np.ndarray:
        """(m, k) orthonormal states of a dense A."""
        return self.parts[2][self.rank :].T

    def nearest(self, x: np.ndarray, F: np.ndarray | float) -> np.ndarray:
        """Return the nearest x with A x = F, or as near to it as can be."""
        if self.is_dense:
            left, values, right = (own[: self.rank] for own in (self.parts[0].T, *self.parts[1:]))
            return x - right.T @ ((left @ (self.A @ x - F)) / values)
        for _ in range(REFINEMENTS):
            x = x - self._moved_least(self.A @ x - F)
        return x

    def _moved_least(self, out: np.ndarray) -> np.ndarray:
        """Return the least x, and without states the only one, that makes A x - out least, nearly."""
        if self.states != 0:
            return self.A.T @ self._normal.solve(out)
        return self._only.solve(np.concatenate((out, np.zeros(len(self.size)))))[len(out) :]

    @cached_property
    def _only(self) -> Any:
        """Factors of [[a, A], [A^T, 0]], which know a soft x as A does, not as its square (Björck 1967)."""
        from scipy.sparse import block_array, eye_array

        K = block_array([[BJORCK * eye_array(self.A.shape[0]), self.A], [self.A.T, None]], format="csc")
        return shifted_factor(K, 0.0)

    @cached_property
    def bearing(self) -> np.ndarray:
        """The least x that leaves the least of F over, (m,)."""
        return self.nearest(np.zeros(len(self.size)), self.F)

    @property
    def unborne(self) -> float:
        """What is left over of the loads by that, relative to all forces; 0 without loads."""
        return self.left_over(self.bearing) if self.is_loaded else 0.0

    def tells(self, members: np.ndarray | None, by: float) -> bool:
        """Return whether F is met so well that forces of members, (b,) bool, are told from those `by` off.

        Of a dense A: F may be as much off along A as it is across.
        """
        if not self.is_met(self.bearing) or not self.is_dense:
            return self.is_met(self.bearing)
        values, right = (own[: self.rank] for own in self.parts[1:])
        off = norm(self.A @ self.bearing - self.F) * np.linalg.norm(right / values[:, None], axis=0)
        return by > largest(self.forces(off)[members])

    @cached_property
    def _normal(self) -> Any:
        return shifted_factor(self.A @ self.A.T, SQUARED)

    def moved(self, state: State, x: np.ndarray) -> "tuple[SelfStress, np.ndarray]":
        """Return the balance at another shape, and the x there that has the same values."""
        there = SelfStress(state, self.classes, self.equal_force, self.tolerance)
        return there, x / self.size * there.size

    def idle(self) -> np.ndarray:
        """Return (m,) bool: what carries nothing in any state, whatever its sign."""
        if self.is_dense:
            return np.linalg.norm(self.basis, axis=1) <= IDLE
        generic = np.cos(np.arange(len(self.size)) ** 2.0)  # no state is orthogonal to it by design
        return np.abs(self.nearest(generic, 0.0)) <= IDLE

    def forces(self, x: np.ndarray) -> np.ndarray:
        """Return (b,) element forces, in the frame's units."""
        return self.share * (x / self.size)[self.classes]

    def left_over(self, x: np.ndarray) -> float:
        """Return how far A x is from F, relative to x and F."""
        return norm(self.A @ x - self.F) / max(norm(x), norm(self.F), EPS)

    def is_met(self, x: np.ndarray) -> bool:
        """Return whether A x = F but for what a solve may leave over by default, or next to rounding."""
        most = max(largest(self.forces(x)), largest(self.F))
        return largest(self.A @ x - self.F) <= DEFAULTS.tolerance * most or self.left_over(x) <= IN_BALANCE


IN_BALANCE = 3e-11
"""What may be left over, relative to all forces, whatever the largest component of it."""

ADDED_UP = 8.0
"""Rounding errors of a member's direction that entries of a class may add up to."""

BJORCK = 1e-4
"""Weight of what is left over beside columns of length 1, near the least singular value of soft nets."""

IDLE = 1e-9
"""Share of a unit state below which an element carries rounding alone."""
