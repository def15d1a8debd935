"""Balance of forces at the nodes: U, D and the residual, eq. (3), (4), (8), (9).

Degrees of freedom run axis by axis, as in the paper: row a n + i is node i, axis a.
"""

import numpy as np

from cgff_cli.mechanics.connectivity import Connectivity


def equilibrium_matrix(rho_t: np.ndarray, V: np.ndarray) -> np.ndarray:
    """Return U, (d n, b), eq. (3): U q are the nodal forces that carry force densities q.

    rho_t: (n, b) connectivity, transposed; V: (d, b) element vectors rho X.
    """
    return (V[:, None] * rho_t).reshape(-1, V.shape[1])


def force_density_matrix(rho_t: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return D = rho^T diag(q) rho, (n, n), eq. (4); q: (b,)."""
    return (rho_t * q) @ rho_t.T


def internal_forces(connectivity: Connectivity, V: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Return U q, (d, ..., m), the pull of elements on nodes; the residual is eta = F - U q, eq. (8), (9)."""
    return connectivity.gather(V * q)
