"""A way into the narrow valley of a net that is hardly strained: by way of tighter nets.

Where lengths scatter more than cables are to be strained, half of the cables are slack and the forces say
little of those at rest. With rest lengths shortened by a few times the scatter every cable is taut, a few
iterations balance the forces, and lengths then scatter by some percent of that strain only; and so on down to
the net's own strain, whatever that is.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.elements import TINY
from cgff_cli.structure import Structure

GOOD_FIT = 0.3
"""Lengths fit where l / l0 scatters by no more than this share of the mean strain."""

MOST_SHORTENING = 0.3

LOOSE = 1e-3
"""Tolerance of a tighter net."""

STAGE_LIMIT = 30
"""Iterations of a tighter net."""


class Fit(NamedTuple):
    """Mean strain of cables, and the scatter of l / l0 about its mean."""

    strain: float
    scatter: float

    @property
    def wanted(self) -> float:
        """The mean strain that would make the lengths fit."""
        return self.scatter / GOOD_FIT

    @property
    def is_good(self) -> bool:
        """Whether the lengths fit."""
        return self.strain >= self.wanted

    @property
    def can_tighten(self) -> bool:
        """Whether shorter cables lead near the shape: not in a net that hangs loose."""
        return not self.is_good and self.strain > -GOOD_FIT * self.scatter


def fit(l: np.ndarray, structure: Structure) -> Fit:
    """Return how (b,) lengths fit the rest lengths."""
    ratio = l / structure.rest_lengths.clip(TINY)
    mean = float(ratio.mean())
    return Fit(mean - 1.0, float(ratio.std()))


def tightened(structure: Structure, now: Fit) -> Structure:
    """Return the structure with rest lengths shortened until lengths of this fit would fit well."""
    shortening = min(now.wanted - now.strain, MOST_SHORTENING)
    return replace(structure, rest_lengths=structure.rest_lengths * (1.0 - shortening))
