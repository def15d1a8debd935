"""Levy domes."""

from math import ceil, cos, pi
from typing import Annotated

from cgff_cli.errors import OptionError
from cgff_cli.scene.equilibrium import Equilibrium, Prestress, Weight, tightened
from cgff_cli.scene.families.domes import Load, Radius, Rings, Rise, Slope, dome
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new levy",
    "cgff new levy --sides 20 --rings 4 --radius 40 --rise 6 --noise 0.02 -o dome.yaml",
    "cgff new levy --load 0.1 | cgff solve -",
)


def equilibrium(
    *,
    sides: Annotated[int, Rule("struts in each ring, and supports", least=4, most=10_000)] = 8,
    rings: Rings = 2,
    radius: Radius = 10.0,
    rise: Rise = 2.0,
    slope: Slope = 20.0,
    load: Load = 0.0,
    weight: Weight = 0.0,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Levy dome: a Geiger dome with a triangulated net, each ring turned by half a step.

    From each strut two ridges and two diagonals lead to its neighbours in the next ring outwards, which
    have to stand further out than it does: (rings + 1) cos(180/sides) > rings. The self-stress of the
    dome's symmetry follows ring by ring, as a Geiger dome's does.
    """
    across = cos(pi / sides)
    if (rings + 1) * across <= rings:
        most = ceil(across / (1.0 - across)) - 1
        raise OptionError(f"rings must be at most {most} with {sides} sides, got {rings}")
    return tightened(dome("Levy", sides, rings, (radius, rise, slope), (0, 1), (load, weight)), prestress)
