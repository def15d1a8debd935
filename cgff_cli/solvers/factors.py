"""Factors of large sparse symmetric positive definite matrices: SuperLU, or CHOLMOD where it is installed.

CHOLMOD (through cvxopt, the optional extra `cgff-cli[cholmod]`) analyses a pattern once and refuses an
indefinite matrix by itself. SuperLU comes with scipy; with symmetric ordering and no pivoting the signs of
the diagonal of U are the inertia (Sylvester's law).
"""

from importlib.util import find_spec
from typing import Any, Protocol

import numpy as np


class Factor(Protocol):
    """A factor M = L L^T or L U."""

    def solve(self, b: np.ndarray) -> np.ndarray:
        """Return M^-1 b."""


class Factory(Protocol):
    """Factors matrices of one pattern; a new factor takes the place of the one before it in its slot."""

    def factor(self, data: np.ndarray, slot: int = 0, *, is_definite: bool = False) -> Factor | None:
        """Return the factor of the matrix with this data, or None unless it is positive definite.

        is_definite: what is known beforehand, and saves the check.
        """


def factory(indices: np.ndarray, indptr: np.ndarray, kind: str = "auto") -> Factory:
    """Return a Factory for a symmetric pattern; kind: auto, superlu or cholmod."""
    if kind == "auto":
        kind = "superlu" if find_spec("cvxopt") is None else "cholmod"
    return (_Cholmod if kind == "cholmod" else _SuperLU)(indices, indptr)


class _SuperLU:
    def __init__(self, indices: np.ndarray, indptr: np.ndarray):
        self.indices, self.indptr = indices, indptr

    def factor(self, data: np.ndarray, slot: int = 0, *, is_definite: bool = False) -> Factor | None:
        """Return the factor, or None where a pivot is not positive."""
        from scipy.sparse import csc_array
        from scipy.sparse.linalg import splu

        size = len(self.indptr) - 1
        matrix = csc_array((data, self.indices, self.indptr), shape=(size, size))
        try:
            # Panels of one column: a quarter faster than SuperLU's default on nets and towers.
            lu = splu(
                matrix,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                panel_size=1,
                options={"SymmetricMode": True},
            )
        except RuntimeError:  # exactly singular
            return None
        if not is_definite and not (lu.U.diagonal() > 0.0).all():
            return None
        return lu


class _Cholmod:
    def __init__(self, indices: np.ndarray, indptr: np.ndarray):
        import cvxopt
        from cvxopt import cholmod

        self.cvxopt, self.cholmod = cvxopt, cholmod
        size = len(indptr) - 1
        columns = np.repeat(np.arange(size), np.diff(indptr))
        self.lower = np.flatnonzero(indices >= columns)
        rows, columns = indices[self.lower], columns[self.lower]
        places = (cvxopt.matrix(part.astype(np.int64)) for part in (rows, columns))
        self.matrix = cvxopt.spmatrix(1.0, *places, (size, size))
        self.slots: dict[int, Any] = {}

    def factor(self, data: np.ndarray, slot: int = 0, *, is_definite: bool = False) -> Factor | None:
        """Return the factor, or None where CHOLMOD refuses the matrix."""
        if slot not in self.slots:
            self.slots[slot] = self.cholmod.symbolic(self.matrix)
        self.matrix.V = self.cvxopt.matrix(data[self.lower])
        try:
            self.cholmod.numeric(self.matrix, self.slots[slot])
        except ArithmeticError:
            return None
        return _CholmodFactor(self, self.slots[slot])


class _CholmodFactor:
    def __init__(self, home: _Cholmod, factored: Any):
        self.home, self.factored = home, factored

    def solve(self, b: np.ndarray) -> np.ndarray:
        """Return M^-1 b."""
        x = self.home.cvxopt.matrix(b)
        self.home.cholmod.solve(self.factored, x)
        return np.array(x).reshape(b.shape)
