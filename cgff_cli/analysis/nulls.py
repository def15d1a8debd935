"""What is zero in U and D: how many singular values lie within a threshold, of dense and sparse matrices.

Of a sparse symmetric A the negative pivots of A - shift count the eigenvalues below the shift (Sylvester),
but for those within the factor's own rounding error, 4 eps |L| |U|, which is measured, not guessed.
"""

from typing import Any, NamedTuple

import numpy as np

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.signs import is_positive

MOST_SOFT = 500
"""Soft motions, or states, that are told from null ones: under a second (tests/studies/analysis_cost.py)."""

DENSE = 1500
"""Rows or columns up to which a matrix with more of them is decomposed after all: about a second."""

SQUARED = 1e-12
"""Shift that makes U^T U, whose columns are unit vectors, definite: its rounding error, with room."""

APART = 1e-4
"""Singular values of U above this mix with null ones by 1e-11, after inverse iteration with U^T U."""

ITERATIONS, GUARDS = 3, 8

NONE = float("nan")

MUDDLED, NEAR = 10.0, 3.0
"""Least factors of a singular value kept over one left out, and over the threshold, or that decides alone."""


class Rank(NamedTuple):
    """How many singular values exceed a threshold, None where none can tell; the least of these, the greatest
    of the others; NaN where that is not looked at, and where there is none.

    is_muddled: whether the threshold alone decides, as values stand near it, or near each other about it.
    """

    number: int | None
    kept: float = NONE
    left: float = NONE
    is_muddled: bool = False


def rank(U: Any, threshold: float, seems_full: bool = False) -> Rank:
    """Return how many singular values of U, dense or sparse, exceed the threshold.

    U^T U cannot tell values below the root of eps from zero. It tells how many are small, and by inverse
    iteration of which motions, or states; U times those tells how small they are. seems_full: a dense U is
    tried for full rank, which is quick to see, first.
    """
    M = U if U.shape[1] <= U.shape[0] else U.T
    if 0 in M.shape:
        return Rank(0)
    if isinstance(M, np.ndarray):
        if seems_full and threshold < APART and is_positive(M.T @ M, -(APART**2)):
            return Rank(M.shape[1])
        return _ranked(np.linalg.svd(M, compute_uv=False), threshold, M.shape[1])
    squared = M.T @ M
    apart = max(APART, 2.0 * threshold)
    count, doubt = below(squared, apart**2)
    if doubt > 0.1 * apart**2 or count > MOST_SOFT:
        return rank(U.toarray(), threshold) if M.shape[1] <= DENSE else Rank(None)
    return _ranked(_softest(M, squared, count), threshold, M.shape[1])


def _ranked(values: np.ndarray, threshold: float, count: int) -> Rank:
    """Return the rank of a matrix with so many singular values, the least of them given, falling."""
    left = int((values <= threshold).sum())
    own = len(values) - left
    least, greatest = (values[own - 1] if own else NONE), (values[own] if left else NONE)
    return Rank(count - left, least, greatest, least < MUDDLED * greatest or least < NEAR * threshold)


def zeros(D: Any, threshold: float) -> tuple[int | None, bool | None]:
    """Return how many eigenvalues of a symmetric D are zero, and whether none is negative."""
    if 0 in D.shape:
        return 0, True
    if isinstance(D, np.ndarray):
        values = np.linalg.eigvalsh(D)
        return int((np.abs(values) <= threshold).sum()), bool((values >= -threshold).all())
    (upto, unsure), (negative, doubt) = below(D, threshold), below(D, -threshold)
    if max(unsure, doubt) > 0.1 * threshold:
        return zeros(D.toarray(), threshold) if D.shape[0] <= DENSE else (None, None)
    return upto - negative, negative == 0


def below(A: Any, shift: float) -> tuple[int, float]:
    """Return how many eigenvalues of a symmetric A are below the shift, and by how much that may be wrong."""
    try:
        lu = shifted_factor(A, -shift)
    except RuntimeError:  # exactly singular
        return 0, float("inf")
    if (lu.perm_r != lu.perm_c).any():
        return 0, float("inf")
    error = 4.0 * EPS * (abs(lu.L) @ (abs(lu.U) @ np.ones(A.shape[0]))).max()
    return int((lu.U.diagonal() < 0.0).sum()), float(error)


def shifted_factor(A: Any, shift: float) -> Any:
    """Return the factors of a sparse symmetric A + shift, pivots on the diagonal where they are not zero."""
    from scipy.sparse import diags_array
    from scipy.sparse.linalg import splu

    shifted = (A + diags_array(np.full(A.shape[0], shift))).tocsc()
    options = {"SymmetricMode": True}
    return splu(shifted, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)


def _softest(M: Any, squared: Any, count: int) -> np.ndarray:
    """Return the least singular values of M, squared = M^T M: `count` and a guard; none is told too small."""
    n = M.shape[1]
    size = min(count + GUARDS, n)
    Y = np.cos(np.arange(n * size, dtype=float) ** 2).reshape(size, n).T
    if count:
        factor = shifted_factor(squared, SQUARED)
        for _ in range(ITERATIONS):
            Y = np.linalg.qr(factor.solve(Y))[0]
    return np.linalg.svd(M @ Y, compute_uv=False)[max(size - count - 1, 0) :]
