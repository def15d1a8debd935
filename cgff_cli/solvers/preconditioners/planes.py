"""Local directions at the nodes of a net: two tangents and the normal, where cables span a plane."""

import numpy as np

from cgff_cli.structure import Structure

SKEWEST = 0.95
"""Cosine between two tangents from which they hardly differ."""

EVENINGS = 3
"""Rounds of averaging directions over neighbours."""

SAMPLE = 1000
"""Elements that tell the prevailing direction of a net."""


def local_frames(structure: Structure, k: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return (d, n, d) unit vectors: the local directions at each node, normals last. k: (b,), u: (b, d).

    The normal is the softest direction of A = sum k u u^T over a node's elements: the largest column
    of its adjugate. The tangents of a net's node suit its two families of cables: each lies across the
    other family, so that it stretches its own alone, however skew the meshes are.
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
    first = _normalized(_across(normal, along + np.zeros((n, 1))))
    second = np.cross(normal, first)
    one, other = _families(structure, k, u, first, second)
    skew = np.cross(other, normal), np.cross(normal, one)
    sizes = [np.sqrt(np.einsum("ni,ni->n", e, e)) for e in skew]
    usable = np.minimum(*sizes) > 1e-6 * max(float(size.max()) for size in sizes)
    pair = np.stack([e / np.where(usable, size, 1.0)[:, None] for e, size in zip(skew, sizes, strict=True)])
    usable &= np.abs(np.einsum("ni,ni->n", *pair)) < SKEWEST
    return np.concatenate((np.where(usable[:, None], pair, (first, second)), normal[None]))


def _families(
    structure: Structure, k: np.ndarray, u: np.ndarray, first: np.ndarray, second: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return (n, d) directions of a node's elements, all pointing one way: those near `first`, the rest.

    Each is evened out over the neighbours: what one node's elements scatter would roughen the frames, and
    rough frames bend a smooth shift of the whole net.
    """
    from scipy.sparse import csr_array, eye_array

    sums = [np.zeros_like(first), np.zeros_like(first)]
    for ends in (structure.start, structure.end):
        rates = [np.einsum("ei,ei->e", u, t[ends]) for t in (first, second)]
        nearer = np.abs(rates[0]) >= np.abs(rates[1])
        for total, rate, mine in zip(sums, rates, (nearer, ~nearer), strict=True):
            w = np.where(mine, np.copysign(k, rate), 0.0)
            for axis in range(u.shape[1]):
                total[:, axis] += np.bincount(ends, w * u[:, axis], minlength=len(first))
    ends = np.concatenate((structure.start, structure.end))
    others = np.concatenate((structure.end, structure.start))
    even = csr_array((np.ones(len(ends)), (ends, others))) + eye_array(len(first))
    for _ in range(EVENINGS):
        sums = [even @ _normalized(total) for total in sums]
    return sums[0], sums[1]


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
