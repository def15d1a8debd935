"""n-prisms, Snelson's simplex among them."""

from math import pi, sin, sqrt
from typing import Annotated

from cgff_cli.errors import OptionError
from cgff_cli.scene.equilibrium import Equilibrium, Prestress, members, tightened
from cgff_cli.scene.families.rings import ring_nodes, ring_pairs, stage_pairs
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new prism",
    "cgff new prism --sides 5 --strut 3 --noise 0.1 --seed 1 -o prism.yaml",
    "cgff new prism --sides 4 | cgff solve -",
)


def equilibrium(
    *,
    sides: Annotated[int, Rule("sides of each ring, and struts", least=3, most=1_000_000)] = 3,
    radius: Annotated[float, Rule("radius of the rings", positive=True)] = 1.0,
    height: Annotated[
        float | None, Rule("distance between the rings; default: twice the radius", positive=True)
    ] = None,
    strut: Annotated[float | None, Rule("length of the struts, instead of the height", positive=True)] = None,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Prism: two rings of cables twisted against each other, held apart by struts.

    Twist 90 - 180/n degrees between the ends of a vertical; force densities of sides, verticals and
    struts as 1/(2 sin(180/n)) : 1 : -1, whatever radius and height.
    """
    twist = pi / 2.0 - pi / sides
    rise = _height(sides, radius, height, strut)
    names = [f"{level}{i + 1}" for level in "bt" for i in range(sides)]
    groups = (
        members("sides", "cable", ring_pairs(sides, (0, 1)), 0.5 / sin(pi / sides)),
        members("verticals", "cable", stage_pairs(sides, [0]), 1.0),
        members("struts", "strut", stage_pairs(sides, [1]), -1.0),
    )
    answer = (
        f"closed form, twist {90.0 - 180.0 / sides:.10g} degrees; force densities of sides, verticals "
        f"and struts as {0.5 / sin(pi / sides):.10g} : 1 : -1"
    )
    X = ring_nodes(sides, radius, (0.0, twist), rise)
    return tightened(Equilibrium(f"Prism of {sides} sides", names, X, groups, answer), prestress)


def _height(sides: int, radius: float, height: float | None, strut: float | None) -> float:
    """Return the height, of a strut's length where that is given: its ends are 90 + 180/n degrees apart."""
    if strut is None:
        return height or 2.0 * radius
    if height is not None:
        raise OptionError("give height or strut, not both")
    chord = 2.0 * radius * sin(pi / 4.0 + pi / (2.0 * sides))
    if strut <= chord:
        raise OptionError(f"strut must be longer than {chord:.6g} for a radius of {radius:g}, got {strut:g}")
    return sqrt(strut**2 - chord**2)
