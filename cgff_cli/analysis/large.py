"""Stability of scenes too large for eigenvalues: by inertia, or by what a structure of cables cannot do."""

from typing import Any

import numpy as np

from cgff_cli.analysis.stability import MOST_REFINEMENTS, resists, told
from cgff_cli.mechanics.rigid import rigid_motions
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.preconditioners.sparse import SparseTangent


def stability_of_large(state: State, kind: str, floor: float) -> dict[str, Any]:
    """Return `stable` and `stability` of a balanced state, null where a rigid motion may be all that is soft.

    Cables alone: K is at least D, axis by axis, so that all is stable that taut cables tie to a support.
    kind: the sparse factors to use, as in the solve option `factor`; floor: the rounding error of forces.
    """
    structure = state.mechanics.structure
    taut = resists(state, floor)
    if structure.tension_only.all() and state.mechanics.mask is None:
        return told("stable" if _is_all_tied(state, taut) else "neutral", state, float("inf"))
    tangent = SparseTangent(state.mechanics, False, kind)
    found = _inertia(tangent, state, taut)
    for _ in range(MOST_REFINEMENTS):
        there = _refined(tangent, state) if found == "neutral" and state.norm > floor else state
        if there is state:
            break
        state = there
        found = _inertia(tangent, state, taut)
    if found == "neutral" and not _is_settled(state):
        return {"stable": None, "stability": None}
    return told(found, state, floor)


def _inertia(tangent: SparseTangent, state: State, taut: np.ndarray) -> str:
    """Return "stable", "unstable" or "neutral": whether K less its doubt, or with it, is positive definite.

    The rigid motions of a floating body are pinned; others that supports allow may be what is neutral.
    """
    doubt = tangent.doubt(state)
    if tangent.definite(state, -doubt, taut) is not None:
        return "stable"
    return "neutral" if tangent.definite(state, doubt, taut) is not None else "unstable"


def _refined(tangent: SparseTangent, state: State) -> State:
    """Return the state after a Newton step, or itself where K is indefinite or the step gains nothing."""
    solve = tangent.system(state.parts(), 0.0)
    if solve is None:
        return state
    there = state.mechanics.at(state.X - solve(state.g))
    return there if there.norm < state.norm else state


def _is_settled(state: State) -> bool:
    """Return whether rigid motions are either all idle, and pinned, or all impossible."""
    mechanics = state.mechanics
    if mechanics.all_free:
        return mechanics.F is None
    return rigid_motions(mechanics.everywhere(state.X), mechanics.structure.free.T).shape[1] == 0


def _is_all_tied(state: State, taut: np.ndarray) -> bool:
    """Return whether taut cables, (b,) bool, tie every free node to one that is held."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    structure = state.mechanics.structure
    n = len(structure.coordinates)
    ends = structure.start[taut], structure.end[taut]
    joined = coo_array((np.ones(len(ends[0])), ends), shape=(n, n))
    parts, label = connected_components(joined, directed=False)
    held = ~structure.free.any(axis=1)
    return bool(np.bincount(label[held], minlength=parts).all())
