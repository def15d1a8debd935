"""Conjugate gradient coefficients: one function per rule, one table.

g, g_old : gradients, new and old              z, z_old : the same, preconditioned (z = M^-1 g)
d        : the old direction                   all (n, d) arrays; a rule returns the scalar cg_beta
Every rule is the textbook's with the inner product of M^-1 (Hager and Zhang, A survey of nonlinear
conjugate gradient methods, 2006, table 1).
"""

from collections.abc import Callable

import numpy as np

Rule = Callable[[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray], float]


def fletcher_reeves(
    g: np.ndarray, z: np.ndarray, g_old: np.ndarray, z_old: np.ndarray, d: np.ndarray
) -> float:
    """Return <g, z> / <g_old, z_old>, the paper's choice."""
    return _ratio(np.vdot(g, z), np.vdot(g_old, z_old))


def polak_ribiere_plus(
    g: np.ndarray, z: np.ndarray, g_old: np.ndarray, z_old: np.ndarray, d: np.ndarray
) -> float:
    """Return max(<z, g - g_old> / <g_old, z_old>, 0)."""
    return max(_ratio(np.vdot(z, g - g_old), np.vdot(g_old, z_old)), 0.0)


def hestenes_stiefel(
    g: np.ndarray, z: np.ndarray, g_old: np.ndarray, z_old: np.ndarray, d: np.ndarray
) -> float:
    """Return <z, g - g_old> / <d, g - g_old>."""
    y = g - g_old
    return _ratio(np.vdot(z, y), np.vdot(d, y))


def dai_yuan(g: np.ndarray, z: np.ndarray, g_old: np.ndarray, z_old: np.ndarray, d: np.ndarray) -> float:
    """Return <g, z> / <d, g - g_old>."""
    return _ratio(np.vdot(g, z), np.vdot(d, g - g_old))


def _ratio(above: float, below: float) -> float:
    return float(above / below) if below != 0.0 else 0.0


RULES: dict[str, Rule] = {
    "FR": fletcher_reeves,
    "PR+": polak_ribiere_plus,
    "HS": hestenes_stiefel,
    "DY": dai_yuan,
}
