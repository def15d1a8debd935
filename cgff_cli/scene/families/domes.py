"""Cable domes: struts that stand on hoops and hang in a net of ridges, in a ring of supports."""

from collections.abc import Sequence
from math import cos, pi, radians, sin, tan
from typing import Annotated

import numpy as np

from cgff_cli.scene.equilibrium import Equilibrium, Members, members
from cgff_cli.scene.families.rings import level_pairs, ring_nodes, ring_pairs
from cgff_cli.values import Rule

Rings = Annotated[int, Rule("rings of struts between the supports and the middle", least=1, most=1000)]
Radius = Annotated[float, Rule("radius of the ring of supports", positive=True)]
Rise = Annotated[float, Rule("height of the dome's crown above the supports", positive=True)]
Slope = Annotated[float, Rule("slope of the diagonals, degrees", least=1, most=80)]
Load = Annotated[float, Rule("load on every strut's top, downwards, put on afterwards")]


def dome(
    title: str,
    sides: int,
    rings: int,
    size: tuple[float, float, float],
    steps: Sequence[int],
    loads: tuple[float, float],
) -> Equilibrium:
    """Return a dome in balance without its loads, self-stress 1 in the innermost ridges.

    size  : radius and rise of the dome, slope of its diagonals (degrees)
    steps : how far round the next ring, from strut i, ridges and diagonals end: 0 alone straight outwards,
            0 and 1 on either side, the rings then turned by half a step against each other
    loads : on every strut's top, and weight of all elements per rest length
    """
    load, weight = loads
    radius, rise, slope = size
    turn = pi / sides if len(steps) > 1 else 0.0
    r = radius * np.arange(1, rings + 2) / (rings + 1)
    z = rise * (1.0 - (r / radius) ** 2)
    z[-1] = 0.0
    run = np.sqrt(r[:-1] ** 2 + r[1:] ** 2 - 2.0 * cos(turn) * r[:-1] * r[1:])
    feet = z[1:] - run * tan(radians(slope))
    turns = [turn * (rings - ring) for ring in range(rings)]
    X = ring_nodes(sides, np.concatenate([r[:-1], r[:-1], r[-1:]]), [*turns, *turns, 0.0], 0.0)
    X[:, 2] = np.repeat(np.concatenate([z[:-1], feet, z[-1:]]), sides)
    tops = range(rings * sides)
    held = range(2 * rings * sides, len(X))
    names = [f"{kind}{ring + 1}_{i + 1}" for kind in "tb" for ring in range(rings) for i in range(sides)]
    return Equilibrium(
        title=f"{title} dome of {rings} rings of {sides} struts",
        node_names=[*names, *(f"s{i + 1}" for i in range(sides))],
        coordinates=X,
        members=_members(sides, rings, steps, _stress(sides, len(steps), turn, r, z, feet)),
        answer="by statics, ring by ring from the inside; groups are numbered outwards",
        supports=dict.fromkeys(held, "xyz"),
        weight=weight,
        added_loads=dict.fromkeys(tops, (0.0, 0.0, -load)) if load else {},
    )


def _stress(
    sides: int, ways: int, turn: float, r: np.ndarray, z: np.ndarray, feet: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the force densities of the top ring, and of each ring's members, (rings,); derived here.

    r, z : (rings + 1,) radius and height of the struts' tops, supports last; feet : (rings,) of their feet

    A cut between two rings frees what is inside it: ridges pull that down as hard as diagonals pull it up.
    What comes in over ridges and diagonals at a top goes out over its ridges; struts and hoops balance
    the diagonals at their feet.
    """
    inward = 4.0 * sin(pi / sides) ** 2  # a ring of force density 1 pulls in by this times its radius
    came, out = ways * (r[1:] - cos(turn) * r[:-1]), ways * (cos(turn) * r[1:] - r[:-1])
    climb = z[1:] - feet
    share = (z[:-1] - z[1:]) / climb  # force density of diagonals over that of the ridges above them
    ridge = np.cumprod(np.concatenate([[1.0], (1.0 + share[:-1]) * came[:-1] / out[1:]]))
    diagonal = share * ridge
    return {
        "top": out[:1] / (inward * r[:1]),
        "ridges": ridge,
        "diagonals": diagonal,
        "hoops": diagonal * out / (inward * r[:-1]),
        "struts": -ways * diagonal * climb / (z[:-1] - feet),
    }


def _members(sides: int, rings: int, steps: Sequence[int], q: dict[str, np.ndarray]) -> list[Members]:
    """Return the groups; levels of nodes are tops, feet and supports, each ring by ring outwards."""
    groups = [members("top_ring", "cable", ring_pairs(sides, [0]), q["top"])]
    for ring in range(rings):
        foot, beyond = rings + ring, ring + 1 if ring + 1 < rings else 2 * rings
        ridges = [pair for step in steps for pair in level_pairs(sides, ring, beyond, step)]
        diagonals = [pair for step in steps for pair in level_pairs(sides, foot, beyond, step)]
        groups += [
            members(f"ridges_{ring + 1}", "cable", ridges, q["ridges"][ring]),
            members(f"diagonals_{ring + 1}", "cable", diagonals, q["diagonals"][ring]),
            members(f"hoop_{ring + 1}", "cable", ring_pairs(sides, [foot]), q["hoops"][ring]),
            members(f"struts_{ring + 1}", "strut", level_pairs(sides, ring, foot, 0), q["struts"][ring]),
        ]
    return groups
