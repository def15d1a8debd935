"""Structures whose equilibrium is known without any solver: coordinates, lengths and forces on paper."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import cos, pi, sin, sqrt
from typing import Any

import mpmath
import numpy as np

LAWS = ("paper", "hooke")


@dataclass(frozen=True)
class Members:
    """One group: its kind, EA, node pairs, and the force density each of its members has at the end."""

    kind: str
    EA: float
    pairs: Sequence[tuple[int, int]]
    q: float | Sequence[float]


@dataclass(frozen=True)
class Reference:
    """A structure at its equilibrium: (n, d) coordinates, groups, and what holds and loads it."""

    coordinates: np.ndarray
    groups: Mapping[str, Members]
    supports: Mapping[int, str] = field(default_factory=dict)
    loads: Mapping[int, Sequence[float]] = field(default_factory=dict)

    @property
    def lengths(self) -> np.ndarray:
        """(b,) lengths at equilibrium, groups in order."""
        X = self.coordinates
        return np.array([np.linalg.norm(X[i] - X[j]) for m in self.groups.values() for i, j in m.pairs])

    @property
    def forces(self) -> np.ndarray:
        """(b,) forces at equilibrium, tension > 0."""
        q = [np.broadcast_to(m.q, len(m.pairs)) for m in self.groups.values()]
        return np.concatenate(q) * self.lengths

    def scene(self, law: str, perturbation: float = 0.0, seed: int = 0) -> dict[str, Any]:
        """Return the mapping of a scene file whose answer this is, started off the answer.

        Rest lengths follow from the forces: l0 = l - t / EA (paper), l0 = EA l / (EA + t) (hooke).
        Every free coordinate of the start is off by up to `perturbation` times the mean length.
        """
        start = self.coordinates + self._noise(perturbation, seed)
        scene: dict[str, Any] = {"name": "reference", "law": law}
        scene["nodes"] = {f"n{row}": point for row, point in enumerate(start.tolist())}
        scene["elements"] = self._elements(law)
        if self.supports:
            scene["supports"] = {f"n{row}": axes for row, axes in self.supports.items()}
        if self.loads:
            scene["loads"] = {f"n{row}": [float(f) for f in load] for row, load in self.loads.items()}
        return scene

    def _noise(self, perturbation: float, seed: int) -> np.ndarray:
        reach = perturbation * self.lengths.mean()
        noise = np.random.default_rng(seed).uniform(-reach, reach, self.coordinates.shape)
        for row, axes in self.supports.items():
            noise[row, ["xyz".index(axis) for axis in axes]] = 0.0
        return noise

    def _elements(self, law: str) -> dict[str, Any]:
        elements, first = {}, 0
        for name, members in self.groups.items():
            rows = slice(first, first + len(members.pairs))
            length, force, EA = self.lengths[rows], self.forces[rows], members.EA
            rest = length - force / EA if law == "paper" else EA * length / (EA + force)
            elements[name] = {
                "kind": members.kind,
                "EA": EA,
                "rest_length": rest.tolist(),
                "pairs": [[f"n{i}", f"n{j}"] for i, j in members.pairs],
            }
            first = rows.stop
        return elements


def prism(n: int, *, radius: float = 1.0, height: float = 2.0) -> Reference:
    """n-gonal prism, twisted by 90 - 180/n degrees; q of sides, verticals, struts 1/(2 sin(pi/n)), 1, -1.

    Verticals join bottom i to top i, struts bottom i to top i + 1; top i is turned by the twist
    against bottom i.
    """
    twist = pi / 2.0 - pi / n
    ring = [2.0 * pi * i / n for i in range(n)]
    bottom = [(radius * cos(a), radius * sin(a), 0.0) for a in ring]
    top = [(radius * cos(a + twist), radius * sin(a + twist), height) for a in ring]
    sides = [(i, (i + 1) % n) for i in range(n)] + [(n + i, n + (i + 1) % n) for i in range(n)]
    groups = {
        "sides": Members("cable", 100.0, sides, 0.5 / sin(pi / n)),
        "verticals": Members("cable", 100.0, [(i, n + i) for i in range(n)], 1.0),
        "struts": Members("strut", 1000.0, [(i, n + (i + 1) % n) for i in range(n)], -1.0),
    }
    return Reference(np.array(bottom + top), groups)


def crossed_square(side: float = 1.0, shear: float = 0.0) -> Reference:
    """X-module: square or rhomboid of cables with force density 1, struts on the diagonals with -1."""
    points = side * np.array([(0.0, 0.0), (1.0, 0.0), (1.0 + shear, 1.0), (shear, 1.0)])
    groups = {
        "cables": Members("cable", 50.0, [(0, 1), (1, 2), (2, 3), (3, 0)], 1.0),
        "struts": Members("strut", 500.0, [(0, 2), (1, 3)], -1.0),
    }
    return Reference(points, groups)


def expanded_octahedron(strut: float = 4.0) -> Reference:
    """Six struts in parallel pairs half a strut apart, 24 cables; q_strut / q_cable = -3/2."""
    half, quarter = strut / 2.0, strut / 4.0
    ends = [(u * half, v * quarter, 0.0) for v in (-1, 1) for u in (-1, 1)]
    points = np.array([np.roll(end, axis) for axis in range(3) for end in ends])
    struts = [(2 * s, 2 * s + 1) for s in range(6)]
    cable = quarter * sqrt(6.0)
    reach = [(i, j) for i in range(12) for j in range(i + 1, 12)]
    cables = [(i, j) for i, j in reach if abs(np.linalg.norm(points[i] - points[j]) - cable) < 1e-9 * strut]
    groups = {
        "cables": Members("cable", 100.0, cables, 1.0),
        "struts": Members("strut", 1000.0, struts, -1.5),
    }
    return Reference(points, groups)


def hypar_net(cells: int = 6, *, curvature: float = 0.1, load: float = 0.5) -> Reference:
    """Net on a unit grid at z = c (x^2 - y^2); q_x - q_y = load / (2 c) carries a load on every free node."""
    side = range(cells + 1)
    spots = [(i, j) for j in side for i in side if not {i, j} <= {0, cells}]
    row = {spot: r for r, spot in enumerate(spots)}
    plan = np.array(spots) - cells / 2.0
    points = np.column_stack([plan, curvature * (plan[:, 0] ** 2 - plan[:, 1] ** 2)])
    rim = [spot for spot in spots if {0, cells} & set(spot)]
    inner = range(1, cells)
    sagging = [(row[i, j], row[i + 1, j]) for j in inner for i in range(cells)]
    hogging = [(row[i, j], row[i, j + 1]) for i in inner for j in range(cells)]
    groups = {
        "sagging": Members("cable", 1000.0, sagging, 2.5 + load / (2.0 * curvature)),
        "hogging": Members("cable", 1000.0, hogging, 2.5),
    }
    loads = {row[spot]: (0.0, 0.0, -load) for spot in spots if spot not in rim}
    return Reference(points, groups, {row[spot]: "xyz" for spot in rim}, loads)


def hanging_chain(links: int = 5) -> Reference:
    """Cables in a line under a support, weight 1 at each node; link i carries all weights below it."""
    points = np.array([(0.0, 0.0, -1.5 * i) for i in range(links + 1)])
    pairs = [(i, i + 1) for i in range(links)]
    q = [(links - i) / 1.5 for i in range(links)]
    loads = dict.fromkeys(range(1, links + 1), (0.0, 0.0, -1.0))
    return Reference(points, {"links": Members("cable", 80.0, pairs, q)}, {0: "xyz"}, loads)


def bracket(load: float = 30.0) -> Reference:
    """Strut and tie from a wall to a loaded tip, a 3-4-5 triangle: tie 5/3, strut -4/3 of the load."""
    points = np.array([(0.0, 0.0), (0.0, 3.0), (4.0, 0.0)])
    groups = {
        "tie": Members("cable", 1000.0, [(1, 2)], load / 3.0),
        "strut": Members("strut", 2000.0, [(0, 2)], -load / 3.0),
    }
    return Reference(points, groups, {0: "xy", 1: "xy"}, {2: (0.0, -load)})


def stiffness(law: str, EA: float, rest_length: float) -> float:
    """Return k in force = k (l - l0)."""
    return EA if law == "paper" else EA / rest_length


def v_height(law: str, EA: float, rest_length: float, half_span: float, load: float, guess: float) -> float:
    """Return the distance of a V's loaded node from the line of its two supports, 30 digits deep.

    One scalar equation: 2 k (l - l0) y / l = load, with l^2 = half_span^2 + y^2. A load pressing the
    node towards the supports' line is negative.
    """
    with mpmath.workdps(30):
        k = stiffness(law, EA, rest_length)

        def unbalance(y: mpmath.mpf) -> mpmath.mpf:
            length = mpmath.sqrt(mpmath.mpf(half_span) ** 2 + y**2)
            return 2 * k * (length - rest_length) * y / length - load

        return float(mpmath.findroot(unbalance, guess))
