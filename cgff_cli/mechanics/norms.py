"""The two norms that all rooms use."""

from math import sqrt

import numpy as np


def norm(values: np.ndarray) -> float:
    """Return the Euclidean (for a matrix, Frobenius) norm of an array."""
    flat = values.reshape(-1)
    return sqrt(flat.dot(flat))


def largest(values: np.ndarray) -> float:
    """Return the largest absolute value in an array, 0 if it is empty."""
    return float(np.maximum.reduce(np.abs(values), axis=None, initial=0.0))
