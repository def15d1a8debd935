"""Geiger domes."""

from typing import Annotated

from cgff_cli.scene.equilibrium import Equilibrium, Prestress, Weight, tightened
from cgff_cli.scene.families.domes import Load, Radius, Rings, Rise, Slope, dome
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new geiger",
    "cgff new geiger --sides 16 --rings 3 --radius 40 --rise 6 --noise 0.02 -o dome.yaml",
    "cgff new geiger --load 0.1 | cgff solve -",
)


def equilibrium(
    *,
    sides: Annotated[int, Rule("struts in each ring, and supports", least=3, most=10_000)] = 8,
    rings: Rings = 2,
    radius: Radius = 10.0,
    rise: Rise = 2.0,
    slope: Slope = 20.0,
    load: Load = 0.0,
    weight: Weight = 0.0,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Geiger dome: rings of struts in radial planes, on hoops, inside a ring of supports.

    Ridges lead over the struts' tops, on a parabola, and diagonals from their feet to the next tops
    outwards; a top ring ties the innermost ridges together (the form that Geiger patented in 1988, open
    in the middle). One self-stress has the dome's symmetry: the balance of one plane, joint by joint.
    """
    return tightened(dome("Geiger", sides, rings, (radius, rise, slope), (0,), (load, weight)), prestress)
