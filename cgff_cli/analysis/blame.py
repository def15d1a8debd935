"""Why no state has the right signs: the members that can never carry theirs, and a motion that proves it.

In virtual work along a motion y the forces of a state do none: sum of t_e times the rate at which y lengthens
e, which is U^T y. A motion that shortens no cable, lengthens no strut, and does lengthen some cables or
shorten some struts, so forbids these any force of their sign (Stiemke's lemma). Loads F count as one member
more, with the rate -F y (Farkas' lemma): a motion against which loads do work while no member resists.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from cgff_cli.analysis.ranks import LEAST_TOLERANCE
from cgff_cli.analysis.self_stress import SelfStress
from cgff_cli.mechanics.norms import largest, norm

PROVEN = 1e-9
"""What rounding may leave of a rate that is to be zero, over the greatest rate."""


class Blame(NamedTuple):
    """never: (m,) bool, what can never carry its sign; loads: whether they can never be borne;
    motion: (f,) the motion that proves it, greatest component 1; proven: whether arithmetic bears it out."""

    never: np.ndarray
    loads: bool
    motion: np.ndarray
    proven: bool


def blamed(balance: SelfStress, signs: np.ndarray) -> Blame:
    """Return all that can never carry its sign, found with the motion that lengthens the most of them."""
    A, own, m = balance.A, signs, len(signs)
    if balance.is_loaded:
        F = -balance.F[:, None] / norm(balance.F)
        A, own = _beside(A, F), np.append(signs, 1.0)
    B, motion_of = _independent(A, balance.tolerance)
    blame = _widest(B, own)
    y = motion_of(_smallest(B, own, blame))
    rate = own * (A.T @ y)
    size = largest(rate)
    at_rest = largest(rate[~blame]) <= PROVEN * size
    proven = bool(size > 0.0 and at_rest and rate[blame].min(initial=np.inf) > PROVEN * size)
    return Blame(blame[:m], bool(blame[m:].any()), y / (largest(y) or 1.0), proven)


def _beside(A: Any, column: np.ndarray) -> Any:
    if isinstance(A, np.ndarray):
        return np.concatenate((A, column), axis=1)
    from scipy.sparse import csc_array, hstack

    return hstack([A, csc_array(column)]).tocsc()


def _independent(A: Any, tolerance: float) -> tuple[Any, Callable[[np.ndarray], np.ndarray]]:
    """Return A, and what makes motions of its rows; those that the tolerance counts as zero are left out."""
    if tolerance <= LEAST_TOLERANCE:
        return A, lambda y: y
    left, values, right = np.linalg.svd(A, full_matrices=False)
    kept = values > tolerance
    if not (values[~kept] > LEAST_TOLERANCE).any():
        return A, lambda y: y
    return right[kept], lambda y: left[:, kept] @ (y / values[kept])


def _widest(A: Any, signs: np.ndarray) -> np.ndarray:
    """Return (m,) bool: all that motions can lengthen against their signs while they shorten nothing.

    Such motions can be added and multiplied, so that one lengthens all that any of them does, by 1 or more.
    """
    from scipy.sparse import eye_array, hstack

    f, m = A.shape
    upper = hstack([_turned(A, -signs), eye_array(m)], format="csr")
    cost = np.concatenate((np.zeros(f), np.full(m, -1.0)))
    found = _solved(cost, upper, np.zeros(m), None, None, [(None, None)] * f + [(0.0, 1.0)] * m)
    return np.zeros(m, dtype=bool) if found is None else found[f:] > 0.5


def _smallest(A: Any, signs: np.ndarray, blame: np.ndarray) -> np.ndarray:
    """Return the motion (f,) of least greatest component that lengthens what is to blame by 1 or more."""
    from scipy.sparse import block_array, csr_array, eye_array, hstack

    f, far = A.shape[0], np.ones((A.shape[0], 1))
    least = _turned(A, -signs)[blame]
    upper = block_array(
        [[least, None], [eye_array(f), csr_array(-far)], [-eye_array(f), csr_array(-far)]], format="csr"
    )
    right = np.concatenate((np.full(least.shape[0], -1.0), np.zeros(2 * f)))
    still = hstack([_turned(A, signs)[~blame], csr_array((int((~blame).sum()), 1))], format="csr")
    cost = np.append(np.zeros(f), 1.0)
    found = _solved(cost, upper, right, still, np.zeros(still.shape[0]), [(None, None)] * f + [(0.0, None)])
    return np.zeros(f) if found is None else found[:f]


def _turned(A: Any, signs: np.ndarray) -> Any:
    """Return diag(signs) A^T, sparse."""
    from scipy.sparse import csr_array, diags_array

    turned: Any = diags_array(signs) @ csr_array(A.T)
    return turned


def _solved(cost: np.ndarray, upper: Any, u: Any, equal: Any, e: Any, bounds: Any) -> np.ndarray | None:
    from scipy.optimize import linprog

    solve: Any = linprog  # whose types know no sparse matrix
    x: np.ndarray | None = solve(cost, upper, u, equal, e, bounds, method="highs").x
    return x
