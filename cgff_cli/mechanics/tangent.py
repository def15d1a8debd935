"""The tangent stiffness K = d(-eta)/dX = -H, eq. (11), (12): times a vector, and dense.

Element e adds the block B = (k - q) u u^T + q I between its two nodes, u its unit vector; k = 0 when slack.
With w = (k - q) / l^2 that is w V V^T + q I, and with rho^T rho of every element written out in a row,

    K_aicj = sum over e of  (w V_a V_c + q delta_ac)  rho_ei rho_ej

is one product of matrices.
"""

from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.connectivity import Connectivity
from cgff_cli.mechanics.equilibrium import equilibrium_matrix, force_density_matrix


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
    """Return (d, d, ..., b) blocks w V V^T + q I of elements. V: (d, ..., b), w and q: (..., b)."""
    B = (w * V)[:, None] * V
    B.reshape(-1, *q.shape)[:: len(V) + 1] += q
    return B


def dense(connectivity: Connectivity, parts: Parts, mask: np.ndarray | None) -> np.ndarray:
    """Return K, (d m, d m), axis by axis, eq. (11); w >= 0 in a large structure.

    mask: (d, m) 1 in free directions, 0 in held ones, which keep only 1 on the diagonal; None for all free.
    """
    _, V, w, q = parts
    if connectivity.is_small:
        (d, b), n = V.shape, len(connectivity.rho_t)
        K = blocks(V, w, q).reshape(d * d, b).dot(connectivity.pairs)
        K = K.reshape(d, d, n, n).swapaxes(1, 2).reshape(d * n, d * n)
    else:
        K = _by_two_products(connectivity.dense(), V, w, q)
    if mask is not None:
        free = mask.reshape(-1)
        K *= free[:, None] * free
        K.reshape(-1)[:: len(K) + 1] += 1.0 - free
    return K


def _by_two_products(rho_t: np.ndarray, V: np.ndarray, w: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return K = U diag(w) U^T + I (x) D where rho^T rho of every element is too much to write out."""
    d, n = len(V), len(rho_t)
    A = equilibrium_matrix(rho_t, V * np.sqrt(w))
    K = A @ A.T
    on_each_axis = np.einsum("aiaj->aij", K.reshape(d, n, d, n))  # a view of K
    on_each_axis += force_density_matrix(rho_t, q)
    return K
