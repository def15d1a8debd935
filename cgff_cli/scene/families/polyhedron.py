"""Truncated regular polyhedra, by the symmetry of their rotations."""

from math import acos, cos, pi, sin, sqrt
from typing import Annotated

import numpy as np

from cgff_cli.scene.equilibrium import Equilibrium, Prestress, members, tightened
from cgff_cli.scene.families.symmetric import least_push, rotations_of, turned_about
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new polyhedron --kind tetrahedron",
    "cgff new polyhedron --kind icosahedron --radius 10 --noise 0.05 -o ball.yaml",
)

# Edges that meet at a vertex, and the cosine of the angle at which the centre sees an edge.
SOLIDS = {
    "tetrahedron": (3, -1.0 / 3.0),
    "cube": (3, 1.0 / 3.0),
    "octahedron": (4, 0.0),
    "dodecahedron": (3, sqrt(5.0) / 3.0),
    "icosahedron": (5, 1.0 / sqrt(5.0)),
}


def equilibrium(
    *,
    kind: Annotated[str, Rule("the polyhedron", choices=tuple(SOLIDS))] = "tetrahedron",
    radius: Annotated[float, Rule("distance of the nodes from the centre", positive=True)] = 1.0,
    ratio: Annotated[float, Rule("force density of edges over that of cuts", least=0.01, most=100)] = 1.0,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Truncated regular polyhedron: cables on its edges, struts inside.

    Cutting off every vertex leaves a polygon of cables (cuts) there and a shorter cable on every edge
    (edges). Beside every edge a strut joins the next nodes of the polygons at its two ends.

    The nodes are the images of one point under the polyhedron's rotations, so the balance at one node
    is that at all of them (Connelly and Back 1998): a 3 x 3 matrix, linear in the force densities, must
    have a null vector, and that is the point. The null vector comes with the least push of the struts
    that gives one.
    """
    valence, cosine = SOLIDS[kind]
    cut = turned_about((0.0, 0.0, 1.0), 2.0 * pi / valence)
    half = acos(cosine) / 2.0
    edge = turned_about((sin(half), 0.0, cos(half)), pi)
    strut = cut.T @ edge @ cut
    push, point = _balance(cut, edge, strut, ratio)
    rotations = rotations_of(cut, edge)
    groups = (
        members("cuts", "cable", _orbit(rotations, cut), 1.0),
        members("edges", "cable", _orbit(rotations, edge), ratio),
        members("struts", "strut", _orbit(rotations, strut), push),
    )
    names = [f"n{i + 1}" for i in range(len(rotations))]
    answer = f"by symmetry, force densities of cuts, edges and struts as 1 : {ratio:.10g} : {push:.10g}"
    X = radius * rotations @ point
    return tightened(Equilibrium(f"Truncated {kind}", names, X, groups, answer), prestress)


def _balance(cut: np.ndarray, edge: np.ndarray, strut: np.ndarray, ratio: float) -> tuple[float, np.ndarray]:
    """Return the force density of the struts and the unit point (3,) that it balances."""
    unit = np.eye(3)
    cables = 2.0 * unit - cut - cut.T + ratio * (unit - edge)
    push, point = least_push(cables, unit - (strut + strut.T) / 2.0)
    return push, point / np.linalg.norm(point)


def _orbit(rotations: np.ndarray, step: np.ndarray) -> list[tuple[int, int]]:
    """Return the pairs of node g and node g step, each pair once."""
    apart = np.abs((rotations @ step)[:, None] - rotations[None]).max(axis=(2, 3))
    ends = np.argmin(apart, axis=1).tolist()
    return list(dict.fromkeys((min(pair), max(pair)) for pair in enumerate(ends)))
