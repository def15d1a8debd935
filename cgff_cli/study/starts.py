"""Where searches for equilibria begin: the scene's start, anywhere about it, and along the softest modes."""

from collections.abc import Iterable, Iterator, Sequence
from math import sqrt

import numpy as np

from cgff_cli.structure import Structure
from cgff_cli.study.levels import levels
from cgff_cli.study.shapes import Shape

REACHES = (0.1, 0.3)
"""How far the node that moves most is put along a mode, over the structure's size."""


def size_of_start(structure: Structure) -> float:
    """Return the diagonal of the box around the start, or the longest rest length if that is more."""
    box = np.linalg.norm(np.ptp(structure.coordinates, axis=0))
    return max(float(box), float(structure.rest_lengths.max()))


def random_start(structure: Structure, seed: int, number: int) -> np.ndarray:
    """Return the start of a number, (n, d): the structure's own for 0, else anywhere in a cube about it.

    The cube stands about the middle of the box around the start, its diagonal is the structure's size;
    what is held stays. Each number has random numbers of its own, whatever is solved beside it.
    """
    X = structure.coordinates
    if number == 0:
        return X
    rng = np.random.default_rng([seed, number])
    middle = 0.5 * (X.min(axis=0) + X.max(axis=0))
    half = 0.5 * size_of_start(structure) / sqrt(X.shape[1])
    return np.where(structure.free, middle + rng.uniform(-half, half, X.shape), X)


def along_modes(structure: Structure, shapes: Iterable[Shape]) -> Iterator[np.ndarray]:
    """Yield starts (n, d) to either side of shapes along their softest modes, softest and nearest first."""
    size = size_of_start(structure)
    for shape in shapes:
        for mode in shape.modes:
            for reach in REACHES:
                for way in (1.0, -1.0):
                    yield shape.coordinates + way * reach * size * mode


def by_energy(shapes: Sequence[Shape]) -> list[Shape]:
    """Return shapes in the order of their energies, the one found first before others that share its own."""
    pairs = zip(levels(shapes), shapes, strict=True)
    return [own for _, own in sorted(pairs, key=lambda pair: (pair[0], pair[1].first_start))]
