"""Plane columns in which every strut along them becomes a smaller column of the same form."""

from math import radians, tan
from typing import Annotated

import numpy as np

from cgff_cli.scene.equilibrium import Equilibrium, Members
from cgff_cli.values import Rule

Length = Annotated[float, Rule("length of the column", positive=True)]
Angle = Annotated[float, Rule("lean of the sides of the largest diamond, degrees", least=1, most=59)]


def ends(length: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the (2, 2) foot and head of an upright column, and the (1, 2) pair of them."""
    return np.array([(0.0, 0.0), (0.0, length)]), np.array([(0, 1)])


def across(X: np.ndarray, pairs: np.ndarray, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Return (m, 2) middles of struts and what leads from there to a side node, seen at `angle` (degrees)."""
    along = X[pairs[:, 1]] - X[pairs[:, 0]]
    return X[pairs].mean(axis=1), 0.5 * tan(radians(angle)) * along[:, ::-1] * (-1.0, 1.0)


def pressed(title: str, X: np.ndarray, groups: list[Members], load: float, answer: str) -> Equilibrium:
    """Return a column whose head, held sideways, is pressed towards its foot by a load."""
    names = ["foot", "head", *(f"n{row}" for row in range(1, len(X) - 1))]
    loads = {1: (0.0, -load)} if load else {}
    return Equilibrium(title, names, X, groups, answer, supports={0: "xy", 1: "x"}, loads=loads)
