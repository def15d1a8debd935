"""Kinds of shapes: those that a symmetry of the scene maps to each other are one kind.

A symmetry renames nodes so that elements go to elements of the same kind, stiffness and rest length, and
moves space, mirror images included, so that supports and loads go to such. Two shapes are of one kind where a
renaming takes all distances of the one to those of the other. Loads, and directions that supports hold, are
points of their own beside the nodes: what keeps all distances then keeps them as well; but for directions
that the rotations left to a shape turn away. The renaming is found by refinement and backtracking; the group
of all symmetries is never listed.
"""

import numpy as np

from cgff_cli.structure import Structure
from cgff_cli.study.sameness import TURNS, Leeway

SAME_VALUE = 1e-9
"""Relative difference up to which numbers of a scene are meant to be equal."""


class Symmetries:
    """What of a structure its symmetries keep, apart from a shape.

    owners  : (p,) the node of each point; points are nodes first, then the ends of loads and of directions
    offsets : (p, d) where a point is from its node, over the size of a shape
    joins   : (p, p) which sort of connection is between two points, 0 for none
    colours : (p,) points of other colours are no images of each other
    """

    def __init__(self, structure: Structure, leeway: Leeway):
        n, d = structure.coordinates.shape
        held = d - structure.free.sum(axis=1)
        owners, offsets, colours = [np.arange(n)], [np.zeros((n, d))], [held]
        loads = structure.loads * structure.free
        for number, (nodes, arrows) in enumerate((_arrows(loads), *_held(structure.free, leeway))):
            owners.append(nodes)
            offsets.append(arrows)
            colours.append(np.full(len(nodes), d + 1 + number))
        self.owners, self.offsets = np.concatenate(owners), np.concatenate(offsets)
        self.colours = np.concatenate(colours)
        p = len(self.owners)
        self.joins = np.zeros((p, p), dtype=int)
        own = np.arange(n, p)
        self.joins[own, self.owners[own]] = self.joins[self.owners[own], own] = 1
        sorts = _sorts(structure)
        for row in np.argsort(sorts, kind="stable").tolist():  # parallel elements: a number for all of them
            i, j = structure.start[row], structure.end[row]
            self.joins[i, j] = self.joins[j, i] = self.joins[i, j] * (sorts.max() + 3) + 2 + sorts[row]

    def map(self, X: np.ndarray, Y: np.ndarray, size: float, tolerance: float) -> bool:
        """Return whether a symmetry maps shape X (n, d) to shape Y, places within the tolerance."""
        near = 2.0 * tolerance
        A, B = (self._distances(shape, size) for shape in (X, Y))
        may = self.colours[:, None] == self.colours
        (joins, mine), (others, theirs) = map(self._sorted, (A, B))
        for i, row in enumerate(may):
            row &= (others == joins[i]).all(axis=1) & (np.abs(theirs - mine[i]) <= near).all(axis=1)
        return self._is_completed(A, B, may, near)

    def _distances(self, X: np.ndarray, size: float) -> np.ndarray:
        P = X[self.owners] + size * self.offsets
        return np.sqrt(sum((axis[:, None] - axis) ** 2 for axis in P.T))

    def _sorted(self, A: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return each point's connections and distances, both (p, p), sorted in that order."""
        order = np.lexsort((A, self.joins))
        return np.take_along_axis(self.joins, order, axis=1), np.take_along_axis(A, order, axis=1)

    def _is_completed(self, A: np.ndarray, B: np.ndarray, may: np.ndarray, near: float) -> bool:
        """Return whether images can be chosen for all points; may: (p, p) bool, those that are left."""
        choices = may.sum(axis=1)
        if not choices.all():
            return False
        if choices.max() == 1:
            return self._maps(A, B, may.argmax(axis=1), near)
        i = int(np.where(choices > 1, choices, len(A) + 1).argmin())
        images = np.flatnonzero(may[i]).tolist()
        return any(self._is_completed(A, B, self._chosen(A, B, may, i, j, near), near) for j in images)

    def _chosen(
        self, A: np.ndarray, B: np.ndarray, may: np.ndarray, i: int, j: int, near: float
    ) -> np.ndarray:
        """Return what is left once j is the image of i."""
        left = may & (self.joins[i][:, None] == self.joins[j]) & (np.abs(A[i][:, None] - B[j]) <= near)
        left[i], left[:, j] = False, False
        left[i, j] = True
        return np.asarray(left)

    def _maps(self, A: np.ndarray, B: np.ndarray, image: np.ndarray, near: float) -> bool:
        at = np.ix_(image, image)
        one_each = len(np.unique(image)) == len(image)
        return bool(one_each and (self.joins[at] == self.joins).all() and (np.abs(B[at] - A) <= near).all())


def _arrows(loads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the nodes that are loaded, and their loads over the largest."""
    nodes = np.flatnonzero(loads.any(axis=1))
    largest = float(np.sqrt((loads**2).sum(axis=1)).max())
    return nodes, loads[nodes] / (largest or 1.0)


def _held(free: np.ndarray, leeway: Leeway) -> list[tuple[np.ndarray, np.ndarray]]:
    """Return nodes, and directions both ways, that are held: alone, or all but one, which then stands for it.

    Where rotations about one axis are left, it is only that direction; where more are left, none.
    """
    d = free.shape[1]
    some = np.asarray(free.any(axis=1))
    if leeway.kind == "none":
        count = free.sum(axis=1, keepdims=True)
        told = [~free & (count == d - 1), *([free & (count == 1)] if d == 3 else [])]
    else:
        told = [~free & some[:, None] & (np.abs(leeway.axis) > 1.0 - TURNS)] if len(leeway.axis) else []
    found = []
    for which in told:
        nodes, axes = np.nonzero(which)
        ways = np.eye(d)[axes]
        found.append((np.concatenate((nodes, nodes)), np.concatenate((ways, -ways))))
    return found


def _sorts(structure: Structure) -> np.ndarray:
    """Return (b,) numbers of elements: equal where kind, stiffness and rest length are."""
    columns = (structure.tension_only, structure.stiffness, structure.rest_lengths)
    classes = np.stack([_classes(column.astype(float)) for column in columns], axis=1)
    return np.unique(classes, axis=0, return_inverse=True)[1].reshape(-1)


def _classes(values: np.ndarray) -> np.ndarray:
    """Return (b,) numbers of values: the same where one follows another by no more than rounding."""
    order = np.argsort(values, kind="stable")
    rises = np.diff(values[order], prepend=values[order[0]]) > SAME_VALUE * np.abs(values[order])
    classes = np.empty(len(values), dtype=int)
    classes[order] = np.cumsum(rises)
    return classes
