"""Groups of rotations, and the least push of struts that balances cables under them."""

from math import cos, sin

import numpy as np


def turned_about(axis: tuple[float, float, float], angle: float) -> np.ndarray:
    """Return the (3, 3) rotation about a unit axis (Rodrigues)."""
    x, y, z = axis
    cross = np.array([(0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)])
    return np.eye(3) + sin(angle) * cross + (1.0 - cos(angle)) * cross @ cross


def rotations_of(*generators: np.ndarray) -> np.ndarray:
    """Return the (m, 3, 3) rotations that some rotations generate, the identity first."""
    found = [np.eye(3)]
    for rotation in found:  # grows while it is walked
        for generator in generators:
            product = rotation @ generator
            if np.abs(np.array(found) - product).max(axis=(1, 2)).min() > 1e-6:
                found.append(product)
    return np.array(found)


def least_push(A: np.ndarray, B: np.ndarray) -> tuple[float, np.ndarray]:
    """Return the force density q of the struts nearest 0, and a p that it balances: A p + q B p = 0.

    A, B : (m, m) symmetric, what cables and struts of force density 1 pull, A positive definite. q is -1
    over the largest eigenvalue of A^-1/2 B A^-1/2; with any other root the stress has negative values.
    """
    values, vectors = np.linalg.eigh(A)
    root = vectors / np.sqrt(values) @ vectors.T
    pulls, points = np.linalg.eigh(root @ B @ root)
    return -1.0 / float(pulls[-1]), root @ points[:, -1]
