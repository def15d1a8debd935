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

MOST_REFINEMENTS = 3
"""Newton steps that bring forces left over down to rounding before signs are told."""

SETTLED = 8.0
"""Kantorovich: where K changes by at most L per length, a smallest stiffness s with s^2 > 8 L |eta| keeps
its sign on the way to the exact equilibrium, with room to spare (2 would do)."""


def blurred(K: np.ndarray, state: State) -> float:
    """Return the size below which rounding leaves an eigenvalue of K no sign, were the forces in balance."""
    m, reach = state.mechanics, float(np.abs(state.X).max(initial=0.0))
    own = m.k * (state.taut & (m.l0 > 0.0)) * (1.0 + (reach + np.abs(state.e)) / state.l)
    return BLUR * sqrt(len(K)) * norm(K) + 4.0 * EPS * float(own.max())


def shortest(state: State) -> float:
    """Return the least length of an element whose force density depends on its length; infinity for none."""
    sure = (state.mechanics.l0 > 0.0) & state.taut & (state.stretch > -state.mechanics.l0)
    return float(state.l.min(initial=float("inf"), where=sure))


def is_positive(K: np.ndarray, shift: float | np.ndarray = 0.0) -> bool:
    """Return whether K and a shift of its diagonal, which it keeps, has a Cholesky factor."""
    K.reshape(-1)[:: len(K) + 1] += shift
    try:
        np.linalg.cholesky(K)
    except np.linalg.LinAlgError:
        return False
    return True


def steepest_fall(state: State) -> np.ndarray | None:
    """Return the unit (d, m) direction of most negative stiffness, or None if there is none.

    A Cholesky factor of K and a little more is the quick way to see that there is none. What forces out of
    balance blur counts for negative: whether the energy falls that way is seen by going there.
    """
    K = state.dense_tangent()
    if is_positive(K, BLUR * sqrt(len(K)) * norm(K)):
        return None
    values, vectors = np.linalg.eigh(K)
    if values[0] >= -blurred(K, state):
        return None
    d = vectors[:, 0]
    return (d * np.sign(d[np.abs(d).argmax()])).reshape(state.X.shape)


class Spectrum:
    """Stiffnesses apart from idle rigid motions, ascending, and what of them is told.

    values : (c,) eigenvalues of K; none where nothing but idle motions can happen
    blurred, doubt : the size that rounding hides, and the size that has no sign
    is_sure        : whether rounding alone, not what is left of the forces, decides which motions are idle
    """

    def __init__(self, state: State, taut: np.ndarray, floor: float):
        """taut: (b,) bool, elements that resist; floor: rounding error of reactions."""
        mechanics = state.mechanics
        self.state, free = state, mechanics.structure.free.T
        K = state.dense_tangent(taut=taut)
        if mechanics.mask is not None:
            K = K[np.ix_(mechanics.dofs, mechanics.dofs)]
        self.blurred = blurred(K, state)
        self.doubt = self.blurred + 4.0 * state.norm / shortest(state)
        outer = mechanics.structure.loads.T / mechanics.frame.force
        if not mechanics.all_free:
            outer = np.where(free, outer, state.pull().T)
        everywhere, blur = (
            mechanics.everywhere(state.X),
            0.0 if mechanics.mask is None else state.norm + floor,
        )
        idle = idle_motions(everywhere, free, outer, blur)
        self.is_sure = idle.shape[1] in (0, idle_motions(everywhere, free, outer, min(blur, floor)).shape[1])
        stiffest = norm(K)
        K -= idle @ (idle.T @ K)
        K -= (K @ idle) @ idle.T
        K += 2.0 * stiffest * (idle @ idle.T)
        self.K, self.count = K, len(K) - idle.shape[1]
        self.values = np.linalg.eigvalsh(K)[: self.count]

    def newton_steps(self) -> list[np.ndarray]:
        """Return Newton steps, (d, m), along all that has stiffness beyond rounding, and beyond doubt."""
        values, vectors = np.linalg.eigh(self.K)
        dofs, steps = self.state.mechanics.dofs, []
        for least in (self.blurred, self.doubt):
            sure = np.abs(values[: self.count]) > least
            along = vectors[:, : self.count][:, sure]
            step = np.zeros(self.state.X.size)
            step[dofs] = -along @ ((along.T @ self.state.g.reshape(-1)[dofs]) / values[: self.count][sure])
            steps.append(step.reshape(self.state.X.shape))
        return steps
