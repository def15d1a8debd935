"""The nearest shape that a state holds exactly, to coordinates that were rounded or measured."""

import numpy as np

from cgff_cli.analysis.self_stress import SelfStress
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import State
from cgff_cli.mechanics.tangent import Parts, stiffness_matrix

_LEAST = 1e-9  # of the greatest: what changes forces less by moving counts as moving nothing

MOST_CORRECTIONS = 20
AT_REST = 1e-14
"""What is left over, relative to the forces, at which no step can do better."""


def near_shape(balance: SelfStress, x: np.ndarray) -> tuple[SelfStress, np.ndarray]:
    """Return the balance at a shape near by, and the x near the one given that it holds.

    Newton's method on A(X) x = F with the least change of X, whatever the change of x: what A can balance at
    the shape as it is needs no other shape. balance: a dense one, its tolerance what counts as balanced.
    """
    scale = norm(x)
    best = (balance.left_over(x), balance, x)
    for _ in range(MOST_CORRECTIONS):
        if best[0] <= AT_REST:
            break
        left, values, right = (own[: balance.rank] for own in (balance.parts[0].T, *balance.parts[1:]))
        out = balance.A @ x - balance.F
        state = balance.state
        K = _stiffness(state, balance.forces(x), balance.equal_force)
        free = K - left.T @ (left @ K)
        step = np.linalg.lstsq(free, left.T @ (left @ out) - out, rcond=_LEAST)[0]
        x = x - right.T @ ((left @ (out + K @ step)) / values)
        X = state.X.reshape(-1).copy()
        X[state.mechanics.dofs] += step
        balance, x = balance.moved(state.mechanics.at(X.reshape(state.X.shape)), x)
        if not balance.F.any():
            x *= scale / norm(x)
        left_over = balance.left_over(x)
        if not left_over < 0.5 * best[0]:
            break
        best = (left_over, balance, x)
    return best[1], best[2]


def _stiffness(state: State, t: np.ndarray, equal_force: bool) -> np.ndarray:
    """Return how forces out of balance change with places, (f, f): at force densities kept, or at forces."""
    m, q = state.mechanics, t / state.l
    w = -q / state.l**2 if equal_force else np.zeros_like(q)
    K = stiffness_matrix(m.connectivity, Parts(state.X, state.V, w, q), None)
    return K[np.ix_(m.dofs, m.dofs)]
