"""Which members a symmetry of graph and coordinates exchanges: rotations, reflections, and what they join."""

from collections.abc import Iterator
from itertools import product
from typing import Any

import numpy as np

from cgff_cli.mechanics.norms import largest, norm
from cgff_cli.scene.physics import component_labels
from cgff_cli.structure import Structure

ALIKE = 1e-8
"""Share of the structure's size by which places may differ and yet be one."""

MOST_TRIED = 20_000
"""Motions of three nodes onto three others that are tried; members of what is left count as different."""

_ROOM = 8.0  # what errors of places may add up to in distances and turned places


def orbits(structure: Structure, alike: float = ALIKE) -> np.ndarray:
    """Return (b,) int: members that a symmetry exchanges have one number, in order of first members.

    A symmetry is an isometry that takes nodes to nodes, cables to cables, struts to struts, and supports and
    loads to such. alike: share of the size within which it need do so.
    """
    found = _Symmetries(structure, alike)
    members = [found.joined_by(nodes) for nodes in found.each()]
    own = np.arange(len(structure.start))
    return component_labels(len(own), np.stack((np.tile(own, len(members)), np.concatenate(members)), axis=1))


class _Symmetries:
    """Y: (n, r) places from the centre along the r axes (r, d) that the shape extends in, its size 1."""

    def __init__(self, structure: Structure, alike: float):
        self.s, self.room = structure, _ROOM * alike
        X = structure.coordinates - structure.coordinates.mean(axis=0)
        X = X / (norm(np.ptp(X, axis=0)) or 1.0)
        _, values, axes = np.linalg.svd(X, full_matrices=False)
        flat = min(self.room * np.sqrt(len(X)), 0.5 * values[0])  # of the widest axis never
        self.axes = axes[values > flat]  # what is flat stays in its plane
        self.Y = X @ self.axes.T
        self.held = np.where(structure.free, 0.0, 1.0)
        self.loads = structure.loads / (largest(structure.loads) or 1.0)
        self.codes = self._codes(np.arange(len(X)))
        self.order = np.argsort(self.codes, kind="stable")
        self.marks = self._marks()

    def _codes(self, nodes: np.ndarray) -> np.ndarray:
        """Return (b,) a number for ends and kind of each member, nodes (n,) in place of its own."""
        low, high = np.sort(np.stack((nodes[self.s.start], nodes[self.s.end])), axis=0)
        return (low * len(nodes) + high) * 2 + self.s.tension_only

    def _marks(self) -> np.ndarray:
        """Return (n, c) what no symmetry changes of a node: its distance from the centre, its members."""
        s = self.s
        l = _norms(self.Y[s.start] - self.Y[s.end])
        sums = [s.at_nodes(own * l) for own in (s.tension_only, ~s.tension_only)]
        counts = s.at_nodes(np.ones(len(l)))
        return np.stack((*map(_norms, (self.Y, self.held, self.loads)), counts, *sums), axis=1)

    def _like(self, row: int) -> np.ndarray:
        """Return the nodes that a symmetry may take a node to."""
        room = self.room * (1.0 + self.marks[row, 3])
        return np.flatnonzero(np.abs(self.marks - self.marks[row]).max(axis=1) <= room)

    def each(self) -> Iterator[np.ndarray]:
        """Yield symmetries, (n,) node -> node, the identity first, enough for the orbits of them all.

        A symmetry is known by what it makes of as many nodes as there are axes. Of those that take the first
        to a certain node one will do, unless that is the first itself.
        """
        from scipy.spatial import cKDTree

        tree, frame, tried = cKDTree(self.Y), self._frame(), 0
        own = np.arange(len(self.Y))
        yield own
        joined = np.stack((own, own), axis=1)
        apart = _norms(self.Y[frame][:, None] - self.Y[frame])
        like = [self._like(row) for row in frame]
        for first in sorted(like[0].tolist(), key=lambda node: node != frame[0]):
            labels = component_labels(len(own), joined)
            if first != frame[0] and labels[first] == labels[frame[0]]:
                continue
            near = [
                nodes[np.abs(_norms(self.Y[nodes] - self.Y[first]) - distance) <= self.room]
                for nodes, distance in zip(like[1:], apart[0, 1:], strict=True)
            ]
            for others in product(*(nodes.tolist() for nodes in near)):
                tried += 1
                nodes = self._extended(frame, [first, *others], apart, tree) if tried <= MOST_TRIED else None
                if nodes is not None:
                    yield nodes
                    joined = np.concatenate((joined, np.stack((own, nodes), axis=1)))
                    if first != frame[0]:
                        break

    def _frame(self) -> list[int]:
        """Return nodes that span the shape from its centre, the first with the fewest like it."""
        reach = _norms(self.Y)
        counts = np.unique(self.marks.round(6), axis=0, return_inverse=True, return_counts=True)
        rarity = counts[2][counts[1].reshape(-1)]
        rows, left = [int(np.lexsort((-reach, rarity, reach < 0.25 * reach.max()))[0])], self.Y
        while len(rows) < self.Y.shape[1]:
            u = left[rows[-1]] / norm(left[rows[-1]])
            left = left - np.outer(left @ u, u)
            rows.append(int(_norms(left).argmax()))
        return rows

    def _extended(
        self, frame: list[int], image: list[int], apart: np.ndarray, tree: Any
    ) -> np.ndarray | None:
        """Return the symmetry that takes the frame to its image, None where there is none."""
        to = self.Y[image]
        if largest(_norms(to[:, None] - to) - apart) > self.room:
            return None
        left, _, right = np.linalg.svd(self.Y[frame].T @ to)
        far, nodes = tree.query(self.Y @ (left @ right))
        is_one_to_one = far.max() <= self.room and len(np.unique(nodes)) == len(nodes)
        return nodes if is_one_to_one and self._is_kept(nodes, left @ right) else None

    def _is_kept(self, nodes: np.ndarray, Q: np.ndarray) -> bool:
        """Return whether a map of nodes, turned by Q (r, r), takes members, supports and loads to such."""
        if not np.array_equal(np.sort(self._codes(nodes)), self.codes[self.order]):
            return False
        I = np.eye(self.held.shape[1])
        turn = self.axes.T @ Q @ self.axes + I - self.axes.T @ self.axes
        held = np.einsum("ni,ia,ib->nab", self.held, turn, turn) - self.held[nodes][:, None] * I
        return max(largest(held), largest(self.loads @ turn - self.loads[nodes])) <= 1e3 * self.room

    def joined_by(self, nodes: np.ndarray) -> np.ndarray:
        """Return (b,) the member that a symmetry takes each member to."""
        return self.order[np.searchsorted(self.codes[self.order], self._codes(nodes))]


def _norms(vectors: np.ndarray) -> np.ndarray:
    """Return the Euclidean norms of vectors along the last axis."""
    return np.linalg.norm(vectors, axis=-1)
