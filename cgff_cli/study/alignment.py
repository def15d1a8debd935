"""Laying one shape over another, and how far apart they then are."""

import numpy as np

from cgff_cli.mechanics.rigid import RigidMotions

SAME_SHAPE = 1e-8
"""Shapes are one where no node, or no distance, is farther from the other's, over the structure's size."""

MOST_NODES_FOR_DISTANCES = 5000
"""Nodes up to which all n^2 distances are compared."""

_BLOCK = 512


def alignment_of(X: np.ndarray, free: np.ndarray) -> str:
    """Return "rigid" where the supports leave a rigid motion, else "none"."""
    return "rigid" if RigidMotions(X.T, free.T).basis.shape[1] else "none"


def laid_over(X: np.ndarray, target: np.ndarray, alignment: str, mirror: bool = True) -> np.ndarray:
    """Return X (n, d) laid over the target: "rigid", "affine" or "none"; mirror: as in `rigidly`."""
    if alignment == "none":
        return X
    return rigidly(X, target, mirror) if alignment == "rigid" else affinely(X, target)


def rigidly(X: np.ndarray, target: np.ndarray, mirror: bool = True) -> np.ndarray:
    """Return X rotated, mirrored where that is allowed and fits better, and shifted onto the target."""
    A, B = X - X.mean(axis=0), target - target.mean(axis=0)
    left, _, right = np.linalg.svd(A.T @ B)
    if not mirror and np.linalg.det(left) * np.linalg.det(right) < 0.0:
        left[:, -1] *= -1.0
    return np.asarray(A @ left @ right + target.mean(axis=0))


def affinely(X: np.ndarray, target: np.ndarray) -> np.ndarray:
    """Return X under the affine map that brings it nearest the target, least squares."""
    A, B = X - X.mean(axis=0), target - target.mean(axis=0)
    return np.asarray(A @ np.linalg.lstsq(A, B, rcond=None)[0] + target.mean(axis=0))


def largest_move(X: np.ndarray, target: np.ndarray) -> float:
    """Return the largest distance between a node of one shape and the same node of the other."""
    return float(np.sqrt(((X - target) ** 2).sum(axis=1)).max())


def size(X: np.ndarray) -> float:
    """Return the largest distance of a node from the centroid."""
    return largest_move(X, X.mean(axis=0)[None, :]) or 1.0


def distance_difference(X: np.ndarray, target: np.ndarray) -> float | None:
    """Return the largest difference of two shapes' distance matrices; None if they are too large."""
    if len(X) > MOST_NODES_FOR_DISTANCES:
        return None
    blocks = range(0, len(X), _BLOCK)
    return max(_block_difference(X, target, slice(first, first + _BLOCK)) for first in blocks)


def _block_difference(X: np.ndarray, target: np.ndarray, rows: slice) -> float:
    here, there = (
        np.sqrt(sum((axis[rows, None] - axis[None, :]) ** 2 for axis in shape.T)) for shape in (X, target)
    )
    return float(np.abs(here - there).max())
