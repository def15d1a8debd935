"""Stable or not: the sign of the tangent stiffness on the complement of the idle rigid motions."""

from math import sqrt
from typing import Any

import numpy as np

from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.equilibrium import force_density_matrix
from cgff_cli.mechanics.signs import MOST_REFINEMENTS, SETTLED, Spectrum, shortest
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.stopping import VANISHED


def stability(state: State, floor: float) -> dict[str, Any]:
    """Return whether a balanced state is a strict minimum of the energy, apart from rigid motions.

    stability: "stable", "unstable", or "neutral" where the softest deformation has no stiffness beyond what
    rounding explains; smallest_stiffness: that stiffness, force per length. It is a statement about the
    equilibrium, not about how closely it was solved for: where the remaining residual could matter, a few
    Newton steps on a copy bring it down to rounding first. Rigid motions that turn a load or a reaction
    count: a pendulum is stable hanging and unstable upright. A cable whose force is within rounding (floor)
    of none resists nothing: it may be shortened for free.
    """
    found = Spectrum(state, resists(state, floor), floor)
    for _ in range(MOST_REFINEMENTS):
        if _is_settled(state, found) or state.norm <= floor:
            break
        there = min((state.mechanics.at(state.X + s) for s in found.newton_steps()), key=lambda s: s.norm)
        if not there.norm < state.norm:
            break
        state = there
        found = Spectrum(state, resists(state, floor), floor)
    softest = float(found.values[0]) if found.count else None
    return told(_kind(found), state, floor) | {
        "smallest_stiffness": None if softest is None else softest * state.mechanics.frame.stiffness
    }


def _kind(found: Spectrum) -> str:
    softest = float(found.values[0]) if found.count else float("inf")
    if softest < -found.doubt:
        return "unstable"
    return "stable" if softest > found.doubt and found.is_sure else "neutral"


def told(kind: str, state: State, floor: float) -> dict[str, Any]:
    """Return `stable` and `stability`; null where a state so far from balance leaves the sign in doubt."""
    if kind == "neutral" and state.norm > VANISHED * floor * sqrt(state.X.shape[1]):
        return {"stable": None, "stability": None}
    return {"stable": kind == "stable", "stability": kind}


def _is_settled(state: State, found: Spectrum) -> bool:
    """Return whether the exact equilibrium near by has the same idle motions and sign of its softest."""
    if not found.is_sure or not found.count:
        return found.is_sure
    change, softest = float(state.mechanics.nodal_stiffness.max()) / shortest(state), float(found.values[0])
    return softest * softest > SETTLED * change * state.norm


def resists(state: State, floor: float) -> np.ndarray:
    """Return (b,) bool: not slack, nor a cable whose force is within rounding of none."""
    m = state.mechanics
    may_slacken = m.structure.tension_only & (m.l0 > 0.0)
    return state.taut & ~(may_slacken & (state.t <= VANISHED * floor))


def is_super_stable(state: State, threshold: float) -> bool:
    """Return whether the stress alone makes the shape stable, whatever the stiffness (Connelly 1982).

    D is positive semidefinite and has no null vectors but the affine motions: n_D is d + 1, or one more
    than the dimension of the affine span of a flat structure. With supports, D acts on the free directions
    and the affine motions are those that the supports allow; loads may resist some of them. The structure
    is prestressed: without forces D is rounding error. threshold: the force density taken for zero.
    """
    structure = state.mechanics.structure
    n, d = structure.coordinates.shape
    D = force_density_matrix(dense(structure.start, structure.end, n), state.q)
    affine = _affine_coordinates(state.mechanics.everywhere(state.X).T)
    motions = affine.shape[1]
    if not state.mechanics.all_free:
        free = structure.free.T.reshape(-1)
        D = np.kron(np.eye(d), D)[np.ix_(free, free)]
        held = np.kron(np.eye(d), affine)[~free]
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
