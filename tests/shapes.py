"""When two shapes are the same, and which forces a shape can carry; without the package's matrices."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

import cgff_cli

STRUCTURES = Path(__file__).parent.parent / "structures"
Pairs = Sequence[tuple[int, int]]


def solve_structure(name: str, **options: object) -> "cgff_cli.Result":
    """Solve one of the scenes in structures/, by its name without suffix."""
    return cgff_cli.solve(cgff_cli.load(STRUCTURES / f"{name}.yaml"), **options)


def distance_matrix(X: np.ndarray) -> np.ndarray:
    """Return (n, n) distances between all nodes: the shape up to rigid motion and reflection."""
    return np.linalg.norm(X[:, None] - X[None, :], axis=-1)


def distance_difference(X: np.ndarray, Y: np.ndarray) -> float:
    """Return the largest difference between two distance matrices."""
    return float(np.abs(distance_matrix(X) - distance_matrix(Y)).max())


def aligned(X: np.ndarray, target: np.ndarray, *, reflect: bool = True) -> np.ndarray:
    """Return X moved rigidly onto the target, least squares; with a mirror image where allowed."""
    A, B = X - X.mean(axis=0), target - target.mean(axis=0)
    left, _, right = np.linalg.svd(A.T @ B)
    if not reflect and np.linalg.det(left @ right) < 0.0:
        left[:, -1] *= -1.0
    return A @ left @ right + target.mean(axis=0)


def node_difference(X: np.ndarray, target: np.ndarray, *, reflect: bool = True) -> float:
    """Return the largest difference of a coordinate after moving X rigidly onto the target."""
    return float(np.abs(aligned(X, target, reflect=reflect) - target).max())


def element_lengths(X: np.ndarray, pairs: Pairs) -> np.ndarray:
    """Return (b,) lengths."""
    return np.array([np.linalg.norm(X[i] - X[j]) for i, j in pairs])


def best_self_stress(X: np.ndarray, pairs: Pairs) -> tuple[np.ndarray, float]:
    """Return the force densities that leave the least out-of-balance force, and that least force.

    The out-of-balance force is relative: the norm of all nodal forces over the norm of all element
    forces, |U q| / |t|, made least over every q. Zero means the shape carries a self-stress. The
    force densities (b,) are scaled to 1 in the first element.
    """
    n, d = X.shape
    directions = np.zeros((n, d, len(pairs)))
    for element, (i, j) in enumerate(pairs):
        unit = (X[i] - X[j]) / np.linalg.norm(X[i] - X[j])
        directions[i, :, element] += unit
        directions[j, :, element] -= unit
    _, singular, rows = np.linalg.svd(directions.reshape(n * d, len(pairs)))
    q = rows[-1] / element_lengths(X, pairs)
    return q / q[0], float(singular[-1])


def out_of_balance(X: np.ndarray, pairs: Pairs, q: np.ndarray) -> np.ndarray:
    """Return the (n, d) sum of element forces at each node, node by node."""
    total = np.zeros_like(X)
    for node in range(len(X)):
        for (i, j), density in zip(pairs, q, strict=True):
            if node in (i, j):
                other = j if node == i else i
                total[node] += density * (X[other] - X[node])
    return total


def twist(X: np.ndarray, pairs: Pairs) -> float:
    """Return the mean angle in degrees, 0 to 180, that the pairs (bottom node, top node) turn about the axis.

    The axis joins the centres of all bottom and all top nodes.
    """
    bottom, top = (X[list(nodes)] - X[list(nodes)].mean(axis=0) for nodes in zip(*pairs, strict=True))
    axis = X[[j for _, j in pairs]].mean(axis=0) - X[[i for i, _ in pairs]].mean(axis=0)
    axis /= np.linalg.norm(axis)
    bottom, top = bottom - np.outer(bottom @ axis, axis), top - np.outer(top @ axis, axis)
    angles = np.arctan2(np.cross(bottom, top) @ axis, (bottom * top).sum(axis=1))
    return float(np.degrees(abs(angles.mean())))
