"""Which energies are one: those that rounding does not tell apart."""

from collections.abc import Sequence

from cgff_cli.study.shapes import Shape


def levels(shapes: Sequence[Shape]) -> list[int]:
    """Return the level of energy of each shape, 0 for the least.

    A level holds what rounding may have parted from the least in it: nothing chains.
    """
    found = [0] * len(shapes)
    level, least = 0, None
    for place in sorted(range(len(shapes)), key=lambda place: shapes[place].energy):
        own = shapes[place]
        least = least or own
        if own.energy - least.energy > own.energy_floor + least.energy_floor:
            level, least = level + 1, own
        found[place] = level
    return found
