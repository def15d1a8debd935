"""What is zero in U and D: how many singular values lie within a threshold, of dense and sparse matrices.

Of a sparse symmetric A the negative pivots of A - shift count the eigenvalues below the shift (Sylvester),
but for those within the factor's own rounding error, 4 eps |L| |U|, which is measured, not guessed.
"""

from typing import Any

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


def rank(U: Any, threshold: float, seems_full: bool = False) -> int | None:
    """Return how many singular values of U, dense or sparse, exceed the threshold; None where none can tell.

    U^T U cannot tell values below the root of eps from zero. It tells how many are small, and by inverse
    iteration of which motions, or states; U times those tells how small they are. seems_full: a dense U is
    tried for full rank, which is quick to see, first.
    """
    M = U if U.shape[1] <= U.shape[0] else U.T
    if 0 in M.shape:
        return 0
    squared = M.T @ M
    if isinstance(M, np.ndarray):
        if seems_full and threshold < APART and is_positive(squared, -(APART**2)):
            return M.shape[1]
        return int((np.linalg.svd(M, compute_uv=False) > threshold).sum())
    count, doubt = _below(squared, threshold**2)
    if doubt > 0.1 * threshold**2:
        count, doubt = _below(squared, APART**2)
        if doubt > 0.1 * APART**2 or count > MOST_SOFT:
            return rank(U.toarray(), threshold) if M.shape[1] <= DENSE else None
        count = int((_softest(M, squared, count) <= threshold).sum())
    return M.shape[1] - count


def zeros(D: Any, threshold: float) -> tuple[int | None, bool | None]:
    """Return how many eigenvalues of a symmetric D are zero, and whether none is negative."""
    if isinstance(D, np.ndarray):
        values = np.linalg.eigvalsh(D)
        return int((np.abs(values) <= threshold).sum()), bool((values >= -threshold).all())
    (upto, unsure), (negative, doubt) = _below(D, threshold), _below(D, -threshold)
    if max(unsure, doubt) > 0.1 * threshold:
        return zeros(D.toarray(), threshold) if D.shape[0] <= DENSE else (None, None)
    return upto - negative, negative == 0


def _below(A: Any, shift: float) -> tuple[int, float]:
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
    """Return the `count` least singular values of M, squared = M^T M; none is told too small."""
    n = M.shape[1]
    size = min(count + GUARDS, n)
    Y = np.cos(np.arange(n * size, dtype=float) ** 2).reshape(size, n).T
    if count:
        factor = shifted_factor(squared, SQUARED)
        for _ in range(ITERATIONS):
            Y = np.linalg.qr(factor.solve(Y))[0]
    return np.linalg.svd(M @ Y, compute_uv=False)[size - count :]
