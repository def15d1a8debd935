"""Kresling modules: twisted cylinders of creases that stand in two heights."""

from math import acos, cos, pi, sqrt
from typing import Annotated

from cgff_cli.errors import OptionError
from cgff_cli.scene.equilibrium import Equilibrium, members
from cgff_cli.scene.families.rings import level_pairs, ring_names, ring_nodes, ring_pairs
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new kresling",
    "cgff new kresling --sides 8 --height 1.2 --folded 0.2 --state folded --noise 0.02 -o module.yaml",
)


def equilibrium(
    *,
    sides: Annotated[int, Rule("sides of the two polygons", least=3, most=100_000)] = 6,
    radius: Annotated[float, Rule("radius of the polygons", positive=True)] = 1.0,
    height: Annotated[float, Rule("height when deployed", positive=True)] = 1.2,
    folded: Annotated[float, Rule("height when folded", positive=True)] = 0.5,
    state: Annotated[str, Rule("which of the two it is in", choices=("deployed", "folded"))] = "deployed",
) -> Equilibrium:
    """Kresling module: a polygon on creases above a fixed one, at rest in two states.

    Creases lead from node i of the fixed polygon (valleys) and from node i + 1 (mountains) to node i of
    the other, which is turned by 180/n + w degrees: squared lengths h^2 + 2 r^2 (1 - cos(w +- 180/n)).
    Both are the same again where w becomes 180 - w and h^2 less by 4 r^2 cos(w) cos(180/n): two states
    without any force (derived; the truss model, of creases that carry axial force alone). Nearer than
    180/n to 0 or 180 degrees, w has creases pass through the axis.
    """
    half = pi / sides
    most = 4.0 * radius**2 * cos(half) ** 2
    if not 0.0 < height**2 - folded**2 < most:
        least = sqrt(max(height**2 - most, 0.0))
        raise OptionError(
            f"folded must be between {least:.6g} and {height:.6g}, the height, with {sides} sides and a "
            f"radius of {radius:g}, got {folded:g}"
        )
    wide = acos((height**2 - folded**2) / (4.0 * radius**2 * cos(half)))
    deployed = state == "deployed"
    turn = half + (wide if deployed else pi - wide)
    X = ring_nodes(sides, radius, (0.0, turn), height if deployed else folded)
    groups = (
        members("polygon", "strut", ring_pairs(sides, [1]), 0.0),
        members("valleys", "strut", level_pairs(sides, 0, 1, 0), 0.0),
        members("mountains", "strut", level_pairs(sides, 1, 0, 1), 0.0),
    )
    answer = (
        f"closed form, without force, as at height {folded if deployed else height:g} and another turn; "
        f"turned by {turn * 180.0 / pi:.10g} degrees"
    )
    held = dict.fromkeys(range(sides), "xyz")
    return Equilibrium(f"Kresling module of {sides} sides", ring_names(sides, 2), X, groups, answer, held)
