"""Structures whose states, mechanisms and stability are known by theory.

Counts are Maxwell's rule, f - r - b = m - s (f free directions, r rigid motions, b elements), and one of the
two by an argument of its own, named beside each.
"""

from collections.abc import Iterator
from itertools import combinations
from math import cos, pi, sin
from typing import NamedTuple

import numpy as np

import cgff_cli
from cgff_cli.scene.scene import Scene
from tests.closed_forms import references
from tests.closed_forms.references import Members, Reference

Pairs = list[tuple[int, int]]


class Known(NamedTuple):
    """A structure in balance, and what theory tells of it.

    unstable: how many independent motions release energy; stiffened: whether stress resists all mechanisms
    """

    name: str
    scene: Scene
    states: int
    mechanisms: int
    word: str
    stiffened: bool
    unstable: int = 0
    why: str = ""


def polygon(n: int, height: float = 0.0, turn: float = 0.0) -> np.ndarray:
    """Return (n, 3) corners on the unit circle."""
    angles = [2.0 * pi * i / n + turn for i in range(n)]
    return np.array([(cos(a), sin(a), height) for a in angles])


def around(n: int, first: int = 0) -> Pairs:
    """Return the sides of a polygon."""
    return [(first + i, first + (i + 1) % n) for i in range(n)]


def free(name: str, X: object, pairs: Pairs, states: int, mechanisms: int, why: str, **held: object) -> Known:
    """Return bars without force: neutral where a mechanism is, as no stress resists it."""
    word = "neutral" if mechanisms else "stable"
    bars = {"bars": Members("strut", 100.0, pairs, 0.0)}
    scene = cgff_cli.from_dict(Reference(np.array(X, dtype=float), bars, **held).scene("paper"))
    return Known(name, scene, states, mechanisms, word, not mechanisms, 0, why)


def stressed(name: str, body: Reference, states: int, mechanisms: int, why: str, unstable: int = 0) -> Known:
    """Return a structure with stress; unstable: see Known."""
    word = "unstable" if unstable else "stable"
    scene = cgff_cli.from_dict(body.scene("paper"))
    return Known(name, scene, states, mechanisms, word, not unstable, unstable, why)


def reversed_stress(body: Reference) -> Reference:
    """Return a structure with every force turned round, and cables for struts."""
    swap = {"cable": "strut", "strut": "cable"}
    groups = {
        name: Members(swap[own.kind], own.EA, own.pairs, -np.array(own.q))
        for name, own in body.groups.items()
    }
    return Reference(body.coordinates, groups, body.supports, body.loads)


def flat(body: Reference) -> Reference:
    """Return a plane structure in space."""
    X = np.column_stack((body.coordinates, np.zeros(len(body.coordinates))))
    return Reference(X, body.groups)


def frameworks() -> Iterator[Known]:
    """Yield bars without force."""
    scattered = np.array([[0.0, 0, 0], [2, 0.3, 0.1], [0.4, 1.9, -0.2], [0.1, 0.7, 2.1], [1.6, 1.7, 1.3]])
    for d, sizes in ((2, (3, 4, 5)), (3, (4, 5))):
        for n in sizes:
            rank = d * n - d * (d + 1) // 2
            pairs = list(combinations(range(n), 2))
            why = "complete graphs are rigid (Laman, Whiteley)"
            yield free(f"K{n} in {d}-D", scattered[:n, :d], pairs, len(pairs) - rank, 0, why)
    for n in (4, 5, 6):
        yield free(f"{n}-gon", polygon(n)[:, :2], around(n), 0, n - 3, "a plane linkage of n bars")
    for n in (3, 4, 5):
        poles = [*polygon(n), (0.0, 0.0, 0.8), (0.0, 0.0, -0.7)]
        pairs = around(n) + [(i, pole) for i in range(n) for pole in (n, n + 1)]
        yield free(f"bipyramid over a {n}-gon", poles, pairs, 0, 0, "convex and triangulated (Cauchy, Dehn)")
    cube = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    edges = [(i, j) for i, j in combinations(range(8), 2) if bin(i ^ j).count("1") == 1]
    yield free("cube", cube, edges, 0, 6, "three bars of three directions at a node carry nothing")
    for p, q in ((1, 3), (2, 3), (3, 3)):
        X = [(i, j) for j in range(q + 1) for i in range(p + 1)]
        row = {spot: r for r, spot in enumerate(X)}
        pairs = [(row[s], row[t]) for s, t in combinations(X, 2) if abs(s[0] - t[0]) + abs(s[1] - t[1]) == 1]
        yield free(f"grid {p} by {q}", X, pairs, 0, p + q - 1, "p + q - 1 shears (Bolker and Crapo)")
        braces = [(row[0, j], row[1, j + 1]) for j in range(q)]
        braces += [(row[i, 0], row[i + 1, 1]) for i in range(1, p)]
        yield free(f"grid {p} by {q}, braced", X, pairs + braces, 0, 0, "a tree of braces (Bolker and Crapo)")
    bipartite = [(i, j) for i in (0, 2, 4) for j in (1, 3, 5)]
    yield free("K3,3 on a circle", polygon(6)[:, :2], bipartite, 1, 1, "on a conic (Bolker and Roth)")
    off = polygon(6)[:, :2] * np.array([1.0, 1.1, 1.0, 1.0, 1.0, 1.0])[:, None]
    yield free("K3,3 off any conic", off, bipartite, 0, 0, "off every conic (Bolker and Roth)")
    twins = [(0.0, 0.0), (1.0, 0.1), (0.2, 1.0), (3.0, 0.0), (4.0, 0.1), (3.2, 1.0)]
    ladder = [*around(3), *around(3, 3), (0, 3), (1, 4), (2, 5)]
    yield free("two triangles, three equal parallel bars", twins, ladder, 1, 1, "bars meet at infinity")
    twins[5] = (3.2, 1.3)
    yield free("two triangles, three bars askew", twins, ladder, 0, 0, "bars do not meet (Desargues)")
    banana = [(i, j) for own in ((2, 3, 4), (5, 6, 7)) for i, j in combinations(own, 2)]
    banana += [(pole, i) for pole in (0, 1) for i in range(2, 8)]
    nodes = [
        (0, 0, 1),
        (0, 0, -1),
        (1, 0, 0),
        (1.5, 1, 0),
        (1.5, -1, 0.2),
        (-1, 0, 0),
        (-1.6, 1, 0),
        (-1.5, -1, 0),
    ]
    yield free("double banana", nodes, banana, 1, 1, "it hinges about its poles")
    line = [(0.0, 0.0), (1.0, 0.0), (2.5, 0.0)]
    yield free("flat triangle in the plane", line, around(3), 1, 1, "on a line: rank 2")
    space = [(*point, 0.0) for point in line]
    yield free("flat triangle in space", space, around(3), 1, 2, "on a line, of 5 rigid motions: rank 2")
    held = {"supports": {0: "xyz", 2: "xyz"}}
    yield free("two level bars between pins", space, [(0, 1), (1, 2)], 1, 2, "on a line: rank 1", **held)


