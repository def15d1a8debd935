"""The tangent stiffness K = d(-eta)/dX = -H, eq. (11), (12): times a vector, and dense.

Element e adds the block B = (k - q) u u^T + q I between its two nodes, u its unit vector; k = 0 when slack.
With w = (k - q) / l^2 that is w V V^T + q I, and with rho^T rho of every element written out in a row,

    K_aicj = sum over e of  (w V_a V_c + q delta_ac)  rho_ei rho_ej

is one product of matrices; where rho^T rho is too much to write out, blocks go to their places one by one.
"""

from functools import cache, lru_cache
from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.connectivity import Connectivity


class Parts(NamedTuple):
    """What K is the sum of at positions X (d, m): w V V^T + q I per element; V (d, b), w and q (b,)."""

    X: np.ndarray
    V: np.ndarray
    w: np.ndarray
    q: np.ndarray


def times(connectivity: Connectivity, parts: Parts, Y: np.ndarray) -> np.ndarray:
    """Return K Y, (d, m), without forming K, eq. (12). Y: (d, m)."""
    _, V, w, q = parts
    Z = connectivity.differences(Y)
    axial = w * np.einsum("ab,ab->b", V, Z)
    return connectivity.gather(axial * V + q * Z)


def blocks(V: np.ndarray, w: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return (d d, ..., b) blocks w V V^T + q I of elements. V: (d, ..., b), w and q: (..., b)."""
    rows, columns = _axes(len(V))
    B = (w * V).take(rows, 0)
    B *= V.take(columns, 0)
    B[:: len(V) + 1] += q
    return B


@cache
def _axes(d: int) -> tuple[np.ndarray, np.ndarray]:
    """Return the row and the column of every place in a d x d block."""
    rows, columns = np.divmod(np.arange(d * d), d)
    return rows, columns


@lru_cache(16)
def _blockwise(d: int, m: int) -> np.ndarray:
    """Return (d m, d m): where the entries of a matrix over directions stand in its (d d, m m) blocks."""
    return np.arange(d * d * m * m).reshape(d, d, m, m).swapaxes(1, 2).reshape(d * m, d * m)


def stiffness_matrix(connectivity: Connectivity, parts: Parts, mask: np.ndarray | None) -> np.ndarray:
    """Return K, (d m, d m), axis by axis, eq. (11).

    mask: (d, m) 1 in free directions, 0 in held ones, which keep only 1 on the diagonal; None for all free.
    """
    B, size = blocks(*parts[1:]), parts.X.size
    if connectivity.is_small and connectivity.pairs is not None:
        K = B.dot(connectivity.pairs).take(_blockwise(*parts.X.shape))
    else:
        flat = np.bincount(connectivity.places, np.concatenate((B, B, -B, -B), axis=None), size * size + 1)
        K = flat[:-1].reshape(size, size)
    if mask is not None:
        free = mask.reshape(-1)
        K *= free[:, None] * free
        K.reshape(-1)[:: size + 1] += 1.0 - free
    return K
