"""One element at a time: lengths, forces, force densities, energy. Every function takes whole columns.

With k = EA (law `paper`, eq. 2) or k = EA / l0 (law `hooke`) both laws read t = k (l - l0); a cable
shorter than its rest length is slack and carries nothing.
"""

import numpy as np


def differences(X: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Return rho X, eq. (1): (b, d) begin minus end; +1 at the begin node, -1 at the end node."""
    return X[start] - X[end]


def lengths(V: np.ndarray) -> np.ndarray:
    """Return the (b,) lengths of (b, d) element vectors, eq. (7)."""
    return np.sqrt(np.einsum("ij,ij->i", V, V))


def slack(l: np.ndarray, rest_lengths: np.ndarray, tension_only: np.ndarray) -> np.ndarray:  # noqa: E741
    """Return (b,) bool: cables shorter than their rest length, which carry no force."""
    return tension_only & (l < rest_lengths)


def forces(
    l: np.ndarray,  # noqa: E741
    stiffness: np.ndarray,
    rest_lengths: np.ndarray,
    tension_only: np.ndarray,
) -> np.ndarray:
    """Return the (b,) element forces t = k (l - l0), eq. (2); tension > 0, slack 0."""
    t = stiffness * (l - rest_lengths)
    return np.where(slack(l, rest_lengths, tension_only), 0.0, t)
