"""Plane towers of X-modules."""

from typing import Annotated

import numpy as np

from cgff_cli.scene.equilibrium import Equilibrium, Prestress, members, tightened
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new x-tower --stages 5",
    "cgff new x-tower --stages 20 --width 2 --height 1 --noise 0.1 -o tower.yaml",
)


def equilibrium(
    *,
    stages: Annotated[int, Rule("modules upon each other", least=1, most=1_000_000)] = 3,
    width: Annotated[float, Rule("width of the tower", positive=True)] = 1.0,
    height: Annotated[float, Rule("height of a module", positive=True)] = 1.0,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Plane tower: X-modules stacked upon each other.

    A rectangle of cables with force density 1 and struts on its diagonals with -1 is in balance; where
    two modules meet, they share a cable, which carries 2.
    """
    left, right = 2 * np.arange(stages + 1), 2 * np.arange(stages + 1) + 1
    ends = [0, stages]
    groups = [
        members("ends", "cable", np.column_stack([left[ends], right[ends]]), 1.0),
        members("floors", "cable", np.column_stack([left[1:-1], right[1:-1]]), 2.0),
        members("sides", "cable", np.stack([left[:-1], left[1:], right[:-1], right[1:]], axis=1), 1.0),
        members("struts", "strut", np.stack([left[:-1], right[1:], right[:-1], left[1:]], axis=1), -1.0),
    ]
    x = np.tile([-width / 2.0, width / 2.0], stages + 1)
    y = height * np.repeat(np.arange(stages + 1), 2)
    return tightened(
        Equilibrium(
            title=f"Plane tower of {stages} X-modules",
            node_names=[f"{side}{level}" for level in range(stages + 1) for side in "lr"],
            coordinates=np.column_stack([x, y]),
            members=[own for own in groups if len(own.pairs)],
            answer="closed form, rectangles; force densities of ends and sides, floors, struts as 1 : 2 : -1",
        ),
        prestress,
    )
