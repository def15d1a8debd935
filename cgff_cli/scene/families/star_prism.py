"""Star prisms: prisms with a star of cables in place of each ring."""

from math import pi, sin
from typing import Annotated

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.scene.equilibrium import Equilibrium, Prestress, members, tightened
from cgff_cli.scene.families.rings import level_pairs, ring_nodes
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new star-prism",
    "cgff new star-prism --struts 7 --height 3 --noise 0.1 --seed 1 -o star.yaml",
)


def equilibrium(
    *,
    struts: Annotated[int, Rule("struts, an odd number", least=3, most=1_000_001)] = 5,
    radius: Annotated[float, Rule("radius of the two circles of nodes", positive=True)] = 1.0,
    height: Annotated[float, Rule("distance between the circles", positive=True)] = 2.0,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Star prism: struts between two circles, each tied by a star of cables to its centre.

    A strut leads k = (n - 1)/2 places on from the foot of a vertical; twist 90 - 180 k/n degrees, force
    densities of radial cables, verticals and struts as 2 sin(180 k/n) : 1 : -1. Zhang, Guest, Connelly
    and Ohsaki, "Dihedral star tensegrity structures": super-stable for odd n and this k alone.
    """
    if struts % 2 == 0:
        raise OptionError(f"struts must be odd, got {struts}: with an even number none is super-stable")
    step = (struts - 1) // 2
    half = pi * step / struts
    X = np.concatenate(
        [ring_nodes(struts, radius, (0.0, pi / 2.0 - half), height), [(0.0, 0.0, 0.0), (0.0, 0.0, height)]]
    )
    radials = [(2 * struts + node // struts, node) for node in range(2 * struts)]
    groups = (
        members("radials", "cable", radials, 2.0 * sin(half)),
        members("verticals", "cable", level_pairs(struts, 0, 1, 0), 1.0),
        members("struts", "strut", level_pairs(struts, 0, 1, step), -1.0),
    )
    answer = (
        f"closed form, twist {90.0 - 180.0 * step / struts:.10g} degrees; force densities of radials, "
        f"verticals and struts as {2.0 * sin(half):.10g} : 1 : -1"
    )
    names = [*(f"{level}{i + 1}" for level in "bt" for i in range(struts)), "b", "t"]
    return tightened(Equilibrium(f"Star prism of {struts} struts", names, X, groups, answer), prestress)
