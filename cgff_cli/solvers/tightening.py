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

MESHED = 1.25
"""Cables per free node from which they are a mesh; a chain has one, and hangs by its loads alone."""

MOST_SHORTENING = 0.3

LOOSE = 1e-3
"""Tolerance of a tighter net."""

STAGE_LIMIT = 30
"""Iterations of a tighter net."""


class Fit(NamedTuple):
    """Mean strain of cables, the scatter of l / l0 about its mean, and whether they form a mesh."""

    strain: float
    scatter: float
    is_mesh: bool

    @property
    def wanted(self) -> float:
        """The mean strain that would make the lengths fit."""
        return self.scatter / GOOD_FIT

    @property
    def is_good(self) -> bool:
        """Whether the lengths fit."""
        return self.strain >= self.wanted

    @property
    def is_loose(self) -> bool:
        """Whether cables are longer than the lengths by more than the scatter: they hang, and stiffly."""
        return self.strain < -GOOD_FIT * self.scatter

    @property
    def can_tighten(self) -> bool:
        """Whether shorter cables lead near the shape: not in a chain, nor in a net that hangs loose."""
        return self.is_mesh and not self.is_good and not self.is_loose


def fit(l: np.ndarray, structure: Structure) -> Fit:
    """Return how (b,) lengths fit the rest lengths."""
    ratio = l / structure.rest_lengths.clip(TINY)
    mean = float(ratio.mean())
    is_mesh = len(l) >= MESHED * np.count_nonzero(structure.free.any(axis=1))
    return Fit(mean - 1.0, float(ratio.std()), bool(is_mesh))


def tightened(structure: Structure, now: Fit) -> Structure:
    """Return the structure with rest lengths shortened until lengths of this fit would fit well."""
    shortening = min(now.wanted - now.strain, MOST_SHORTENING)
    return replace(structure, rest_lengths=structure.rest_lengths * (1.0 - shortening))
