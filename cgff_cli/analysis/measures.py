"""How much a structure is strained and has moved: the numbers a person judges it by."""

from collections.abc import Sequence

import numpy as np


def strains(lengths: np.ndarray, rest_lengths: np.ndarray, slack: np.ndarray) -> np.ndarray:
    """Return (..., b) strains (l - l0) / l0: zero for slack cables, NaN where l0 is zero."""
    stretch = np.where(slack, 0.0, lengths - rest_lengths)
    found = np.full(lengths.shape, np.nan)
    with np.errstate(over="ignore"):
        return np.divide(stretch, rest_lengths, out=found, where=rest_lengths > 0.0)


def max_strain(strains: np.ndarray, rest_lengths: np.ndarray) -> float | None:
    """Return the largest strain of either sign; None where no element has a rest length."""
    strained = np.abs(strains[rest_lengths > 0.0])
    return float(strained.max()) if len(strained) else None


def max_displacement(start: np.ndarray, end: np.ndarray, rest_lengths: np.ndarray) -> float | None:
    """Return the largest distance a node moved over the structure's size; None where it has none.

    The size is the diagonal of the box around the start, or the longest rest length if that is more: a
    start in one point has no size of its own.
    """
    size = max(float(np.linalg.norm(np.ptp(start, axis=0))), float(rest_lengths.max()))
    return float(np.linalg.norm(end - start, axis=1).max()) / size if size > 0.0 else None


def reach(X: np.ndarray) -> np.ndarray:
    """Return (n,) distances from the centroid, which no rigid motion changes."""
    return np.linalg.norm(X - X.mean(axis=0), axis=1)


def firsts(counts: Sequence[int]) -> np.ndarray:
    """Return the first row of each group of so many rows."""
    return np.cumsum([0, *counts[:-1]])


def spans(column: np.ndarray, counts: Sequence[int]) -> list[list[float]]:
    """Return [least, greatest] of each group of so many rows of a column, (b,)."""
    rows = firsts(counts)
    return np.stack([end.reduceat(column, rows) for end in (np.minimum, np.maximum)], axis=1).tolist()
