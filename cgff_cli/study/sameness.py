"""Which shapes are the same: one laid over the other by the rigid motions that supports and loads leave.

Neither energy nor lengths tell equilibria apart: a structure may snap from one state into another of equal
lengths. Shapes are the same where some such motion brings every node of the one to within a tolerance of
its place in the other; for a free body that is to compare all distances between nodes.
"""

from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.rigid import all_motions
from cgff_cli.mechanics.signs import idle_motions
from cgff_cli.mechanics.state import State

TURNS = 1e-6
"""Rates of turning below this, in a motion of unit length, are none."""


class Leeway(NamedTuple):
    """Which rotations are left to a shape; shifts need no telling, as held nodes stay where they are.

    kind : "mirrored", any, and mirror images too; "any"; "axis", about one; "none"
    axis : (d,) the axis, or nothing
    """

    kind: str
    axis: np.ndarray


def leeway_of(state: State, floor: float) -> Leeway:
    """Return the rotations that supports and loads leave a balanced state; floor: rounding of its forces.

    Mirror images are one shape in a free body without loads only: a truss that may stand or hang has two.
    """
    m, d = state.mechanics, len(state.X)
    nothing = np.zeros(0)
    if m.all_free and m.F is None:
        return Leeway("mirrored", nothing)
    idle, _ = idle_motions(state, floor)
    motions = np.zeros((d * len(m.structure.free), idle.shape[1]))
    motions[m.structure.free.T.reshape(-1)] = idle
    rates = np.linalg.lstsq(all_motions(m.everywhere(state.X)), motions, rcond=None)[0][d:]
    _, values, rows = np.linalg.svd(rates.T)
    count = int((values > TURNS).sum())
    if count == 0:
        return Leeway("none", nothing)
    if count > 1 or d == 2:
        return Leeway("any", nothing)
    xy, xz, yz = rows[0]  # planes in which the axes turn into each other
    return Leeway("axis", np.array([yz, -xz, xy]))


def laid(X: np.ndarray, target: np.ndarray, leeway: Leeway) -> np.ndarray:
    """Return X (n, d) shifted and turned onto the target as nearly as it may be, least squares (Kabsch)."""
    centre = target.mean(axis=0)
    A = X - X.mean(axis=0)
    return np.asarray(A @ _turn(A.T @ (target - centre), leeway) + centre)


def _turn(H: np.ndarray, leeway: Leeway) -> np.ndarray:
    """Return the (d, d) rotation R, of those there are, with the largest sum of R * H."""
    d = len(H)
    if leeway.kind == "none":
        return np.eye(d)
    if leeway.kind == "axis":
        u = leeway.axis
        P = np.linalg.svd(u[None])[2][1:]
        h = P @ H @ P.T
        angle = np.arctan2(h[0, 1] - h[1, 0], h[0, 0] + h[1, 1])
        c, s = np.cos(angle), np.sin(angle)
        return np.asarray(np.outer(u, u) + P.T @ np.array([[c, s], [-s, c]]) @ P)
    left, _, right = np.linalg.svd(H)
    if leeway.kind == "any" and np.linalg.det(left @ right) < 0.0:
        left[:, -1] *= -1.0
    return np.asarray(left @ right)
