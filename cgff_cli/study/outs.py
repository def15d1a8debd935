"""What a sweep tells of each shape besides how its solve ended: forces, lengths, places and others.

A new word is a function and one entry of OUTS.
"""

from collections.abc import Callable, Sequence
from functools import cached_property, partial

import numpy as np

from cgff_cli.analysis import measures
from cgff_cli.errors import OptionError
from cgff_cli.hints import meant_or_all
from cgff_cli.mechanics import elements
from cgff_cli.scene.scene import AXES, Scene
from cgff_cli.scene.select import pair_of, rows_of_group
from cgff_cli.structure import Structure


class Answers:
    """Shapes of one structure: coordinates (m, n, d), forces and rest_lengths (m, b)."""

    def __init__(
        self, structure: Structure, coordinates: np.ndarray, forces: np.ndarray, rest_lengths: np.ndarray
    ):
        self.structure, self.coordinates = structure, coordinates
        self.forces, self.rest_lengths = forces, rest_lengths

    @cached_property
    def lengths(self) -> np.ndarray:
        """(m, b) lengths of elements, eq. (7)."""
        return self.distances(self.structure.start, self.structure.end)

    def distances(self, start: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Return the distances, (m, c), of c pairs of nodes."""
        vectors = self.coordinates[:, start] - self.coordinates[:, end]
        return elements.lengths(np.moveaxis(vectors, -1, 0))

    @cached_property
    def slack(self) -> np.ndarray:
        """(m, b) bool, cables shorter than their rest lengths."""
        least = elements.least_extensions(self.structure.tension_only)
        return ~elements.taut(self.lengths - self.rest_lengths, least)


Out = Callable[[Answers], np.ndarray]
"""What makes a column, (m,), of shapes; NaN where there is nothing to tell."""


def outs(scene: Scene, words: Sequence[str]) -> dict[str, Out]:
    """Return the columns that words ask for, by name, in order; raises OptionError for a bad word."""
    found: dict[str, Out] = {}
    for word in words:
        name, colon, of = word.partition(":")
        if name not in OUTS:
            raise OptionError(f"{word}: unknown output {name!r}{meant_or_all(name, OUTS)}")
        make, meant = OUTS[name]
        if bool(colon) != bool(meant):
            raise OptionError(f"{word}: must be {f'{name}:{meant}' if meant else name}")
        found |= make(scene, of)
    return found


def _forces(scene: Scene, group: str) -> dict[str, Out]:
    rows = rows_of_group(scene, group)
    ends = {"min": np.minimum, "max": np.maximum}
    return {f"force:{group}.{name}": partial(_force, rows, end) for name, end in ends.items()}


def _force(rows: np.ndarray, end: np.ufunc, shapes: Answers) -> np.ndarray:
    return np.asarray(end.reduce(shapes.forces[:, rows], axis=1))


def _length(scene: Scene, pair: str) -> dict[str, Out]:
    start, end = pair_of(scene, pair)
    return {f"length:{pair}": partial(_distance, np.array([start]), np.array([end]))}


def _distance(start: np.ndarray, end: np.ndarray, shapes: Answers) -> np.ndarray:
    return shapes.distances(start, end)[:, 0]


def _node(scene: Scene, name: str) -> dict[str, Out]:
    row = scene.row_of(name)
    return {f"node:{name}.{AXES[axis]}": partial(_place, row, axis) for axis in range(scene.dimension)}


def _place(row: int, axis: int, shapes: Answers) -> np.ndarray:
    return shapes.coordinates[:, row, axis]


def _slack(shapes: Answers) -> np.ndarray:
    return np.asarray(shapes.slack.sum(axis=1))


def _max_strain(shapes: Answers) -> np.ndarray:
    strains = measures.strains(shapes.lengths, shapes.rest_lengths, shapes.slack)
    rows = zip(strains, shapes.rest_lengths, strict=True)
    return np.array([measures.max_strain(*row) for row in rows], dtype=float)


def _height(shapes: Answers) -> np.ndarray:
    return np.asarray(np.ptp(shapes.coordinates[:, :, -1], axis=1))


OUTS: dict[str, tuple[Callable[[Scene, str], dict[str, Out]], str]] = {
    "force": (_forces, "GROUP"),
    "length": (_length, "A,B"),
    "node": (_node, "NAME"),
    "slack": (lambda scene, of: {"slack": _slack}, ""),
    "max_strain": (lambda scene, of: {"max_strain": _max_strain}, ""),
    "height": (lambda scene, of: {"height": _height}, ""),
}
"""Word -> what makes its columns, and what stands behind its colon."""
