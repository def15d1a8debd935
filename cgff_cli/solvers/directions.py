"""Conjugate gradient directions: one function per rule, one table.

    d_k = a z_k + b d_{k-1} + c M^-1 y,     y = g_k - g_{k-1}

A rule returns (a, b, c) from the new point, the old one, the old direction d, and M^-1 as a function; b is
what the history calls beta. They are the textbook's with the inner product of M^-1 (Hager and Zhang, A
survey of nonlinear conjugate gradient methods, 2006, table 1). TT and SP have <g, d> = -<g, z> whatever the
line search and the old direction did. They and HZ are of the kinds that the paper's [17] and [20] belong to,
not those papers' own formulas.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

HAGER_ZHANG = 0.01
"""Their eta, which bounds beta from below (Hager and Zhang 2005)."""


class Point(NamedTuple):
    """An iteration's gradient, z = M^-1 g, and <g, z>."""

    g: np.ndarray
    z: np.ndarray
    gz: float


Solved = Callable[[np.ndarray], np.ndarray]
Coefficients = tuple[float, float, float]
BetaRule = Callable[[Point, Point, np.ndarray, Solved], Coefficients]


def fletcher_reeves(new: Point, old: Point, d: np.ndarray, solved: Solved) -> Coefficients:
    """Return beta = <g, z> / <g_old, z_old>, the paper's choice."""
    return -1.0, _ratio(new.gz, old.gz), 0.0


def polak_ribiere_plus(new: Point, old: Point, d: np.ndarray, solved: Solved) -> Coefficients:
    """Return beta = max(<z, y> / <g_old, z_old>, 0)."""
    return -1.0, max(_ratio(np.vdot(new.z, new.g - old.g), old.gz), 0.0), 0.0


def hestenes_stiefel(new: Point, old: Point, d: np.ndarray, solved: Solved) -> Coefficients:
    """Return beta = <z, y> / <d, y>."""
    y = new.g - old.g
    return -1.0, _ratio(np.vdot(new.z, y), np.vdot(d, y)), 0.0


def dai_yuan(new: Point, old: Point, d: np.ndarray, solved: Solved) -> Coefficients:
    """Return beta = <g, z> / <d, y>."""
    return -1.0, _ratio(new.gz, np.vdot(d, new.g - old.g)), 0.0


def three_term(new: Point, old: Point, d: np.ndarray, solved: Solved) -> Coefficients:
    """Return Polak and Ribiere's beta and c = -<g, d> / <g_old, z_old> (Zhang, Zhou and Li, IMA J. 2006)."""
    beta = _ratio(np.vdot(new.z, new.g - old.g), old.gz)
    return -1.0, beta, -_ratio(np.vdot(new.g, d), old.gz)


def spectral(new: Point, old: Point, d: np.ndarray, solved: Solved) -> Coefficients:
    """Return FR's beta and a = -(1 + beta <g, d> / <g, z>) (Zhang, Zhou and Li, Numer. Math. 2006)."""
    return -1.0 - _ratio(np.vdot(new.g, d), old.gz), _ratio(new.gz, old.gz), 0.0


def hager_zhang(new: Point, old: Point, d: np.ndarray, solved: Solved) -> Coefficients:
    """Return beta = <z, y> / <d, y> - 2 <y, M^-1 y> <g, d> / <d, y>^2, or their bound if greater.

    The bound is -1 / (|d| min(0.01, |g_old|)) (SIAM J. Optim. 2005, as their guide to CG_DESCENT 1.1 prints
    it), in the plain norm: M itself is not at hand. It is the one number here that scales with the objective;
    forces are of order one, as CGFF scales them. Whatever its size, <g, d> <= -7/8 <g, z>.
    """
    y = new.g - old.g
    dy, steep = np.vdot(d, y), float(np.linalg.norm(old.g))
    bend = _ratio(np.vdot(y, solved(y)), dy)
    beta = _ratio(np.vdot(new.z, y) - 2.0 * bend * np.vdot(new.g, d), dy)
    return -1.0, max(beta, -_ratio(1.0, float(np.linalg.norm(d)) * min(HAGER_ZHANG, steep))), 0.0


def _ratio(above: float, below: float) -> float:
    return float(above / below) if below != 0.0 else 0.0


RULES: dict[str, BetaRule] = {
    "FR": fletcher_reeves,
    "PR+": polak_ribiere_plus,
    "HS": hestenes_stiefel,
    "DY": dai_yuan,
    "TT": three_term,
    "SP": spectral,
    "HZ": hager_zhang,
}
