"""Ways out of balance that is no minimum: starts that coincide, and directions of negative stiffness."""

from math import sqrt

import numpy as np

from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.objectives import Line
from cgff_cli.structure import Structure

COINCIDENT = 1e-9
"""A strut shorter than this share of the structure's size has no direction to push in."""

NUDGE = 1e-4
"""Size of the seeded perturbation that gives it one."""


def separated(structure: Structure, seed: int) -> tuple[np.ndarray, str | None]:
    """Return start coordinates in which no strut has zero length, and a warning if any had.

    A strut with coincident ends pushes in no direction: its free nodes are moved by a tiny perturbation
    drawn from `seed`. The structure is in units of its own size.
    """
    X = structure.coordinates
    V = X[structure.start] - X[structure.end]
    short = ~structure.tension_only & (structure.rest_lengths > 0.0) & (np.abs(V).max(axis=1) < COINCIDENT)
    if not short.any():
        return X, None
    nodes = np.unique(np.concatenate((structure.start[short], structure.end[short])))
    moved = np.zeros_like(X)
    moved[nodes] = NUDGE * np.random.default_rng(seed).uniform(-1.0, 1.0, (len(nodes), X.shape[1]))
    moved[~structure.free] = 0.0
    count = int(short.sum())
    return X + moved, (
        f"{count} strut{'s' if count > 1 else ''} of zero length at the start: "
        f"moved the nodes by a perturbation of {NUDGE:g} of the size, seed {seed}"
    )


def doubt(K: np.ndarray, state: State) -> float:
    """Return the size below which an eigenvalue of K has no sign.

    Rounding blurs it, and a force density is known no better than the residual and the element's own
    rounding allow, over its length.
    """
    blurred = float((state.active_stiffness * state.rounding).max())
    return 1e-14 * sqrt(len(K)) * norm(K) + 4.0 * (norm(state.free_eta) + blurred) / shortest(state)


def shortest(state: State) -> float:
    """Return the least length of an element whose force density depends on its length; infinity for none."""
    structure = state.mechanics.structure
    sure = (structure.rest_lengths > 0.0) & (state.l > 0.0) & ~state.slack
    return float(state.l.min(initial=float("inf"), where=sure))


def steepest_fall(state: State) -> np.ndarray | None:
    """Return the unit (n, d) direction of most negative stiffness, or None if there is none.

    Negative means beyond doubt. Dense; for small structures.
    """
    K = state.dense_tangent()
    unsure = doubt(K, state)
    diagonal = K.reshape(-1)[:: len(K) + 1]
    diagonal += unsure
    try:
        np.linalg.cholesky(K)
    except np.linalg.LinAlgError:
        diagonal -= unsure
    else:
        return None
    values, vectors = np.linalg.eigh(K)
    if values[0] >= -unsure:
        return None
    direction = np.zeros(state.X.size)
    direction[state.mechanics.dofs] = vectors[:, 0] * np.sign(vectors[np.abs(vectors[:, 0]).argmax(), 0])
    return direction.reshape(state.X.shape)


FIRST_FALLS = (1e-3, 1e-4, 1e-5, 1e-6)
"""First steps to try away from an unstable equilibrium: a stiff element beside it hides longer falls."""


def farthest_fall(line: Line) -> float:
    """Return the step along a direction of negative curvature, of either sign, that falls most; 0 if none."""
    return next((step for first in FIRST_FALLS if (step := _fall_from(line, first)) != 0.0), 0.0)


def _fall_from(line: Line, first: float) -> float:
    """Return the step that falls most, growing fourfold from `first` while the objective keeps falling."""
    best, best_change = 0.0, 0.0
    for sign in (1.0, -1.0):
        a = sign * first
        last = 0.0
        while (trial := line(a)).change < last and abs(a) < 1e3:
            if trial.change < best_change:
                best, best_change = a, trial.change
            last = trial.change
            a *= 4.0
    return best
