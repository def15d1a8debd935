"""Towers of prisms upon each other."""

from math import pi, radians
from typing import Annotated

from cgff_cli.errors import OptionError
from cgff_cli.scene.equilibrium import Equilibrium, Prestress, members, tightened
from cgff_cli.scene.families.rings import ring_names, ring_nodes, ring_pairs, stage_pairs, stage_stress
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new tower --stages 4",
    "cgff new tower --stages 1000 --noise 0.01 --seed 1 -o tower.yaml",
    "cgff new tower --sides 5 --stages 3 --twist 60 | cgff solve -",
)


def equilibrium(
    *,
    stages: Annotated[int, Rule("prisms upon each other", least=1, most=1_000_000)] = 3,
    sides: Annotated[int, Rule("sides of each ring", least=3, most=10_000)] = 3,
    radius: Annotated[float, Rule("radius of the rings", positive=True)] = 1.0,
    height: Annotated[float, Rule("height of a stage", positive=True)] = 1.5,
    twist: Annotated[
        float | None, Rule("turn of each ring against the one below, degrees; default: 90 - 150/n", least=0)
    ] = None,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Prism tower: stages of one hand that share their rings, braced by diagonal cables.

    Every stage carries one self-stress, known in closed form; the tower carries their sum, so that the
    rings two stages share carry twice the force of those at the ends.
    """
    low, high = 90.0 - 180.0 / sides, 90.0
    degrees = 90.0 - 150.0 / sides if twist is None else twist
    if not low < degrees < high:
        raise OptionError(f"twist must be between {low:g} and {high:g} for {sides} sides, got {degrees:g}")
    ring, vertical, strut, diagonal = stage_stress(sides, radians(degrees))
    groups = [
        members("end_rings", "cable", ring_pairs(sides, (0, stages)), ring),
        members("rings", "cable", ring_pairs(sides, range(1, stages)), 2.0 * ring),
        members("verticals", "cable", stage_pairs(sides, [0] * stages), vertical),
        members("diagonals", "cable", stage_pairs(sides, [-1] * stages), diagonal),
        members("struts", "strut", stage_pairs(sides, [1] * stages), strut),
    ]
    turns = [radians(degrees) * level % (2.0 * pi) for level in range(stages + 1)]
    return tightened(
        Equilibrium(
            title=f"Tower of {stages} prisms of {sides} sides",
            node_names=ring_names(sides, stages + 1),
            coordinates=ring_nodes(sides, radius, turns, height),
            members=[own for own in groups if len(own.pairs)],
            answer=f"closed form, each ring turned by {degrees:.10g} degrees, one self-stress per stage",
        ),
        prestress,
    )
