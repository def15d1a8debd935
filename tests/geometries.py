"""Shapes from formulas, without rest lengths: what `prestress` is asked to hold, and what it cannot."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from math import cos, pi, sin, sqrt

import numpy as np

import cgff_cli
from cgff_cli.scene.scene import Group, Scene

Pairs = Iterable[tuple[int, int]]
OTHER = {"cable": "strut", "strut": "cable"}


def geometry(
    X: object,
    groups: Mapping[str, tuple[str, Pairs]],
    supports: Mapping[int, str] | None = None,
    loads: Mapping[int, Sequence[float]] | None = None,
    law: str = "hooke",
) -> Scene:
    """Return a geometry; groups: name -> kind and pairs; EA 1000 of cables and 10 000 of struts."""
    X = np.array(X, dtype=float)
    rows = {name: np.array(list(pairs)).reshape(-1, 2) for name, (_, pairs) in groups.items()}
    made = tuple(
        Group(
            name,
            kind,
            rows[name],
            np.full(len(rows[name]), 1e3 if kind == "cable" else 1e4),
            np.full(len(rows[name]), np.nan),
        )
        for name, (kind, _) in groups.items()
    )
    names = tuple(f"n{row}" for row in range(len(X)))
    pulled = {row: tuple(map(float, load)) for row, load in (loads or {}).items()}
    return Scene("shape", law, names, X, made, dict(supports or {}), pulled)


def bare(scene: Scene) -> Scene:
    """Return a scene without its rest lengths."""
    return scene.with_rest_lengths(np.full(scene.element_count, np.nan))


def swapped(scene: Scene) -> Scene:
    """Return the same with cables for struts and struts for cables: stressed the other way round."""
    return replace(scene, groups=tuple(replace(own, kind=OTHER[own.kind]) for own in scene.groups))


def of_one_kind(scene: Scene, kind: str) -> Scene:
    return replace(scene, groups=tuple(replace(own, kind=kind) for own in scene.groups))


def moved(scene: Scene, by: float, seed: int) -> Scene:
    """Return a shape with all nodes off by up to `by` of the mean node distance from the centre."""
    X = scene.coordinates
    off = np.random.default_rng(seed).uniform(-by, by, X.shape) * np.linalg.norm(X - X.mean(0), axis=1).mean()
    return replace(scene, coordinates=X + off)


def prism(
    n: int, ring: int = 1, jump: int = 1, top: float = 1.0, height: float = 1.5, off: float = 0.0
) -> Scene:
    """Return a prism: rings that join every `ring`-th node, verticals that go `jump` nodes on, taper `top`.

    Struts turn by 270 - 180 jump / n degrees and verticals by 360 jump / n more, so that both pull along the
    tangent alike; `off` (degrees) spoils that.
    """
    bottom = 2 * pi / n * np.arange(n)
    turned = bottom + 1.5 * pi - pi * jump / n + off * pi / 180
    flat = [np.column_stack((r * np.cos(a), r * np.sin(a))) for r, a in ((1.0, bottom), (top, turned))]
    X = np.column_stack((np.concatenate(flat), np.repeat([0.0, height], n)))
    return geometry(
        X,
        {
            "bottom": ("cable", [(i, (i + ring) % n) for i in range(n)]),
            "top": ("cable", [(n + i, n + (i + ring) % n) for i in range(n)]),
            "verticals": ("cable", [(i, n + (i + jump) % n) for i in range(n)]),
            "struts": ("strut", [(i, n + i) for i in range(n)]),
        },
    )


def x_module(corners: object = ((0, 0), (1, 0), (1, 1), (0, 1))) -> Scene:
    """Return four nodes with cables around and two struts across."""
    ring = [(0, 1), (1, 2), (2, 3), (3, 0)]
    return geometry(corners, {"ring": ("cable", ring), "struts": ("strut", [(0, 2), (1, 3)])})


def wheel(n: int) -> Scene:
    """Return a regular 2n-gon with cables around and struts through the centre."""
    angles = pi / n * np.arange(2 * n)
    X = np.column_stack((np.cos(angles), np.sin(angles)))
    rim = [(i, (i + 1) % (2 * n)) for i in range(2 * n)]
    return geometry(X, {"rim": ("cable", rim), "struts": ("strut", [(i, i + n) for i in range(n)])})


def solid(name: str) -> Scene:
    """Return a solid with a cable along each edge and a strut between opposite corners."""
    g = (1 + sqrt(5)) / 2
    signs = np.array(np.meshgrid(*[(-1, 1)] * 3)).reshape(3, -1).T

    def rectangles(short: float, long: float) -> np.ndarray:
        """Return the corners of three rectangles, one across each axis."""
        return np.array(
            [np.roll([0, a, b], k) for a in (-short, short) for b in (-long, long) for k in range(3)]
        )

    corners = {
        "octahedron": np.concatenate((np.eye(3), -np.eye(3))),
        "cube": signs,
        "icosahedron": rectangles(1, g),
        "dodecahedron": np.concatenate((signs, rectangles(1 / g, g))),
        "cuboctahedron": rectangles(1, 1),
    }
    X = np.asarray(corners[name], dtype=float)
    pairs = list(combinations(range(len(X)), 2))
    far = {pair: float(np.linalg.norm(X[pair[0]] - X[pair[1]])) for pair in pairs}
    edge, across = min(far.values()), max(far.values())
    return geometry(
        X,
        {
            "edges": ("cable", [pair for pair in pairs if far[pair] < 1.001 * edge]),
            "struts": ("strut", [pair for pair in pairs if far[pair] > 0.999 * across]),
        },
    )


def dome(n: int, rings: int, levy: bool) -> Scene:
    """Return a cable dome: radial trusses (Geiger), or each ring half a side behind the next (Levy)."""
    turns = [pi / n * ((rings - k) % 2) * levy for k in range(rings + 1)]
    radii = np.arange(1, rings + 2) / (rings + 1)
    upper = list(zip(radii, 0.3 * (1 - radii**2), turns, strict=True))
    lower = [(r, z - 0.25, turn) for r, z, turn in upper[:-1]]
    angles = 2 * pi / n * np.arange(n)
    X = [[r * cos(a + turn), r * sin(a + turn), z] for r, z, turn in upper + lower for a in angles]
    low = (rings + 1) * n  # the first of the lower nodes
    sides = {True: (0, -1), False: (0, 1)} if levy else {True: (0,), False: (0,)}
    steps = [
        (n * k + i, n * (k + 1) + (i + side) % n)
        for k in range(rings)
        for i in range(n)
        for side in sides[turns[k + 1] > turns[k]]
    ]
    around = [(n * k + i, n * k + (i + 1) % n) for k in range(rings) for i in range(n)]
    return geometry(
        X,
        {
            "ridges": ("cable", steps),
            "diagonals": ("cable", [(low + a, b) for a, b in steps]),
            "hoops": ("cable", [(low + a, low + b) for a, b in around]),
            "crown": ("cable", around[:n]),
            "struts": ("strut", [(i, low + i) for i in range(rings * n)]),
        },
        supports=dict.fromkeys(range(rings * n, low), "xyz"),
    )


def net(side: int, rise: float) -> Scene:
    """Return a net of side x side nodes on a hyperbolic paraboloid, its rim held."""
    along = np.linspace(-1, 1, side)
    X = [[x, y, rise * x * y] for x in along for y in along]
    inner = range(1, side - 1)
    lines = {
        "along_x": [(side * i + j, side * (i + 1) + j) for i in range(side - 1) for j in inner],
        "along_y": [(side * i + j, side * i + j + 1) for i in inner for j in range(side - 1)],
    }
    rim = [side * i + j for i in range(side) for j in range(side) if not (i in inner and j in inner)]
    groups = {name: ("cable", pairs) for name, pairs in lines.items()}
    return geometry(X, groups, supports=dict.fromkeys(rim, "xyz"))


def stack(n: int, stages: int) -> Scene:
    """Return prisms on top of each other that share their rings: struts meet at nodes (class 2)."""
    turn = 1.5 * pi - pi / n
    X = [
        [cos(2 * pi * i / n + s * turn), sin(2 * pi * i / n + s * turn), 1.5 * s]
        for s in range(stages + 1)
        for i in range(n)
    ]
    rings = [(n * s + i, n * s + (i + 1) % n) for s in range(stages + 1) for i in range(n)]
    steps = [(n * s + i, n * (s + 1), i) for s in range(stages) for i in range(n)]
    return geometry(
        X,
        {
            "rings": ("cable", rings),
            "verticals": ("cable", [(a, b + (i + 1) % n) for a, b, i in steps]),
            "struts": ("strut", [(a, b + i) for a, b, i in steps]),
        },
    )


def truss(panels: int, load: float) -> Scene:
    """Return a plane cantilever, pulled down at its upper nodes and outwards at its tip."""
    X = [[x, y] for x in range(panels + 1) for y in (0, 1)]
    steps = range(panels)
    return geometry(
        X,
        {
            "bottom": ("strut", [(2 * i, 2 * i + 2) for i in steps]),
            "top": ("cable", [(2 * i + 1, 2 * i + 3) for i in steps]),
            "uprights": ("strut", [(2 * i + 2, 2 * i + 3) for i in steps]),
            "diagonals": ("cable", [(2 * i + 1, 2 * i + 2) for i in steps]),
        },
        supports={0: "xy", 1: "xy"},
        loads={2 * i + 3: (load if i == panels - 1 else 0.0, -load) for i in steps},
    )


def grid(side: int, load: float) -> Scene:
    """Return a double-layer grid, square on square, on its corners: cables below, else struts."""
    top = [[x, y, 0.7] for x in range(side) for y in range(side)]
    low = side - 1
    X = top + [[x + 0.5, y + 0.5, 0.0] for x in range(low) for y in range(low)]

    def under(x: int, y: int) -> int:
        return side * side + low * x + y

    upper = [(side * x + y, side * x + y + 1) for x in range(side) for y in range(low)]
    upper += [(side * x + y, side * (x + 1) + y) for x in range(low) for y in range(side)]
    lower = [(under(x, y), under(x, y + 1)) for x in range(low) for y in range(low - 1)]
    lower += [(under(x, y), under(x + 1, y)) for x in range(low - 1) for y in range(low)]
    webs = [
        (side * (x + i) + y + j, under(x, y))
        for x in range(low)
        for y in range(low)
        for i in (0, 1)
        for j in (0, 1)
    ]
    corners = (0, side - 1, side * (side - 1), side * side - 1)
    loads = dict.fromkeys(range(side * side), (0.0, 0.0, -load)) if load else {}
    return geometry(
        X,
        {"upper": ("strut", upper), "lower": ("cable", lower), "webs": ("strut", webs)},
        supports=dict.fromkeys(corners, "xyz"),
        loads=loads,
    )


def family(name: str, **parameters: object) -> Scene:
    """Return the shape of a family's scene."""
    return bare(cgff_cli.new(name, **parameters))