def tensegrities() -> Iterator[Known]:
    """Yield structures with stress."""
    for n in (3, 4, 5, 6, 8):
        body, m = references.prism(n), 2 * n - 5
        yield stressed(f"prism of {n} sides", body, 1, m, "super-stable (Connelly and Terrell)")
        if n == 3:
            turned = reversed_stress(body)
            yield stressed("prism, stress reversed", turned, 1, m, "its stress falls along it", m)
    why = "24 cables and 6 struts (Pellegrino)"
    yield stressed("expanded octahedron", references.expanded_octahedron(), 1, 1, why)
    square = references.crossed_square()
    yield stressed("crossed square", square, 1, 0, "four points of the plane")
    yield stressed("crossed square, stress reversed", reversed_stress(square), 1, 0, "stiff without stress")
    yield stressed("crossed square in space", flat(square), 1, 1, "stress 1, -1, 1, -1 resists the fold")
    turned = flat(reversed_stress(square))
    yield stressed("D-bar flat in space", turned, 1, 1, "struts around: the fold releases energy", 1)
    for n in (3, 4, 5, 6):
        # Rim 1, spokes -4 sin^2(pi / n): balance at a corner, 2 (1 - cos(2 pi / n)) along the radius.
        X, spokes = np.vstack((polygon(n)[:, :2], (0.0, 0.0))), [(i, n) for i in range(n)]
        groups = {
            "rim": Members("cable", 100.0, around(n), 1.0),
            "spokes": Members("strut", 1000.0, spokes, -4.0 * sin(pi / n) ** 2),
        }
        yield stressed(f"wheel of {n} spokes", Reference(X, groups), 1, 0, "rim and hub, n + 1 nodes")
    for cells in (3, 5):
        f, b = 3 * (cells - 1) ** 2, 2 * cells * (cells - 1)
        yield stressed(
            f"saddle net of {cells} cells", references.hypar_net(cells), 1, f - b + 1, "its plan's"
        )
    for links in (2, 6):
        body = references.hanging_chain(links)
        yield stressed(
            f"hanging chain of {links} links", body, 0, 2 * links - 2, "sideways, but for two rotations"
        )
    yield stressed("wall bracket", references.bracket(), 0, 0, "two bars from a wall")
    level = np.array([(-1.0, 0.0), (1.0, 0.0), (0.0, 0.0)])
    for name, kind, q in (("taut", "cable", 1.0), ("pushed", "strut", -1.0)):
        groups = {"bars": Members(kind, 100.0, [(0, 2), (1, 2)], q)}
        body = Reference(level, groups, {0: "xy", 1: "xy"})
        yield stressed(f"level truss, {name}", body, 1, 1, "on a line: rank 1", int(q < 0.0))


KNOWN = [*frameworks(), *tensegrities()]
