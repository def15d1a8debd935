"""At which multiple of the loads the tangent stiffness becomes singular, as far as it is linear in them.

The loads F move the structure by dx, K dx = F, and so change force densities by dq = k u . dx / l. A factor
lambda on the loads makes K + (lambda - 1) K_G(dq) of K, K_G = I (x) D: lambda = 1 is the present state,
lambda = 0 the unloaded one, and the least lambda > 0 at which this is singular the critical load factor. It
bounds nothing where the shape changes much on the way: an arch that flattens snaps before; nor where a cable
goes slack on the way, see analysis.slackening.
"""

from typing import TYPE_CHECKING, Any, cast

import numpy as np

from cgff_cli.analysis.lanczos import CLOSE, Operator, largest_of
from cgff_cli.analysis.mechanisms import stress_matrix
from cgff_cli.analysis.reasons import ALL_IDLE
from cgff_cli.analysis.stability import Signs
from cgff_cli.mechanics.signs import Spectrum, is_positive
from cgff_cli.mechanics.state import State

if TYPE_CHECKING:
    from cgff_cli.analysis.large import LargeSpectrum

SLIGHT = 1e-9
"""Least factor, and over the greatest 1, that is more than rounding of none."""

MOST_RESTARTS = 60
"""Of Lanczos' method with 20 vectors; a net under snow takes 20 (tests/studies/analyse.py)."""

_NO_LOADS = "there are no loads"
_SINGULAR = "not told: some motion has no stiffness beyond rounding, so that loads may move it without end"
NEVER = "no multiple of the loads makes the stiffness singular, as far as it is linear in them"
_NEITHER = "not told: neither with nor without the loads is every motion stiff"
_NEEDED = "not told: without the loads some motion is not stiff, and the structure is large"
_NOT_FOUND = "not told: no eigenvalue was found in a structure of this size"


def moved_by_loads(state: State, signs: Signs, doubt: float) -> tuple[np.ndarray | None, str]:
    """Return dx, (d, m), with K dx = F, or None and why there is none.

    signs: the spectrum of K at the state, in balance; doubt: the size of a stiffness that has no sign.
    """
    F = state.mechanics.F
    if F is None:
        return None, _NO_LOADS
    if not signs.count:
        return None, ALL_IDLE
    dx = signs.solved(F, doubt)
    if dx is None or not signs.is_sure or np.abs(signs.values).min() <= doubt:
        return None, _SINGULAR
    return dx, ""


def critical_load_factor(
    state: State, signs: Signs, doubt: float, dx: np.ndarray
) -> tuple[float | None, str]:
    """Return the least positive load factor at which K is singular, or None and why; 1 is the present state.

    dx: what the loads move, see above; cables that are taut stay so.
    """
    dq = density_rate(state, state.mechanics.connectivity.differences(dx))
    if isinstance(signs, Spectrum):
        return _of_small(signs, state, dq, doubt)
    return _of_large(cast("LargeSpectrum", signs), dq, doubt)


def density_rate(state: State, Z: np.ndarray) -> np.ndarray:
    """Return dq = k u . z / l, (b,), of element vectors' changes Z (d, b); 0 where slack."""
    m = state.mechanics
    return m.k * state.taut * np.einsum("ab,ab->b", state.V, Z) / (state.l * state.l)


def _of_small(signs: Spectrum, state: State, dq: np.ndarray, doubt: float) -> tuple[float | None, str]:
    values, vectors = signs.eigen
    dofs = state.mechanics.dofs
    G = vectors.T @ stress_matrix(state, dq)[np.ix_(dofs, dofs)] @ vectors
    unloaded = np.diag(values) - G
    if is_positive(unloaded.copy(), -doubt):
        L, now = np.linalg.cholesky(unloaded), 0.0
    elif values[0] > 0.0:
        L, now = np.diag(np.sqrt(values)), 1.0
    else:
        return None, _NEITHER
    return _least(np.linalg.eigvalsh(np.linalg.solve(L, np.linalg.solve(L, G).T)), now)


def _least(rates: np.ndarray, now: float) -> tuple[float | None, str]:
    """Return the least positive factor; rates: eigenvalues of K_G against K at the factor `now`."""
    with np.errstate(divide="ignore"):
        factors = now - 1.0 / rates
    factors = factors[(factors > SLIGHT) & (factors < 1.0 / SLIGHT)]
    return (float(factors.min()), "") if len(factors) else (None, NEVER)


def _of_large(signs: "LargeSpectrum", dq: np.ndarray, doubt: float) -> tuple[float | None, str]:
    """Return the same by Lanczos' method, where K is not negative without the loads.

    Nothing is then singular between no load and the present one if that is stable, and only what more load
    does is sought; else what the loads have done on the way from none.
    """
    change = signs.pattern.fill(signs.state.V, np.zeros(len(dq)), dq, held=0.0)
    unloaded = signs.data - change
    factor = signs.factor_of(unloaded)
    if factor is None:
        return None, _NEEDED
    if signs.blur < SLIGHT * signs.softest and signs.factor_of(change) is not None:
        return None, NEVER  # more load only stiffens: K_G is not negative anywhere
    G = signs.pattern.matrix(change)
    if signs.softest > doubt:
        return _lowered(G, signs.matrix, lambda y: signs.refined(signs.cleared(y))[0], signs, 1.0)

    def inverse(y: np.ndarray) -> np.ndarray:
        """Return what the unloaded structure makes of forces."""
        return signs.cleared(factor.solve(y))

    K = signs.pattern.matrix(unloaded)
    (x,) = largest_of(inverse, signs.start(1), 1, signs.count)[0].T
    return _lowered(G, K, inverse, signs, 0.0) if x @ (K @ x) > doubt else (None, _NEEDED)


def _lowered(
    G: Any, K: Any, inverse: Operator, signs: "LargeSpectrum", now: float
) -> tuple[float | None, str]:
    """Return the factor at which more load makes K, that at the factor `now`, singular."""
    from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

    Minv, v0 = LinearOperator(K.shape, inverse, dtype=float), signs.start(1)[:, 0]
    try:
        rates = eigsh(
            G, 1, K, which="SA", v0=v0, maxiter=MOST_RESTARTS, tol=CLOSE, Minv=Minv, return_eigenvectors=False
        )
    except ArpackError:
        return None, _NOT_FOUND
    return _least(rates[rates < 0.0], now)
