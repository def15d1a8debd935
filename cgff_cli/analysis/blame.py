"""Why no state has the right signs: the members that can never carry theirs, and a motion that proves it.

In virtual work along a motion y the forces of a state do none: sum of t_e times the rate at which y lengthens
e, which is U^T y. A motion that shortens no cable, lengthens no strut, and does lengthen some cables or
shorten some struts, so forbids these any force of their sign (Stiemke's lemma). Loads F count as one member
more, with the rate -F y (Farkas' lemma): a motion against which loads do work while no member resists.
"""

from typing import Any, NamedTuple

import numpy as np

from cgff_cli.analysis.ranks import LEAST_TOLERANCE
from cgff_cli.analysis.self_stress import SelfStress
from cgff_cli.mechanics.norms import largest, norm

PROVEN = 1e-9
"""What rounding may leave of a rate that is to be zero, over the greatest rate."""


TINIEST = 1e-11
"""Entry of a unit column that counts as none in the linear program; the check of its answer knows all."""


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
    whole, A = A, _kept(A, balance.tolerance)
    y = _widest(A.T, own)
    blame = own * (A.T @ y) > 0.5
    y = _still(A, y, ~blame)
    if A is not whole:  # what moves along with it to no effect would have one on the whole
        y = A @ np.linalg.lstsq(A, y, rcond=PROVEN)[0]
    rate = own * (whole.T @ y)
    size = largest(rate)
    at_rest = largest(rate[~blame]) <= PROVEN * size
    proven = bool(size > 0.0 and at_rest and rate[blame].min(initial=np.inf) > PROVEN * size)
    return Blame(blame[:m], bool(blame[m:].any()), y / (largest(y) or 1.0), proven)


def _beside(A: Any, column: np.ndarray) -> Any:
    if isinstance(A, np.ndarray):
        return np.concatenate((A, column), axis=1)
    from scipy.sparse import csc_array, hstack

    return hstack([A, csc_array(column)]).tocsc()


def _kept(A: Any, tolerance: float) -> Any:
    """Return A without what counts as zero: what is left lengthens nothing by less than the tolerance."""
    if tolerance <= LEAST_TOLERANCE:
        return A
    left, values, right = np.linalg.svd(A, full_matrices=False)
    return left * np.where(values > tolerance, values, 0.0) @ right


def _widest(rates: Any, signs: np.ndarray) -> np.ndarray:
    """Return the motion that lengthens as many as can be, by 1 or more each, and shortens none.

    Such motions can be added and multiplied, so that one lengthens all that any of them does.
    """
    from scipy.optimize import linprog
    from scipy.sparse import csr_array, diags_array, eye_array, hstack

    m, g = rates.shape
    turned: Any = diags_array(-signs) @ csr_array(rates)
    turned.data[np.abs(turned.data) <= TINIEST] = 0.0  # HiGHS refuses what it takes for rounding
    upper: Any = hstack([turned, eye_array(m)], format="csr")
    cost = np.concatenate((np.zeros(g), np.full(m, -1.0)))
    bounds = [(None, None)] * g + [(0.0, 1.0)] * m
    solve: Any = linprog  # whose types know no sparse matrix
    found = solve(cost, A_ub=upper, b_ub=np.zeros(m), bounds=bounds, method="highs")
    return np.zeros(g) if found.x is None else found.x[:g]


def _still(A: Any, y: np.ndarray, at_rest: np.ndarray) -> np.ndarray:
    """Return the motion nearest to y that lengthens nothing of what is at rest, not even by rounding."""
    own = A[:, at_rest].T
    if isinstance(own, np.ndarray):
        return y - np.linalg.lstsq(own, own @ y, rcond=PROVEN)[0] if len(own) else y
    from scipy.sparse.linalg import lsmr

    return y - lsmr(own, own @ y, atol=1e-14, btol=1e-14, maxiter=20 * max(own.shape))[0]
