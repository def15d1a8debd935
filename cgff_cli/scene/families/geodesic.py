"""Geodesic spheres of struts that do not touch, by the symmetry of the icosahedron."""

from math import acos, cos, pi, sin, sqrt
from typing import Annotated

import numpy as np

from cgff_cli.scene.equilibrium import Equilibrium, Prestress, members, tightened
from cgff_cli.scene.families.symmetric import least_push, rotations_of, turned_about
from cgff_cli.values import Rule

EXAMPLES = (
    "cgff new geodesic",
    "cgff new geodesic --frequency 4 --radius 10 --noise 0.02 -o sphere.yaml",
)


def equilibrium(
    *,
    frequency: Annotated[int, Rule("parts of each edge of the icosahedron", least=1, most=16)] = 2,
    radius: Annotated[float, Rule("distance of the outermost nodes from the centre", positive=True)] = 1.0,
    ratio: Annotated[float, Rule("force density of edges over that of cuts", least=0.1, most=10)] = 1.0,
    prestress: Prestress = 10.0,
) -> Equilibrium:
    """Geodesic sphere: a strut beside every edge of a truncated geodesic net of cables.

    An icosahedron's faces, each parted into f^2 triangles, make a net of 30 f^2 edges. As in `polyhedron`
    every vertex is cut off, which leaves a polygon of cables (cuts); cables on the edges join polygons, and
    beside each a strut joins their next nodes: 60 f^2 nodes, 90 f^2 cables, 30 f^2 struts.

    The nodes are the images of f^2 points under the 60 rotations, and the points a null vector of the
    stress, which comes with the least push of the struts that gives one: Connelly and Back's construction
    (1998), here with more points than one. With r the ratio, their force density nears that of a flat net,
    -r/(1 + 2 r), as 1/f^2.
    """
    half = acos(1.0 / sqrt(5.0)) / 2.0
    fifth = turned_about((0.0, 0.0, 1.0), 2.0 * pi / 5.0)
    turn = turned_about((sin(half), 0.0, cos(half)), pi)
    rotations = rotations_of(fifth, turn)
    back, following = _net(frequency, np.array([(0.0, 0.0, 1.0), turn[:, 2], fifth @ turn[:, 2]]), rotations)
    own = np.arange(len(back))
    once = own[own < back]
    cuts, edges = np.column_stack([own, following]), np.column_stack([once, back[once]])
    struts = following[edges]
    cables = _pull(cuts, rotations) + ratio * _pull(edges, rotations)
    push, points = least_push(cables, _pull(struts, rotations))
    X = _images(points.reshape(-1, 3), rotations)
    X *= radius / np.linalg.norm(X, axis=1).max()
    groups = (
        members("cuts", "cable", cuts, 1.0),
        members("edges", "cable", edges, ratio),
        members("struts", "strut", struts, push),
    )
    answer = f"by symmetry, force densities of cuts, edges and struts as 1 : {ratio:.10g} : {push:.10g}"
    title = f"Geodesic sphere of frequency {frequency}"
    return tightened(Equilibrium(title, [f"n{node + 1}" for node in own], X, groups, answer), prestress)


def _net(frequency: int, corners: np.ndarray, rotations: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return for each directed edge of the net its reverse, and the next one round its start, (60 f^2,).

    Edge 60 o + g is image g of edge o of the face with those corners (3, 3): those along its first side,
    either way, for the face's own turns make the others of them. The next edge ends in the third corner
    of the triangle on an edge's left.
    """
    side, other = np.array([-1, 1, 0]), np.array([-1, 0, 1])
    grid = [
        np.array((i, j, frequency - i - j)) for i in range(frequency + 1) for j in range(frequency + 1 - i)
    ]
    edges = [(s, s + side, s + other) for s in grid if s[0]]
    edges += [(s, s - side, s - other) for s in grid if s[1] and s[2]]
    start, end, third = np.array(edges).transpose(1, 0, 2) @ corners
    places = _images(_unit(2.0 * start + end), rotations)
    table = np.einsum("gij,hjk->ghik", rotations, rotations).reshape(-1, 9) @ rotations.reshape(-1, 9).T
    product = table.argmax(axis=1).reshape(len(rotations), -1)

    def everywhere(marks: np.ndarray) -> np.ndarray:
        orbit, rotation = np.divmod((_unit(marks) @ places.T).argmax(axis=1), len(rotations))
        return (len(rotations) * orbit[:, None] + product[:, rotation].T).ravel()

    return everywhere(2.0 * end + start), everywhere(2.0 * start + third)


def _images(points: np.ndarray, rotations: np.ndarray) -> np.ndarray:
    """Return the images (60 k, 3) of points (k, 3), those of the first point first."""
    return np.asarray(points[:, None, None] @ rotations.transpose(0, 2, 1)).reshape(-1, 3)


def _unit(points: np.ndarray) -> np.ndarray:
    return np.asarray(points / np.linalg.norm(points, axis=1, keepdims=True))


def _pull(pairs: np.ndarray, rotations: np.ndarray) -> np.ndarray:
    """Return what members of force density 1 pull from f^2 points whose images they join, (3 f^2, 3 f^2)."""
    order = len(rotations)
    (i, g), (j, h) = (np.divmod(ends, order) for ends in pairs.T)
    count = int(pairs.max()) // order + 1
    pull = np.zeros((count, count, 3, 3))
    turns = rotations[g].transpose(0, 2, 1) @ rotations[h]
    np.add.at(pull, (i, i), np.eye(3))
    np.add.at(pull, (j, j), np.eye(3))
    np.add.at(pull, (i, j), -turns)
    np.add.at(pull, (j, i), -turns.transpose(0, 2, 1))
    return pull.transpose(0, 2, 1, 3).reshape(3 * count, 3 * count) / order
