"""Plane chains of X-modules, straight or bent."""

from math import radians, tan
from typing import Annotated

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.scene.equilibrium import Equilibrium, Prestress, members, tightened
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new snake --modules 6",
    "cgff new snake --modules 12 --bend 180 --noise 0.1 -o arch.yaml",
)


def equilibrium(
    *,
    modules: Annotated[int, Rule("X-modules in the row", least=1, most=1_000_000)] = 4,
    length: Annotated[float, Rule("length of a module along its middle", positive=True)] = 1.0,
    width: Annotated[float, Rule("width of the snake", positive=True)] = 1.0,
    bend: Annotated[float, Rule("angle between its two ends, degrees", least=0, most=350)] = 0.0,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Plane snake: X-modules in a row, straight or bent to an arc.

    A module is a trapezium with parallel sides a (inner) and b (outer). Any four points in a plane carry
    a self-stress, q_ij proportional to -c_i c_j with c the coefficients of their affine dependency, here
    b, -b, a, -a: inner side b^2, outer side a^2, legs ab, struts -ab. Modules share their legs.
    """
    inner, outer = _sides(modules, length, width, bend)
    row = np.arange(modules + 1)
    low, high = 2 * row, 2 * row + 1
    ends = [0, modules]
    a, b = inner / length, outer / length
    groups = [
        members("inner", "cable", np.column_stack([low[:-1], low[1:]]), b * b),
        members("outer", "cable", np.column_stack([high[:-1], high[1:]]), a * a),
        members("ends", "cable", np.column_stack([low[ends], high[ends]]), a * b),
        members("ribs", "cable", np.column_stack([low[1:-1], high[1:-1]]), 2.0 * a * b),
        members("struts", "strut", np.stack([low[:-1], high[1:], high[:-1], low[1:]], axis=1), -a * b),
    ]
    return tightened(
        Equilibrium(
            title=f"Snake of {modules} X-modules" + (f" bent by {bend:g} degrees" if bend else ""),
            node_names=[f"{side}{i}" for i in range(modules + 1) for side in "io"],
            coordinates=_nodes(modules, length, width, bend),
            members=[own for own in groups if len(own.pairs)],
            answer=f"closed form, modules with sides of {inner:.10g} (inner) and {outer:.10g} (outer)",
        ),
        prestress,
    )


def _sides(modules: int, length: float, width: float, bend: float) -> tuple[float, float]:
    """Return the inner and outer side of a module; its legs are width / cos(turn / 2) long."""
    change = width * tan(radians(bend) / modules / 2.0)
    if bend >= 180.0 * modules or change >= length:
        raise OptionError(
            f"modules of length {length:g} and width {width:g} cannot be bent by {bend:g} degrees"
        )
    return length - change, length + change


def _nodes(modules: int, length: float, width: float, bend: float) -> np.ndarray:
    """Return inner and outer node of every rib, (2 modules + 2, 2), bent upwards about a centre above."""
    turn = radians(bend) / modules
    if turn == 0.0:
        x = np.repeat(length * np.arange(modules + 1), 2)
        return np.column_stack([x, np.tile([width / 2.0, -width / 2.0], modules + 1)])
    middle = length / (2.0 * tan(turn / 2.0))  # from the centre to the middle of a module
    radii = np.array([middle - width / 2.0, middle + width / 2.0]) / np.cos(turn / 2.0)
    angles = turn * (np.arange(modules + 1) - modules / 2.0)
    directions = np.column_stack([np.sin(angles), -np.cos(angles)])
    points: np.ndarray = radii[None, :, None] * directions[:, None, :] + np.array([0.0, middle])
    return points.reshape(-1, 2)
