"""The tangent stiffness K = d(-eta)/dX = -H, eq. (11), (12): times a vector, dense, sparse.

Element e adds the block B = (k - q) u u^T + q I between its two nodes, u its unit vector; k = 0 when slack.
"""

import numpy as np

from cgff_cli.mechanics.connectivity import Connectivity
from cgff_cli.mechanics.elements import TINY
from cgff_cli.mechanics.equilibrium import equilibrium_matrix, force_density_matrix


def unit_vectors(V: np.ndarray, l: np.ndarray) -> np.ndarray:
    """Return (b, d) unit vectors; zero for an element of no length."""
    return V / np.maximum(l, TINY)[:, None]


def times(
    connectivity: Connectivity, u: np.ndarray, k: np.ndarray, q: np.ndarray, W: np.ndarray
) -> np.ndarray:
    """Return K W, (n, d), without forming K, eq. (12). u: (b, d), k and q: (b,), W: (n, d)."""
    Y = connectivity.differences(W)
    axial = (k - q) * np.einsum("ij,ij->i", u, Y)
    return connectivity.gather(axial[:, None] * u + q[:, None] * Y)


def dense(rho: np.ndarray, u: np.ndarray, k: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return K, (n d, n d), node by node, eq. (11). rho: (b, n), u: (b, d), k and q: (b,)."""
    n, d = rho.shape[1], u.shape[1]
    A = equilibrium_matrix(rho, u)
    K = (A * (k - q)) @ A.T
    same_axis = np.einsum("iaja->aij", K.reshape(n, d, n, d))  # a view of K
    same_axis += force_density_matrix(rho, q)
    return K
