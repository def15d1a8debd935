"""Local frames at the nodes of a net: two tangents and the normal, as far as cables span a plane there."""

import numpy as np

from cgff_cli.structure import Structure

SAMPLE = 1000
"""Elements that tell the prevailing direction of a net."""


def local_frames(structure: Structure, k: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return (d, n, d) orthonormal local directions, the normals last. k: (b,), u: (b, d) unit vectors.

    The normal is the softest direction of A = sum k u u^T over a node's elements: the largest column
    of its adjugate. The first tangent follows one direction of the whole net, the one most elements
    run along, so that frames at neighbours agree.
    """
    n, d = structure.coordinates.shape
    ends = np.concatenate((structure.start, structure.end))
    A = np.empty((n, d, d))
    for i in range(d):
        for j in range(i, d):
            w = k * u[:, i] * u[:, j]
            A[:, i, j] = A[:, j, i] = np.bincount(ends, np.concatenate((w, w)), minlength=n)
    along = _prevailing(k, u)
    if d == 2:
        tangent = _normalized(A @ along + 1e-9 * along)
        return np.stack((tangent, tangent[:, ::-1] * (-1.0, 1.0)))
    normal = _softest(A)
    tangent = _normalized(_across(normal, along + np.zeros((n, 1))))
    return np.stack((tangent, np.cross(normal, tangent), normal))


def _prevailing(k: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the unit direction t, near the first element's, that maximises sum k (u.t)^4 over a sample."""
    t, step = u[0], 1 + len(u) // SAMPLE
    k, u = k[::step], u[::step]
    for _ in range(10):
        t = (k * (u @ t) ** 3) @ u
        t = t / (np.linalg.norm(t) or 1.0)
    return t


def _softest(A: np.ndarray) -> np.ndarray:
    """Return (n, 3) unit vectors of the least stiffness of (n, 3, 3) matrices, exact where it is zero."""
    A = A + 1e-6 * np.trace(A, axis1=1, axis2=2)[:, None, None] * np.eye(3)
    adjugate = np.stack((np.cross(A[:, 1], A[:, 2]), np.cross(A[:, 2], A[:, 0]), np.cross(A[:, 0], A[:, 1])))
    best = np.einsum("cni,cni->cn", adjugate, adjugate).argmax(axis=0)
    return _normalized(adjugate[best, np.arange(len(A))])


def _across(normal: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return (n, 3) what of t is across the normals; some direction across where nothing is."""
    rest = t - normal * np.einsum("ni,ni->n", normal, t)[:, None]
    lost = np.einsum("ni,ni->n", rest, rest) < 1e-4
    other = np.eye(3)[np.abs(normal).argmin(axis=1)]
    rest[lost] = np.cross(normal, other)[lost]
    return rest


def _normalized(vectors: np.ndarray) -> np.ndarray:
    lengths = np.sqrt(np.einsum("ni,ni->n", vectors, vectors))
    return vectors / np.where(lengths > 0.0, lengths, 1.0)[:, None]
