"""The one norm that all rooms use."""

from math import sqrt

import numpy as np


def norm(values: np.ndarray) -> float:
    """Return the Euclidean (for a matrix, Frobenius) norm of an array."""
    return sqrt(np.vdot(values, values))
