"""Scenes in which a solver has to show one thing each."""

import cgff_cli
from cgff_cli.scene.scene import Scene
from tests.bodies import Bar, scene
from tests.shapes import STRUCTURES

SHIPPED = ["x-module", "hexagon", "prism", "octahedron", "bracket", "cable-net"]


def shipped(name: str) -> Scene:
    return cgff_cli.load(STRUCTURES / f"{name}.yaml")


def pendulum(y: float) -> Scene:
    """A strut from a pin to a node at (0, y) that carries a weight of 1."""
    return scene([(0.0, 0.0), (0.0, y)], [(0, 1, "strut", 100.0, 1.0)], {0: "xy"}, {1: (0.0, -1.0)})


def truss(y: float) -> Scene:
    """Von Mises truss: two struts of rest length 1.2 from pins at x = -1 and 1 to a node at (0, y)."""
    struts: list[Bar] = [(0, 2, "strut", 100.0, 1.2), (1, 2, "strut", 100.0, 1.2)]
    return scene([(-1.0, 0.0), (1.0, 0.0), (0.0, y)], struts, {0: "xy", 1: "xy"})


def level_cable() -> Scene:
    """Two cables level and without force between pins, a weight in the middle: K eta = 0, eta = -1."""
    cables: list[Bar] = [(0, 1, "cable", 100.0, 1.0), (1, 2, "cable", 100.0, 1.0)]
    return scene([(0.0, 0.0), (1.0, 0.0), (2.0, 0.0)], cables, {0: "xy", 2: "xy"}, {1: (0.0, -1.0)})


def kink(y: float) -> Scene:
    """A truss about to snap and a stay that goes slack at y = 0: |eta| has a kink at its least, 5, there."""
    bars: list[Bar] = [
        (0, 3, "strut", 100.0, 1.2),
        (1, 3, "strut", 100.0, 1.2),
        (2, 3, "cable", 100.0, 1.0),
    ]
    points = [(-1.0, 0.0), (1.0, 0.0), (0.0, -1.0), (0.0, y)]
    return scene(points, bars, {0: "xy", 1: "xy", 2: "xy", 3: "x"}, {3: (0.0, -5.0)})


def crossed_struts(*points: tuple[float, float]) -> Scene:
    """Four cables around four points and struts across, prestressed square at rest."""
    around = [(0, 1), (1, 2), (2, 3), (3, 0)]
    cables: list[Bar] = [(i, j, "cable", 50.0, 0.95) for i, j in around]
    return scene(points, [*cables, (0, 2, "strut", 500.0, 1.45), (1, 3, "strut", 500.0, 1.45)])
