"""The signs of the tangent stiffness: its least value apart from idle motions, and where it falls most.

Dense; for small structures. Positive and negative mean beyond doubt: rounding blurs K, and a force density
is known no better than the residual and its element's own rounding allow, over its length.
"""

from math import sqrt

import numpy as np

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.rigid import idle_motions
from cgff_cli.mechanics.state import State

BLUR = 1e-14
"""Rounding error of an eigenvalue over the norm of its matrix and the root of its size, with some room."""


def doubt(K: np.ndarray, state: State) -> float:
    """Return the size below which an eigenvalue of K has no sign."""
    m, reach = state.mechanics, float(np.abs(state.X).max(initial=0.0))
    blurred = m.k * (state.taut & (m.l0 > 0.0)) * (1.0 + (reach + np.abs(state.e)) / state.l)
    return BLUR * sqrt(len(K)) * norm(K) + 4.0 * (state.norm / shortest(state) + EPS * float(blurred.max()))


def shortest(state: State) -> float:
    """Return the least length of an element whose force density depends on its length; infinity for none."""
    sure = (state.mechanics.l0 > 0.0) & state.taut & (state.stretch > -state.mechanics.l0)
    return float(state.l.min(initial=float("inf"), where=sure))


def steepest_fall(state: State) -> np.ndarray | None:
    """Return the unit (d, m) direction of most negative stiffness, or None if there is none.

    A Cholesky factor of K and a little more is the quick way to see that there is none.
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
    d = vectors[:, 0]
    return (d * np.sign(d[np.abs(d).argmax()])).reshape(state.X.shape)


def spectrum(state: State, taut: np.ndarray, blur: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Return eigenvalues of K apart from idle rigid motions, their vectors, and the size that has no sign.

    (c,) ascending; (d m, c), zero in held directions. taut: (b,) bool, elements that resist; blur: error
    of reactions. No eigenvalues are left where nothing but idle motions can happen.
    """
    mechanics = state.mechanics
    dofs, free = mechanics.dofs, mechanics.structure.free.T
    K = state.dense_tangent(taut=taut)[np.ix_(dofs, dofs)]
    unsure = doubt(K, state)
    outer = mechanics.structure.loads.T / mechanics.frame.force
    outer = np.where(free, outer, state.pull().T)
    idle = idle_motions(mechanics.everywhere(state.X), free, outer, blur)
    stiffest = norm(K)
    K -= idle @ (idle.T @ K)
    K -= (K @ idle) @ idle.T
    K += 2.0 * stiffest * (idle @ idle.T)
    values, vectors = np.linalg.eigh(K)
    kept = len(K) - idle.shape[1]
    full = np.zeros((state.X.size, kept))
    full[dofs] = vectors[:, :kept]
    return values[:kept], full, unsure
