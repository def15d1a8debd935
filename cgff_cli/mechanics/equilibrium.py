"""Balance of forces at the nodes: U, D and the residual, eq. (3), (4), (8), (9).

Degrees of freedom run node by node: row i d + a is node i, axis a. The paper runs axis by axis; ranks,
nullities and eigenvalues do not notice.
"""

import numpy as np

from cgff_cli.mechanics.connectivity import Connectivity


def equilibrium_matrix(rho: np.ndarray, V: np.ndarray) -> np.ndarray:
    """Return U, (n d, b), eq. (3): U q are the nodal forces that carry force densities q.

    rho: (b, n) connectivity; V: (b, d) element vectors rho X.
    """
    b, n = rho.shape
    return (rho.T[:, None, :] * V.T[None, :, :]).reshape(n * V.shape[1], b)


def force_density_matrix(rho: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return D = rho^T diag(q) rho, (n, n), eq. (4)."""
    return (rho.T * q) @ rho


def residual(connectivity: Connectivity, V: np.ndarray, q: np.ndarray, loads: np.ndarray) -> np.ndarray:
    """Return eta = F - U q, (n, d), eq. (8), (9): the out-of-balance force on every node."""
    return loads - connectivity.gather(q[:, None] * V)
