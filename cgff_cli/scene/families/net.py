"""Cable nets in a rigid rim."""

from typing import Annotated

import numpy as np

from cgff_cli.scene.equilibrium import Equilibrium, Prestress, Weight, members, tightened
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new net --side 10",
    "cgff new net --side 30 --rise 2 --jitter 0.01 --snow 0.5 --seed 1 -o net.yaml",
    "cgff new net --side 700 -o big-net.yaml",
)


def equilibrium(
    *,
    side: Annotated[int, Rule("nodes along each side, the rim among them", least=3, most=4000)] = 10,
    span: Annotated[float, Rule("width of the net", positive=True)] = 10.0,
    rise: Annotated[float, Rule("height of the rim's middles above and below its corners")] = 1.5,
    snow: Annotated[
        float,
        Rule(
            "load on every unit of plan area, downwards, put on afterwards at the nodes inside, each for a "
            "square of its own; what falls on the half squares along the rim is left to the rim"
        ),
    ] = 0.0,
    weight: Weight = 0.0,
    start: Annotated[str, Rule("where the inside starts", choices=("flat", "saddle"))] = "flat",
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Cable net: a saddle inside a fixed rim.

    Nodes stand on a square grid, at z proportional to x^2 - y^2, where one force density in all cables
    is in balance. The corners, which no cable would reach, and cables along the rim are left out.
    Rest lengths belong to the net without snow.
    """
    kept, on_rim, rows = _grid(side)
    j, i = np.divmod(kept, side)
    u, v = 2.0 * i / (side - 1) - 1.0, 2.0 * j / (side - 1) - 1.0
    X = np.column_stack([span / 2.0 * u, span / 2.0 * v, rise * (u**2 - v**2)])
    square = (span / (side - 1)) ** 2
    load, area = (0.0, 0.0, -snow * square), (side - 2) ** 2 * square
    loaded = f"Snow: at nodes inside, for {area:.6g} of {span**2:.6g} of plan area; the rim takes the rest."
    groups = (
        members("along_x", "cable", _pairs(rows[1:-1, :-1], rows[1:-1, 1:]), 1.0),
        members("along_y", "cable", _pairs(rows[:-1, 1:-1], rows[1:, 1:-1]), 1.0),
    )
    return tightened(
        Equilibrium(
            title=f"Cable net of {side} x {side}",
            node_names=[f"n{a}_{b}" for a, b in zip(i.tolist(), j.tolist(), strict=True)],
            coordinates=X,
            members=groups,
            answer=f"closed form, z = {rise:g} (x^2 - y^2) / {span / 2.0:g}^2, one force density everywhere",
            supports=dict.fromkeys(np.flatnonzero(on_rim).tolist(), "xyz"),
            weight=weight,
            added_loads=dict.fromkeys(np.flatnonzero(~on_rim).tolist(), load) if snow else {},
            added=loaded if snow else "",
            start=np.where(on_rim[:, None], X, X * (1.0, 1.0, 0.0)) if start == "flat" else None,
        ),
        prestress,
    )


def _grid(side: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return the nodes of a square grid but its corners, row by row; which are on the rim; their rows.

    The third is (side, side): the node's place among those kept, -1 at the corners.
    """
    edge = np.arange(side) % (side - 1) == 0
    edges = edge[:, None].astype(int) + edge[None, :]  # 0 inside, 1 on the rim, 2 at a corner
    kept = np.flatnonzero(edges < 2)
    rows = np.full(side * side, -1)
    rows[kept] = np.arange(len(kept))
    return kept, edges.ravel()[kept] == 1, rows.reshape(side, side)


def _pairs(begin: np.ndarray, end: np.ndarray) -> np.ndarray:
    return np.column_stack([begin.ravel(), end.ravel()])
