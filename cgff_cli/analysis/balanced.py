"""Which of many states: the one whose least member is the greatest, and of these the one of least norm."""

from collections.abc import Iterator
from functools import partial
from typing import Any

import numpy as np

from cgff_cli.analysis.interior import Solver, least
from cgff_cli.analysis.nulls import shifted_factor
from cgff_cli.analysis.self_stress import SelfStress
from cgff_cli.mechanics.norms import norm

LIGHT = 1e-5
"""Weight of the norm beside the least member: small enough to decide between equals alone
(tests/studies/prestress.py)."""


PIVOT = 1e-13
"""Shift, beside a diagonal of 1, that lets equations that depend on each other have a factor."""


def balanced(
    balance: SelfStress, signs: np.ndarray, most: np.ndarray, counted: np.ndarray | None = None
) -> np.ndarray:
    """Return the x, A x = F, that makes its least member as great as can be; of many, that of least norm.

    The value v that members of a class share (x over its size) is what is compared: maximise s subject to
    signs v >= s and signs v <= most; then the sum of v^2 over members decides. The answer hangs on no order
    of nodes and elements, and has whatever symmetry the structure has. signs: (m,) 1 or -1; most: (m,),
    infinity for no bound; counted: (m,) bool, of which classes s is the least, the others at least 0.
    """
    first = balance.bearing
    top = float(most[np.isfinite(most)].max())
    unit = balance.size * top  # x = unit v
    least_of = np.ones(len(signs)) if counted is None else counted.astype(float)
    if balance.is_dense:
        N, offset = balance.basis / unit[:, None], first / unit
        return first + balance.basis @ _dense(N, offset, signs, most / top, balance.count, least_of)
    v = _sparse(balance, unit, signs, most / top, least_of)
    return balance.nearest(v * unit, balance.F)


def least_limit(balance: SelfStress, signs: np.ndarray, most: np.ndarray) -> float | None:
    """Return the least c with which signs v >= 0 and signs v <= c most bear the loads; None: no c does."""
    from scipy.optimize import linprog
    from scipy.sparse import block_array, csc_array, diags_array

    solve: Any = linprog  # whose types know no sparse matrix
    bounded, scale = np.isfinite(most), float(most[np.isfinite(most)].max())
    own, size = diags_array(signs).tocsr()[bounded], norm(balance.F)
    nothing = np.zeros(own.shape[0])
    for columns, right in _equations(balance):
        more = columns.shape[1] - len(signs)
        top = csc_array(-most[bounded, None] / scale)
        upper = block_array([[own, csc_array((len(nothing), more)), top]], format="csr")
        equal = block_array([[columns, csc_array((len(right), 1))]], format="csc")
        bounds: list[Any] = [(0.0, None) if sign > 0.0 else (None, 0.0) for sign in signs]
        bounds += [(None, None)] * more + [(0.0, None)]
        cost = np.append(np.zeros(columns.shape[1]), 1.0)
        found = solve(cost, upper, nothing, equal, right / size, bounds, method="highs")
        if found.x is not None:
            return float(found.fun) * size / scale
    return None


def _equations(balance: SelfStress) -> Iterator[tuple[Any, np.ndarray]]:
    """Yield columns and right sides of what v, x over its size, is to meet: A x = F solved, and as it is.

    Solved, where the tolerance counts F as borne, v is the nearest to A x = F plus states, whose shares are
    further unknowns. Of A x = F itself HiGHS leaves 1e-7 over, which is much of a v that is softly held, and
    calls it impossible where there are more equations than unknowns and F is borne but for rounding.
    """
    from scipy.sparse import csc_array, diags_array, eye_array, hstack

    first = balance.bearing
    if balance.left_over(first) <= balance.tolerance and (balance.is_dense or balance.states == 0):
        states = [csc_array(-balance.basis / balance.size[:, None])] if balance.is_dense else []
        yield hstack([eye_array(len(first)), *states], format="csc"), first / balance.size
    yield csc_array(balance.A) @ diags_array(balance.size), balance.F


