"""The least value of a convex quadratic form between linear bounds, by an interior point method.

Unlike a simplex method it ends at no vertex: where the least form is unique, so is the answer, in whatever
order rows and columns come.
"""

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from cgff_cli.mechanics.norms import largest

MOST_NEWTON_STEPS = 100
GAP = 1e-18
"""Mean product of slack and multiplier, in units of the problem, at which bounds are met or are not."""

LEFT_OVER = 1e-9
"""What may be left over of the equations."""

SHORT_OF = 0.995
"""Share of the way to the boundary that a step goes at most."""

NOTHING = np.zeros(0)

Solver = Callable[[np.ndarray], np.ndarray]


def least(
    Q: Any,
    g: np.ndarray,
    G: Any,
    h: np.ndarray,
    A: Any = None,
    f: np.ndarray = NOTHING,
    factor: Callable[[np.ndarray], Solver] | None = None,
) -> np.ndarray:
    """Return the x that makes x Q x / 2 + g x least where G x >= h and A x = f.

    Mehrotra's predictor and corrector (SIAM J. Optim. 2, 1992). factor: of weights w, returns what solves
    with [[Q + G^T diag(w) G, A^T], [A, 0]]; without A, Cholesky's factor by default.
    """
    factor = factor or partial(_cholesky, Q, G)
    x, y, z = np.zeros(len(g)), np.zeros(len(f)), np.ones(len(h))
    s = np.maximum(1.0, G @ x - h)
    for _ in range(MOST_NEWTON_STEPS):
        dual = Q @ x + g - G.T @ z - (A.T @ y if len(f) else 0.0)
        out = _Out(dual, G @ x - h - s, A @ x - f if len(f) else f)
        gap = float(s @ z) / len(s)
        if gap < GAP and max(map(largest, out)) < LEFT_OVER:
            break
        try:
            solve = factor(z / s)
        except (np.linalg.LinAlgError, RuntimeError):  # as far as doubles go
            break
        _, _, ds, dz = _step(solve, out, G, s, z, s * z)
        reach = min(1.0, _room(s, ds), _room(z, dz))
        left = float((s + reach * ds) @ (z + reach * dz)) / len(s)
        dx, dy, ds, dz = _step(solve, out, G, s, z, s * z + ds * dz - (left / gap) ** 3 * gap)
        reach = min(1.0, SHORT_OF * min(_room(s, ds), _room(z, dz)))
        x, y, s, z = x + reach * dx, y + reach * dy, s + reach * ds, z + reach * dz
    return x


class _Out(NamedTuple):
    """What is left over: of the gradient, of G x - h - s = 0 and of A x - f = 0."""

    dual: np.ndarray
    primal: np.ndarray
    equal: np.ndarray


def _step(
    solve: Solver, out: _Out, G: Any, s: np.ndarray, z: np.ndarray, product: np.ndarray
) -> tuple[np.ndarray, ...]:
    """Return the Newton step that takes what is left over to zero, and s z down by `product`."""
    n = len(out.dual)
    both = solve(np.concatenate((-out.dual - G.T @ ((product + z * out.primal) / s), -out.equal)))
    ds = G @ both[:n] + out.primal
    return both[:n], -both[n:], ds, -(product + z * ds) / s


def _room(values: np.ndarray, change: np.ndarray) -> float:
    """Return how many times a change may be added before a positive value is zero."""
    falls = change < 0.0
    return float((values[falls] / -change[falls]).min(initial=np.inf))


def _cholesky(Q: np.ndarray, G: np.ndarray, weights: np.ndarray) -> Solver:
    """Return what solves with Q + G^T diag(weights) G."""
    L = np.linalg.cholesky(Q + (G.T * weights) @ G)
    return lambda right: np.linalg.solve(L.T, np.linalg.solve(L, right))
