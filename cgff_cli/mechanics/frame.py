"""Where the mechanics works: about the structure's centroid, in units of its own size and stiffness.

Neither units nor a far-away origin then cost digits. Units are powers of two: scaling rounds nothing, there
and back, and mm/N and m/kN give the same iterates.
"""

from math import frexp
from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.norms import largest
from cgff_cli.structure import Structure


class Frame(NamedTuple):
    """X_user = centre + length X, force_user = stiffness length force; centre: (d,)."""

    centre: np.ndarray
    length: float
    stiffness: float

    @property
    def force(self) -> float:
        """The force unit."""
        return self.stiffness * self.length

    @property
    def energy(self) -> float:
        """The energy unit."""
        return self.force * self.length


UNSCALED = Frame(np.zeros(1), 1.0, 1.0)
"""The user's own units and origin."""


def frame_of(structure: Structure) -> Frame:
    """Return the frame that suits a structure."""
    X = structure.coordinates
    centre = np.add.reduce(X, 0) / len(X)
    size = max(largest(X - centre), float(structure.rest_lengths.max()))
    return Frame(centre, power_of_two(size), power_of_two(float(structure.stiffness.max())))


def power_of_two(value: float) -> float:
    """Return the power of two in (value / 2, value], or 1 for zero."""
    return 2.0 ** (frexp(value)[1] - 1) if value > 0.0 else 1.0
