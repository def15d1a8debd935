"""Rings of nodes above each other, and the members between them."""

from collections.abc import Iterable, Sequence
from math import cos, pi, sin

import numpy as np

Pairs = list[tuple[int, int]]


def ring_nodes(sides: int, radius: float | np.ndarray, turns: Sequence[float], height: float) -> np.ndarray:
    """Return (levels * sides, 3) nodes: one ring per angle of `turns` (radians), `height` apart.

    radius : one number, or (levels,)
    """
    angles = np.add.outer(np.asarray(turns), 2.0 * pi / sides * np.arange(sides)).ravel()
    radii = np.repeat(np.broadcast_to(radius, len(turns)), sides)
    z = np.repeat(height * np.arange(len(turns)), sides)
    return np.column_stack([radii * np.cos(angles), radii * np.sin(angles), z])


def ring_names(sides: int, levels: int) -> list[str]:
    """Return names such as n2_1: level from 0, place in the ring from 1."""
    return [f"n{level}_{i + 1}" for level in range(levels) for i in range(sides)]


def ring_pairs(sides: int, levels: Iterable[int]) -> Pairs:
    """Return the sides of the rings at some levels."""
    return [(sides * s + i, sides * s + (i + 1) % sides) for s in levels for i in range(sides)]


def stage_pairs(sides: int, steps: Sequence[int]) -> Pairs:
    """Return members from node i of each level to node i + step of the next; one step per stage."""
    return [pair for s, step in enumerate(steps) for pair in level_pairs(sides, s, s + 1, step)]


def level_pairs(sides: int, start: int, end: int, step: int) -> Pairs:
    """Return members from node i of one level to node i + step of another."""
    return [(sides * start + i, sides * end + (i + step) % sides) for i in range(sides)]


def stage_stress(sides: int, twist: float) -> tuple[float, float, float, float]:
    """Return the force densities of one stage: ring, vertical, strut, diagonal.

    Vertical, strut and diagonal lead from node i to nodes i, i + 1 and i - 1 of the next ring, which is
    turned by `twist` (radians). The forces at a node balance along the axis, along the tangent and along
    the radius: three equations for the three ratios. Cables pull and struts push for twists from that of
    the prism, pi/2 - pi/n, where the diagonals carry nothing, to pi/2, where the verticals do not.
    """
    step = 2.0 * pi / sides
    vertical = 2.0 * cos(twist) * sin(step)
    strut = -2.0 * cos(twist - step / 2.0) * sin(step / 2.0)
    diagonal = -2.0 * cos(twist + step / 2.0) * sin(step / 2.0)
    inward = vertical * cos(twist) + strut * cos(twist + step) + diagonal * cos(twist - step)
    return inward / (2.0 - 2.0 * cos(step)), vertical, strut, diagonal