def most_of(balance: SelfStress, signs: np.ndarray, most: np.ndarray, asked: np.ndarray) -> np.ndarray:
    """Return an x, no sign wrong, in which a class asked for exceeds `most`, or comes nearest to it."""
    from scipy.optimize import linprog

    solve: Any = linprog  # whose types know no sparse matrix
    unit, m = float(most[asked].max()), len(signs)
    tops = np.where(asked, 2.0 * most / unit, np.inf)
    bounds = [(0.0, top) if sign > 0.0 else (-top, 0.0) for sign, top in zip(signs, tops, strict=True)]
    best, reached = np.zeros(m), -1.0
    for columns, right in _equations(balance):
        own = [*bounds, *[(None, None)] * (columns.shape[1] - m)]
        for row in np.flatnonzero(asked):
            cost = np.where(np.arange(len(own)) == row, -signs[row], 0.0)
            found = solve(cost, A_eq=columns, b_eq=right / unit, bounds=own, method="highs").x
            if found is not None and abs(found[row]) * unit / most[row] > reached:
                best, reached = found[:m], abs(found[row]) * unit / most[row]
            if reached >= 1.0 + TOLD_BY_HIGHS:
                break
        if reached >= 0.0:
            break
    return balance.nearest(best * unit * balance.size, balance.F)


TOLD_BY_HIGHS = 1e-6
"""What the bounds and equations of HiGHS leave open, and more."""


def _dense(
    N: np.ndarray,
    offset: np.ndarray,
    signs: np.ndarray,
    most: np.ndarray,
    count: np.ndarray,
    least_of: np.ndarray,
) -> np.ndarray:
    """Return the z of v = offset + N z that is best, (k,)."""
    k, light = N.shape[1], LIGHT / count.sum()
    scale = np.linalg.norm(N, axis=0)
    N = N / scale
    W, w, bounded = signs[:, None] * N, signs * offset, np.isfinite(most)
    Q = np.zeros((k + 1, k + 1))
    Q[:k, :k] = light * (N.T * count) @ N
    g = np.append(light * N.T @ (count * offset), -1.0)
    above = np.concatenate((W, -least_of[:, None]), axis=1)
    below = np.concatenate((-W[bounded], np.zeros((int(bounded.sum()), 1))), axis=1)
    h = np.concatenate((-w, (w - most)[bounded]))
    return least(Q, g, np.concatenate((above, below)), h)[:k] / scale


def _sparse(
    balance: SelfStress, unit: np.ndarray, signs: np.ndarray, most: np.ndarray, least_of: np.ndarray
) -> np.ndarray:
    """Return the best v of a sparse A, (m,)."""
    from scipy.sparse import block_array, csc_array, diags_array

    m, bounded = len(signs), np.isfinite(most)
    own = diags_array(signs).tocsr()
    G = block_array([[own, csc_array(-least_of[:, None])], [-own[bounded], None]], format="csr")
    h = np.concatenate((np.zeros(m), -most[bounded]))
    Q = diags_array(np.append(LIGHT / balance.count.sum() * balance.count, 0.0)).tocsc()
    columns = balance.A @ diags_array(unit)
    F = balance.F / float(np.abs(columns.data).max())
    columns = (columns / float(np.abs(columns.data).max())).tocsc()
    A = block_array([[columns, csc_array((len(balance.F), 1))]], format="csc")
    factor = partial(_bordered, columns, Q.diagonal()[:m], signs * least_of, bounded)
    return least(Q, np.append(np.zeros(m), -1.0), G, h, A, F, factor)[:m]


def _bordered(
    A: Any, own: np.ndarray, shared: np.ndarray, bounded: np.ndarray, weights: np.ndarray
) -> Solver:
    """Return what solves [[H, A^T], [A, 0]] for unknowns v and s: H is diagonal but for the column of s.

    v is eliminated, s kept apart; A H^-1 A^T is scaled to a diagonal of 1.
    """
    from scipy.sparse import diags_array

    m, low = len(shared), weights[: len(shared)]
    high = np.zeros(m)
    high[bounded] = weights[m:]
    H, column = own + low + high, -shared * low
    S = A @ diags_array(1.0 / H) @ A.T
    diagonal = S.diagonal()
    scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
    lu = shifted_factor(diags_array(scale) @ S @ diags_array(scale), PIVOT)

    def inner(right: np.ndarray, below: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return v and y of [[H, A^T], [A, 0]] [v, y] = [right, below]."""
        y = scale * lu.solve(scale * (A @ (right / H) - below))
        return (right - A.T @ y) / H, y

    along, y_along = inner(column, np.zeros(A.shape[0]))
    rest = float((shared**2 * low * (own + high) / H).sum()) + float((A.T @ y_along) @ (column / H))

    def solve(right: np.ndarray) -> np.ndarray:
        """Return v, s and y."""
        v, y = inner(right[:m], right[m + 1 :])
        s = (right[m] - column @ v) / rest
        return np.concatenate((v - s * along, [s], y - s * y_along))

    return solve
