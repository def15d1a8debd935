"""Drums: prisms upon each other that turn forth and back."""

from math import pi, sin
from typing import Annotated

from cgff_cli.scene.equilibrium import Equilibrium, Prestress, members, tightened
from cgff_cli.scene.families.rings import ring_names, ring_nodes, ring_pairs, stage_pairs
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new drum",
    "cgff new drum --struts 12 --stages 3 --radius 5 --noise 0.05 -o drum.yaml",
)


def equilibrium(
    *,
    struts: Annotated[int, Rule("struts in each stage, and sides of each ring", least=3, most=100_000)] = 6,
    stages: Annotated[int, Rule("prisms upon each other", least=1, most=100_000)] = 2,
    radius: Annotated[float, Rule("radius of the rings", positive=True)] = 1.0,
    height: Annotated[float, Rule("height of a stage", positive=True)] = 1.0,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Drum: prisms of alternating hand that share their rings.

    Every stage is the prism's closed form, every other one its mirror image, so that the rings turn by
    90 - 180/n degrees forth and back; rings that two stages share carry twice the force.
    """
    twist = pi / 2.0 - pi / struts
    hands = [1 - 2 * (stage % 2) for stage in range(stages)]
    ring = 0.5 / sin(pi / struts)
    groups = [
        members("end_rings", "cable", ring_pairs(struts, (0, stages)), ring),
        members("rings", "cable", ring_pairs(struts, range(1, stages)), 2.0 * ring),
        members("verticals", "cable", stage_pairs(struts, [0] * stages), 1.0),
        members("struts", "strut", stage_pairs(struts, hands), -1.0),
    ]
    return tightened(
        Equilibrium(
            title=f"Drum of {stages} times {struts} struts",
            node_names=ring_names(struts, stages + 1),
            coordinates=ring_nodes(struts, radius, [twist * (s % 2) for s in range(stages + 1)], height),
            members=[own for own in groups if len(own.pairs)],
            answer=f"closed form, rings turned by {90.0 - 180.0 / struts:.10g} degrees forth and back",
        ),
        prestress,
    )
