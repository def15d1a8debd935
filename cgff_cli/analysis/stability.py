"""Stable or not: the sign of the tangent stiffness on the complement of the rigid motions."""

from typing import Any

import numpy as np

from cgff_cli.mechanics.equilibrium import force_density_matrix
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.curvature import doubt
from cgff_cli.solvers.stopping import VANISHED


def stability(state: State, rigid: np.ndarray, floor: float) -> dict[str, Any]:
    """Return whether a balanced state is a strict minimum of the energy, apart from rigid motions.

    stability: "stable", "unstable", or "neutral" where the softest deformation has no stiffness beyond what
    rounding and the remaining residual explain; smallest_stiffness: that stiffness, force per length.
    rigid: (m, r) orthonormal rigid motions of the m free directions, as from `rigid_motions`. Those that
    the structure resists count: a pendulum is stable hanging and unstable upright, and on a line a rotation
    that rounding makes is not idle. A cable whose force is within rounding (floor) of none resists nothing:
    it may be shortened for free.
    """
    K = state.dense_tangent(k=resisting_stiffness(state, floor))
    stiffest = norm(K)
    unsure = doubt(K, state)
    rigid = _idle(K, rigid, unsure)
    if len(K) == rigid.shape[1]:
        return {"stable": True, "stability": "stable", "smallest_stiffness": None}
    K -= rigid @ (rigid.T @ K)
    K -= (K @ rigid) @ rigid.T
    K += stiffest * (rigid @ rigid.T)
    softest = float(np.linalg.eigvalsh(K)[0])
    kind = "stable" if softest > unsure else "unstable" if softest < -unsure else "neutral"
    return {"stable": kind == "stable", "stability": kind, "smallest_stiffness": softest}


def resisting_stiffness(state: State, floor: float) -> np.ndarray:
    """Return (b,) stiffnesses, zero for slack cables and those whose force is within rounding of none."""
    idle = state.mechanics.structure.tension_only & (state.t <= VANISHED * floor)
    return np.where(idle, 0.0, state.active_stiffness)


def _idle(K: np.ndarray, rigid: np.ndarray, unsure: float) -> np.ndarray:
    """Return a basis of the rigid motions that K does not resist."""
    _, values, rows = np.linalg.svd(K @ rigid)
    resisted = int((values > unsure).sum())
    return rigid @ rows[resisted:].T


def is_super_stable(state: State, tolerance: float) -> bool:
    """Return whether the stress alone makes the shape stable, whatever the stiffness (Connelly 1982).

    D is positive semidefinite and has no null vectors but the affine motions: n_D is d + 1, or one more
    than the dimension of the affine span of a flat structure. With supports, D acts on the free directions
    and the affine motions are those that the supports allow; loads may resist some of them. The structure
    is prestressed: without forces D is rounding error.
    """
    d = state.X.shape[1]
    D = force_density_matrix(state.mechanics.connectivity.dense, state.q)
    affine = _affine_coordinates(state.X)
    motions = affine.shape[1]
    if not state.mechanics.all_free:
        free = state.mechanics.structure.free.reshape(-1)
        D = np.kron(D, np.eye(d))[np.ix_(free, free)]
        held = np.kron(affine, np.eye(d))[~free]
        motions = motions * d - int(np.linalg.matrix_rank(held, tol=1e-9))
    values = np.linalg.eigvalsh(D)
    threshold = tolerance * float(np.abs(state.q).max())
    positive = int((values > threshold).sum())
    return positive > 0 and bool(values[0] >= -threshold) and len(values) - positive <= motions


def _affine_coordinates(X: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis (n, r) of the affine functions of the node positions."""
    Y = X - X.mean(axis=0)
    spanned = np.concatenate((np.ones((len(X), 1)), Y / (np.abs(Y).max() or 1.0)), axis=1)
    left, values, _ = np.linalg.svd(spanned, full_matrices=False)
    return left[:, values > 1e-9 * values[0]]
