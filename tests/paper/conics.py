"""Six points on one conic: where the six cables and three struts of a hexagon carry a self-stress."""

from itertools import product

import numpy as np


def conic(X: np.ndarray) -> np.ndarray:
    """Return the (...) determinant that vanishes where the six points (..., 6, 2) lie on one conic."""
    x, y = X[..., 0], X[..., 1]
    return np.linalg.det(np.stack([x * x, x * y, y * y, x, y, np.ones_like(x)], axis=-1))


def conic_gradient(X: np.ndarray) -> np.ndarray:
    """Return the (6, 2) gradient of `conic`, by central differences."""
    steps = 1e-6 * np.eye(12).reshape(12, 6, 2)
    return ((conic(X + steps) - conic(X - steps)) / 2e-6).reshape(6, 2)


def conic_misses(X: np.ndarray, reach: float) -> bool:
    """Tell whether no points within `reach` of every coordinate lie on a conic.

    The determinant is monotone in each coordinate over so small a box, so its extremes are at corners.
    """
    corners = np.array(list(product((-reach, reach), repeat=12))).reshape(-1, 6, 2)
    values = conic(X + corners)
    return bool((values > 0.0).all() or (values < 0.0).all())
