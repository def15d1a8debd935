"""Local directions at the nodes of a net: two tangents and the normal, where cables span a plane."""

import numpy as np

from cgff_cli.mechanics.elements import EPS, TINY
from cgff_cli.mechanics.pattern import GraphPattern
from cgff_cli.solvers.preconditioners.base import FIRST_SHIFT

CUBIC = 3
"""Power of the cosine by which elements count for a family: 1 takes half as many iterations again, 5 gains
nothing (tests/studies/large_rulers.py crossover)."""

_AXES = np.eye(3)

_CYCLES = ((1, 2), (2, 0), (0, 1))


def local_frames(pattern: GraphPattern, k: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return (d, d, m) unit vectors, axis by axis: the local directions at the pattern's nodes, softest last.

    k: (b,), u: (d, b). The normal is the softest direction of A = sum k u u^T over a node's elements and its
    neighbours': rough frames would bend a smooth shift of the whole net. The second tangent lies across those
    elements that run the way of the net's first, the first is conjugate to it in A, and it to the first: each
    stretches hardly more than one family of cables, however skew the meshes are. Of a chain they are along
    and across.
    """
    d = len(u)
    u = _AXES[:, :d] @ u
    way = (k * (u[:, 0] @ u) ** CUBIC) @ u.T
    family = ((way / (np.linalg.norm(way) + TINY)) @ u) ** CUBIC
    i, j = np.triu_indices(len(u))
    own = [k * u[a] * u[c] for a, c in zip(i, j, strict=True)] + [k * family * axis for axis in u]
    sums = np.stack([pattern.per_node(weights, weights) for weights in own], axis=1)
    sums = np.ascontiguousarray((pattern.matrix(np.ones(len(pattern.indices))) @ sums).T)
    A = np.empty((len(u), len(u), pattern.size))
    A[i, j] = A[j, i] = sums[: len(i)]
    normal = _softest(_stiffened(A, EPS**0.5)) if d > 2 else _AXES[:, 2:]
    A = _stiffened(A, FIRST_SHIFT)
    second = _cross(normal, _normalized(sums[len(i) :]))
    other = _cross(normal, _AXES[:, np.abs(normal).argmin(axis=0)])
    second = np.where(np.square(second).sum(axis=0) > EPS, second, other)
    first = _normalized(_cross(np.einsum("acn,cn->an", A, second), normal))
    second = _normalized(_cross(normal, np.einsum("acn,cn->an", A, first)))
    return np.stack((first, second, normal) if d > 2 else (first[:d], second[:d]))


def _stiffened(A: np.ndarray, share: float) -> np.ndarray:
    """Return (3, 3, n) matrices with a share of their traces added, which makes them invertible."""
    return A + np.multiply.outer(_AXES, share * np.einsum("aan->n", A))


def _softest(A: np.ndarray) -> np.ndarray:
    """Return (3, n) unit vectors of the least stiffness: the largest columns of adjugates."""
    adjugate = np.stack([_cross(A[a], A[c]) for a, c in _CYCLES])
    largest = np.square(adjugate).sum(axis=1).argmax(axis=0)
    return _normalized(np.take_along_axis(adjugate, largest[None, None], axis=0)[0])


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return a x b, (3, n)."""
    return np.stack([a[i] * b[j] - a[j] * b[i] for i, j in _CYCLES])


def _normalized(vectors: np.ndarray) -> np.ndarray:
    """Return (3, n) vectors of length 1; those of none stay."""
    return vectors / (np.sqrt(np.square(vectors).sum(axis=0)) + TINY)
