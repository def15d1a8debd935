"""The expanded octahedron, six struts that do not touch."""

from math import sqrt
from typing import Annotated

import numpy as np

from cgff_cli.scene.equilibrium import Equilibrium, Prestress, members, tightened
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new octahedron",
    "cgff new octahedron --strut 10 --noise 0.2 --seed 3 -o octahedron.yaml",
)


def equilibrium(
    *,
    strut: Annotated[float, Rule("length of the struts", positive=True)] = 4.0,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Expanded octahedron: six struts in three parallel pairs, 24 cables.

    Struts of length L at distance L/2 from their parallel; every cable sqrt(6)/4 L; the force density of
    struts over that of cables is -3/2.
    """
    ends = np.array([(u * 2.0, v * 1.0, 0.0) for v in (-1, 1) for u in (-1, 1)])
    points = np.concatenate([np.roll(ends, axis, axis=1) for axis in range(3)])
    squared = ((points[:, None] - points[None, :]) ** 2).sum(axis=2)
    cables = np.argwhere(np.triu(np.abs(squared - 6.0) < 0.5))  # 6 = (2 - 1)^2 + 1^2 + 2^2, for L = 4
    groups = (
        members("cables", "cable", cables, 1.0),
        members("struts", "strut", np.arange(12).reshape(6, 2), -1.5),
    )
    names = [f"{bar}{end}" for bar in "abcdef" for end in (1, 2)]
    answer = (
        f"closed form, parallel struts {strut / 2.0:.10g} apart, cables sqrt(6)/4 = {sqrt(6.0) / 4.0:.10g} "
        "of a strut; force density of struts -3/2 of that of cables"
    )
    X = strut / 4.0 * points
    return tightened(Equilibrium("Expanded octahedron", names, X, groups, answer), prestress)
