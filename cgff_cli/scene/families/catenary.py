"""Chains that hang between two points."""

from typing import Annotated

import numpy as np

from cgff_cli.scene.equilibrium import Equilibrium, members
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new catenary --links 20 --sag 3",
    "cgff new catenary --links 50 --span 100 --drop 5 --weight 10 -o chain.yaml",
)


def equilibrium(
    *,
    links: Annotated[int, Rule("links of the chain", least=2, most=1_000_000)] = 10,
    span: Annotated[float, Rule("horizontal distance of the supports", positive=True)] = 10.0,
    sag: Annotated[
        float, Rule("how far the middle hangs below the line of the supports", positive=True)
    ] = 2.0,
    drop: Annotated[float, Rule("how far the second support is below the first")] = 0.0,
    weight: Annotated[float, Rule("weight of the chain, spread over its inner nodes", positive=True)] = 10.0,
    start: Annotated[str, Rule("where the nodes start", choices=("line", "shape"))] = "line",
) -> Equilibrium:
    """Hanging chain: links between two points, equal weights on its nodes.

    Nodes at equal horizontal distances on the parabola y = -4 sag s (1 - s) - drop s, s from 0 to 1:
    their second differences are all 8 sag / links^2, so one force density in all links carries equal
    weights. The links stretch as their forces ask.
    """
    s = np.arange(links + 1) / links
    line = np.column_stack([span * s, -drop * s])
    X = line - np.outer(4.0 * sag * s * (1.0 - s), (0.0, 1.0))
    each = weight / (links - 1)
    q = each * links**2 / (8.0 * sag)
    rows = np.arange(links + 1)
    return Equilibrium(
        title=f"Hanging chain of {links} links",
        node_names=[f"n{row}" for row in rows],
        coordinates=X,
        members=(members("links", "cable", np.column_stack([rows[:-1], rows[1:]]), q),),
        answer=f"closed form, a parabola {sag:g} deep, horizontal force {q * span / links:.10g}",
        supports={0: "xy", links: "xy"},
        loads=dict.fromkeys(range(1, links), (0.0, -each)),
        start=line if start == "line" else None,
    )
