"""Stable or not: the sign of the tangent stiffness on the complement of the rigid motions."""

from typing import Any

import numpy as np

from cgff_cli.mechanics.equilibrium import force_density_matrix
from cgff_cli.mechanics.rigid import rigid_motions
from cgff_cli.mechanics.state import State


def stability(state: State) -> dict[str, Any]:
    """Return whether a balanced state is a strict minimum of the energy, apart from rigid motions.

    stability: "stable", "unstable", or "neutral" where the softest deformation has no stiffness beyond what
    rounding and the remaining residual explain; smallest_stiffness: that stiffness, force per length.
    """
    R = rigid_motions(state.X, state.mechanics.structure.free)
    K = state.dense_tangent()
    if len(K) == R.shape[1]:
        return {"stable": True, "stability": "stable", "smallest_stiffness": None}
    stiffest = float(np.abs(np.linalg.eigvalsh(K)).max()) or 1.0
    K -= R @ (R.T @ K)
    K -= (K @ R) @ R.T
    softest = float(np.linalg.eigvalsh(0.5 * (K + K.T) + 2.0 * stiffest * (R @ R.T))[0])
    size = float(np.abs(state.X).max()) or 1.0
    unsure = 1e-14 * len(K) * stiffest + 4.0 * float(np.linalg.norm(state.free_eta)) / size
    kind = "stable" if softest > unsure else "unstable" if softest < -unsure else "neutral"
    return {"stable": kind == "stable", "stability": kind, "smallest_stiffness": softest}


def is_super_stable(state: State, tolerance: float) -> bool:
    """Return whether the stress alone makes the shape stable, whatever the stiffness (Connelly 1982).

    D is positive semidefinite and has no null vectors but the affine motions: n_D is d + 1, or one more
    than the dimension of the affine span of a flat structure. With supports, D acts on the free directions
    and the affine motions are those that the supports allow.
    """
    d = state.X.shape[1]
    free = state.mechanics.structure.free.reshape(-1)
    D = np.kron(force_density_matrix(state.mechanics.connectivity.dense, state.q), np.eye(d))
    values = np.linalg.eigvalsh(D[np.ix_(free, free)])
    if not len(values) or not values[-1] > 0.0:
        return False
    threshold = tolerance * values[-1]
    nullity = int((np.abs(values) <= threshold).sum())
    return bool(values[0] >= -threshold) and nullity == _affine_motions(state.X, free)


def _affine_motions(X: np.ndarray, free: np.ndarray) -> int:
    """Return how many independent affine motions of the nodes leave the held directions in place."""
    n, d = X.shape
    Y = X - X.mean(axis=0)
    spanned = np.concatenate((np.ones((n, 1)), Y / (np.abs(Y).max() or 1.0)), axis=1)
    left, values, _ = np.linalg.svd(spanned, full_matrices=False)
    affine = np.kron(left[:, values > 1e-9 * values[0]], np.eye(d))
    held = affine[~free]
    return affine.shape[1] - (int(np.linalg.matrix_rank(held, tol=1e-9)) if len(held) else 0)
