"""Scene -> rows of arrays. Names stay behind; this is all the mechanics ever sees."""

from dataclasses import dataclass

import numpy as np

from cgff_cli.errors import Problem, SceneError
from cgff_cli.scene.physics import component_labels
from cgff_cli.scene.scene import AXES, Scene


@dataclass(frozen=True, eq=False)
class Structure:
    """b elements between n nodes in d dimensions; element e runs from node start[e] to end[e].

    coordinates  : (n, d) start shape          stiffness    : (b,) k in force = k (l - l0)
    start, end   : (b,) node rows              rest_lengths : (b,) l0
    tension_only : (b,) bool, cables           free         : (n, d) bool, not held by a support
    loads        : (n, d) nodal forces
    """

    coordinates: np.ndarray
    start: np.ndarray
    end: np.ndarray
    stiffness: np.ndarray
    rest_lengths: np.ndarray
    tension_only: np.ndarray
    free: np.ndarray
    loads: np.ndarray

    def at_nodes(self, values: np.ndarray) -> np.ndarray:
        """Return (n,) sums over each node's elements of (b,) values."""
        n = len(self.free)
        return np.bincount(self.start, values, n) + np.bincount(self.end, values, n)

    @property
    def part_count(self) -> int:
        """How many parts there are that no element joins."""
        return int(np.maximum.reduce(self._parts(slice(None)))) + 1

    def _parts(self, which: np.ndarray | slice) -> np.ndarray:
        """Return (n,) int: the connected part of each node; which: elements that join."""
        return component_labels(len(self.free), np.array((self.start, self.end)).T[which])

    def is_tied(self, which: np.ndarray | slice = slice(None)) -> bool:
        """Return whether elements, all or some, (b,) bool, tie every node to one that nothing can move."""
        label = self._parts(which)
        held = label[~self.free.any(axis=1)]
        return bool(np.bincount(held, minlength=int(label.max()) + 1).all())


def refuse_geometry(scene: Scene) -> None:
    """Raise SceneError, placed at its elements, where a scene is a geometry."""
    if scene.is_geometry:
        message = (
            "elements: without rest_length this is a geometry, and has no forces; "
            "`cgff prestress` finds rest lengths that hold it"
        )
        raise SceneError([Problem(scene.path, *scene.elements_at, message)])


def from_scene(scene: Scene) -> Structure:
    """Return the arrays of a scene; both elastic laws, eq. (2) and Hooke's, become one stiffness.

    Raises SceneError for a geometry.
    """
    refuse_geometry(scene)
    n, d = scene.coordinates.shape
    groups = scene.groups
    pairs = np.concatenate([group.pairs for group in groups]).T
    rest_lengths = np.concatenate([group.rest_length for group in groups])
    cables = np.repeat([group.kind == "cable" for group in groups], [len(group.EA) for group in groups])
    free = np.ones((n, d), dtype=bool)
    for row, axes in scene.supports.items():
        free[row, [AXES.index(axis) for axis in axes]] = False
    loads = loads_of(scene)
    structure = Structure(
        coordinates=np.array(scene.coordinates, dtype=float),
        start=np.ascontiguousarray(pairs[0]),
        end=np.ascontiguousarray(pairs[1]),
        stiffness=stiffness(scene.law, scene.axial_stiffness, rest_lengths),
        rest_lengths=rest_lengths,
        tension_only=cables,
        free=free,
        loads=loads,
    )
    if scene.weights is not None:
        loads += weight_at_nodes(structure, scene.weights * rest_lengths, scene.down)
    return structure


def loads_of(scene: Scene) -> np.ndarray:
    """Return the (n, d) loads of a scene, its weight apart."""
    loads = np.zeros(scene.coordinates.shape)
    for row, load in scene.loads.items():
        loads[row] = load
    return loads


def weight_at_nodes(structure: Structure, weight: np.ndarray, down: np.ndarray) -> np.ndarray:
    """Return (n, d) nodal forces of weight (b,), half of each at either end; down: (d,) unit vector."""
    return structure.at_nodes(0.5 * weight)[:, None] * down


def stiffness(law: str, EA: np.ndarray, rest_lengths: np.ndarray) -> np.ndarray:
    """Return k in force = k (l - l0): EA under law `paper`, eq. (2), EA / l0 under `hooke`."""
    return EA if law == "paper" else EA / rest_lengths
