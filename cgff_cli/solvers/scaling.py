"""Centre and scale a structure, so that neither units nor a far-away origin cost digits.

Units are powers of two: scaling then rounds nothing, and mm/N and m/kN give the same iterates.
"""

from dataclasses import dataclass, replace
from math import frexp

import numpy as np

from cgff_cli.structure import Structure


@dataclass(frozen=True)
class Frame:
    """Where the solver works: X_user = centre + length X, force_user = stiffness length force."""

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


def centred_and_scaled(structure: Structure) -> tuple[Structure, Frame]:
    """Return the structure about its centroid in units of its own size and stiffness, and that frame."""
    centre = structure.coordinates.mean(axis=0)
    local = structure.coordinates - centre
    size = max(float(np.abs(local).max()), float(structure.rest_lengths.max()))
    frame = Frame(centre, _power_of_two(size), _power_of_two(float(structure.stiffness.max())))
    scaled = replace(
        structure,
        coordinates=local / frame.length,
        stiffness=structure.stiffness / frame.stiffness,
        rest_lengths=structure.rest_lengths / frame.length,
        loads=structure.loads / frame.force,
    )
    return scaled, frame


def _power_of_two(value: float) -> float:
    """Return the power of two in (value / 2, value], or 1 for zero."""
    return 2.0 ** (frexp(value)[1] - 1) if value > 0.0 else 1.0
