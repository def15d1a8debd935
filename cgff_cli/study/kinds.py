"""Shapes sorted by energy, and by the kinds that the symmetries of their scene make of them."""

from dataclasses import replace

import numpy as np

from cgff_cli.structure import Structure
from cgff_cli.study.alignment import size
from cgff_cli.study.levels import levels
from cgff_cli.study.shapes import Nearby, Shape
from cgff_cli.study.symmetries import Symmetries


def by_kind(structure: Structure, shapes: list[Shape]) -> tuple[list[int], list[Shape]]:
    """Return kinds, from 1, and the shapes in the order of energies, the kind found first before its equals.

    All of a kind have one energy, that of the first found, so that rounding does not part them.
    """
    firsts: list[Shape] = []
    symmetries: list[Symmetries] = []
    nearby, widest = Nearby(), max((own.within for own in shapes), default=0.0)
    found: list[tuple[Shape, int]] = []
    for own in shapes:
        whole = float(np.linalg.norm(_spreads(own)))
        near = nearby.to(whole, 2.0 * widest)
        place = next((i for i in near if _is_image(symmetries[i], own, firsts[i])), len(firsts))
        if place == len(firsts):
            firsts.append(own)
            symmetries.append(Symmetries(structure, own.leeway))
            nearby.add(whole)
        one = firsts[place]
        found.append((replace(own, energy=one.energy, energy_floor=one.energy_floor), place))
    level = levels(firsts)
    found.sort(key=lambda pair: (level[pair[1]], pair[1], pair[0].first_start))
    numbers: dict[int, int] = {}
    return [numbers.setdefault(place, len(numbers) + 1) for _, place in found], [own for own, _ in found]


def _is_image(symmetries: Symmetries, own: Shape, other: Shape) -> bool:
    """Return whether a symmetry maps a shape to another; how far they spread tells most apart."""
    within = max(own.within, other.within)
    if (own.stability, own.leeway.kind) != (other.stability, other.leeway.kind):
        return False
    if np.abs(_spreads(own) - _spreads(other)).max() > 2.0 * within:
        return False
    return symmetries.map(own.coordinates, other.coordinates, size(other.coordinates), within)


def _spreads(shape: Shape) -> np.ndarray:
    """Return (d,) spreads of the nodes along the shape's principal axes, whatever the nodes are called.

    Where nodes move by some distance, none changes by more (Weyl).
    """
    X = shape.coordinates
    centred = X - X.mean(axis=0)
    return np.asarray(np.linalg.svd(centred, compute_uv=False) / np.sqrt(len(X)))
