"""A way round narrow valleys: stiff elements that have far to swing.

Where an element is stiffer than the forces on the structure by many powers of ten, the energy is a narrow
curved valley: a straight step of angle a stretches it by l a^2 / 2, so that steps shrink with the root of
force over stiffness. With its stiffness capped the valley is wide; raising the cap by stages, each started
from the last one's shape, leads to the stiff structure's own equilibrium in a few steps a stage.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cgff_cli.structure import Structure

WAIT = 25
"""Iterations without halving the residual before the detour is taken."""

GROWTH = 100.0
"""The cap's growth from stage to stage."""

LOOSE = 1e-3
"""Tolerance of a stage."""

STAGE_LIMIT = 200
"""Iterations of a stage."""

MOST_DETOURS = 3


def softened(structure: Structure) -> Iterator[Structure]:
    """Yield the structure with its stiffness capped, softest first; nothing if there is no need of it.

    The first cap is ten times the largest load over the structure's size; without loads, the least
    stiffness. A cap acts like a spring in series: k' = k c / (k + c).
    """
    k = structure.stiffness
    load = float(np.abs(structure.loads).max())
    size = float(np.abs(structure.coordinates).max()) + float(structure.rest_lengths.max())
    cap = 10.0 * load / size if load > 0.0 else float(k.min())
    while cap < float(k.max()):
        yield replace(structure, stiffness=k * (cap / (k + cap)))
        cap *= GROWTH
