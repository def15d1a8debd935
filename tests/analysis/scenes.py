"""Structures at rest in their start shape, whose ranks and stability are known by counting."""

from cgff_cli.scene.scene import Scene
from tests.bodies import Bar, scene

Point = tuple[float, ...]


def bars(points: list[Point], pairs: list[tuple[int, int]], kind: str = "strut") -> list[Bar]:
    """Return elements of EA 10 at rest in the given points."""
    lengths = [sum((a - b) ** 2 for a, b in zip(points[i], points[j], strict=True)) ** 0.5 for i, j in pairs]
    return [(i, j, kind, 10.0, length) for (i, j), length in zip(pairs, lengths, strict=True)]


def unstressed(
    points: list[Point], pairs: list[tuple[int, int]], supports: dict[int, str] | None = None
) -> Scene:
    """Return a structure of struts without force."""
    return scene(points, bars(points, pairs), supports)


CORNERS: list[Point] = [(0.0, 0.0), (2.0, 0.0), (2.0, 2.0), (0.0, 2.0)]
AROUND = [(0, 1), (1, 2), (2, 3), (3, 0)]
ACROSS = [(0, 2), (1, 3)]


def crossed(around: str, across: str) -> Scene:
    """Square with side force density 1 and diagonal -1 (cables around), or the opposite signs."""
    sign = 1.0 if around == "cable" else -1.0
    sides: list[Bar] = [(i, j, around, 100.0, 2.0 * (1.0 - sign * 0.01)) for i, j in AROUND]
    diagonals: list[Bar] = [(i, j, across, 100.0, 8.0**0.5 * (1.0 + sign * 0.01)) for i, j in ACROSS]
    return scene(CORNERS, [*sides, *diagonals])
