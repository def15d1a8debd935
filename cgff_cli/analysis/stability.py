"""Stable or not: the sign of the tangent stiffness on the complement of the idle rigid motions."""

from math import sqrt
from typing import Any

import numpy as np

from cgff_cli.mechanics.equilibrium import force_density_matrix
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.rigid import idle_motions
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.curvature import doubt, shortest
from cgff_cli.solvers.stopping import VANISHED

MOST_REFINEMENTS = 3

SETTLED = 8.0
"""Kantorovich: where K changes by at most L per length, a smallest stiffness s with s^2 > 8 L |eta| keeps
its sign on the way to the exact equilibrium, with room to spare (2 would do)."""


def stability(state: State, floor: float) -> dict[str, Any]:
    """Return whether a balanced state is a strict minimum of the energy, apart from rigid motions.

    stability: "stable", "unstable", or "neutral" where the softest deformation has no stiffness beyond what
    rounding explains; smallest_stiffness: that stiffness, force per length. It is a statement about the
    equilibrium, not about how closely it was solved for: where the remaining residual could matter, a few
    Newton steps on a copy bring it down to rounding first. Rigid motions that turn a load or a reaction
    count: a pendulum is stable hanging and unstable upright. A cable whose force is within rounding (floor)
    of none resists nothing: it may be shortened for free.
    """
    softest, unsure, step = _softest(state, floor)
    for _ in range(MOST_REFINEMENTS):
        if softest is None or _is_settled(state, softest) or norm(state.free_eta) <= floor:
            break
        there = state.mechanics.at(state.X + step)
        if not norm(there.free_eta) < norm(state.free_eta):
            break
        state = there
        softest, unsure, step = _softest(state, floor)
    if softest is None:
        return {"stable": True, "stability": "stable", "smallest_stiffness": None}
    kind = "stable" if softest > unsure else "unstable" if softest < -unsure else "neutral"
    return told(kind, state, floor) | {"smallest_stiffness": softest}


def told(kind: str, state: State, floor: float) -> dict[str, Any]:
    """Return `stable` and `stability`; null where a state so far from balance leaves the sign in doubt."""
    if kind == "neutral" and norm(state.free_eta) > VANISHED * floor * sqrt(len(state.X)):
        return {"stable": None, "stability": None}
    return {"stable": kind == "stable", "stability": kind}


def _softest(state: State, floor: float) -> tuple[float | None, float, np.ndarray]:
    """Return the least stiffness apart from idle motions (None: all are), its doubt, and a Newton step."""
    mechanics = state.mechanics
    K = state.dense_tangent(k=resisting_stiffness(state, floor))
    held_forces = mechanics.structure.loads - (state.eta - state.free_eta)
    partly = not np.array_equal(mechanics.structure.free.any(axis=1), mechanics.structure.free.all(axis=1))
    blur = norm(state.free_eta) + floor if partly else 0.0
    idle = idle_motions(state.X, mechanics.structure.free, held_forces, blur)
    step = np.zeros_like(state.X)
    if len(K) == idle.shape[1]:
        return None, 0.0, step
    unsure = doubt(K, state)
    stiffest = norm(K)
    K -= idle @ (idle.T @ K)
    K -= (K @ idle) @ idle.T
    K += stiffest * (idle @ idle.T)
    values, vectors = np.linalg.eigh(K)
    sure = np.abs(values) > unsure
    along = vectors[:, sure]
    step.reshape(-1)[mechanics.dofs] = along @ (
        (along.T @ state.free_eta.reshape(-1)[mechanics.dofs]) / values[sure]
    )
    return float(values[0]), unsure, step


def _is_settled(state: State, softest: float) -> bool:
    """Return whether the exact equilibrium near by has a softest stiffness of the same sign."""
    change = float(state.mechanics.nodal_stiffness.max()) / shortest(state)
    return softest * softest > SETTLED * change * norm(state.free_eta)


def resisting_stiffness(state: State, floor: float) -> np.ndarray:
    """Return (b,) stiffnesses, zero for slack cables and those whose force is within rounding of none."""
    idle = state.mechanics.structure.tension_only & (state.t <= VANISHED * floor)
    return np.where(idle, 0.0, state.active_stiffness)


def is_super_stable(state: State, threshold: float) -> bool:
    """Return whether the stress alone makes the shape stable, whatever the stiffness (Connelly 1982).

    D is positive semidefinite and has no null vectors but the affine motions: n_D is d + 1, or one more
    than the dimension of the affine span of a flat structure. With supports, D acts on the free directions
    and the affine motions are those that the supports allow; loads may resist some of them. The structure
    is prestressed: without forces D is rounding error. threshold: the force density taken for zero.
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
    positive = int((values > threshold).sum())
    return positive > 0 and bool(values[0] >= -threshold) and len(values) - positive <= motions


def _affine_coordinates(X: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis (n, r) of the affine functions of the node positions."""
    Y = X - X.mean(axis=0)
    spanned = np.concatenate((np.ones((len(X), 1)), Y / (np.abs(Y).max() or 1.0)), axis=1)
    left, values, _ = np.linalg.svd(spanned, full_matrices=False)
    return left[:, values > 1e-9 * values[0]]
