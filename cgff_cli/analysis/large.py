"""Stability of scenes too large for eigenvalues: by inertia, or by what a structure of cables cannot do."""

from typing import Any

import numpy as np

from cgff_cli.analysis.stability import MOST_REFINEMENTS, resisting_stiffness, told
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.rigid import rigid_motions
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.preconditioners.sparse import SparseTangent


def stability_of_large(state: State, kind: str, floor: float) -> dict[str, Any]:
    """Return `stable` and `stability` of a balanced state, null where a rigid motion may be all that is soft.

    Cables alone: K is at least D, axis by axis, so that all is stable that taut cables tie to a support.
    kind: the sparse factors to use, as in the solve option `factor`; floor: the rounding error of forces.
    """
    structure = state.mechanics.structure
    k = resisting_stiffness(state, floor)
    if structure.tension_only.all() and not _is_partly_held(structure.free):
        return told("stable" if _is_all_tied(state, k > 0.0) else "neutral", state, float("inf"))
    tangent = SparseTangent(state.mechanics, False, kind)
    found = tangent.kind_of_balance(state, k)
    for _ in range(MOST_REFINEMENTS):
        there = tangent.refined(state) if found == "neutral" and norm(state.free_eta) > floor else state
        if there is state:
            break
        state = there
        found = tangent.kind_of_balance(state, k)
    if found == "neutral" and not _is_settled(state):
        return {"stable": None, "stability": None}
    return told(found, state, floor)


def _is_settled(state: State) -> bool:
    """Return whether rigid motions are either all idle, and pinned, or all impossible."""
    mechanics = state.mechanics
    if mechanics.all_free:
        return not mechanics.has_loads
    return rigid_motions(state.X, mechanics.structure.free).shape[1] == 0


def _is_partly_held(free: np.ndarray) -> bool:
    """Return whether any node is held in some directions and free in others."""
    return bool(np.any(free.any(axis=1) != free.all(axis=1)))


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
