"""A structure at one shape: the columns of the mechanics, each computed once.

Everything here is in the units of a frame, axis by axis, over the nodes that can move.
"""

from functools import cached_property

import numpy as np

from cgff_cli.mechanics import elements, tangent
from cgff_cli.mechanics.connectivity import connectivity
from cgff_cli.mechanics.equilibrium import internal_forces
from cgff_cli.mechanics.frame import Frame, frame_of
from cgff_cli.mechanics.norms import largest, norm
from cgff_cli.mechanics.rigid import RigidMotions
from cgff_cli.structure import Structure


class Mechanics:
    """What stays the same while a structure moves.

    start       : (d, m) the start shape        mask : (d, m) 1 in free directions, 0 in held ones, or None
    k, l0, least : (b,)                         F    : (d, m) loads in free directions, or None
    all, moves  : (d, n) all nodes at the start, (n,) bool: which of them have a direction to move in
    held_work   : work that loads do at what is held
    """

    def __init__(self, structure: Structure, frame: Frame | None = None):
        self.structure = structure
        self.frame = frame = frame or frame_of(structure)
        self.all = X = ((structure.coordinates - frame.centre) * (1.0 / frame.length)).T
        self.k = structure.stiffness * (1.0 / frame.stiffness)
        self.l0 = structure.rest_lengths * (1.0 / frame.length)
        self.kl0 = self.k * self.l0
        self.least = elements.least_extensions(structure.tension_only)
        self.all_free = bool(structure.free.all())
        self.moves: np.ndarray | None = None
        self.mask: np.ndarray | None = None
        self.F: np.ndarray | None = None
        self.held_work = 0.0
        if not self.all_free:
            self.moves = moves = np.asarray(structure.free.any(axis=1))
            free = structure.free[moves]
            self.mask = None if free.all() else free.T.astype(float)
        if structure.loads.any():
            loads = structure.loads * (1.0 / frame.force)
            held_work = np.where(structure.free, 0.0, loads * X.T).sum()
            self.held_work = float(held_work)
            F = self._moving(loads)
            self.F = F if self.mask is None else F * self.mask
        self.start = self._moving(X.T)
        self.connectivity = connectivity(structure.start, structure.end, X, self.moves)
        self.fixed = self.connectivity.fixed
        self.largest_load = 0.0 if self.F is None else largest(self.F)

    def _moving(self, vectors: np.ndarray) -> np.ndarray:
        """Return what (n, d) nodal vectors are at the nodes that move, (d, m)."""
        return np.ascontiguousarray((vectors if self.moves is None else vectors[self.moves]).T)

    @property
    def is_small(self) -> bool:
        """Whether dense matrices serve."""
        return self.connectivity.is_small

    @cached_property
    def dofs(self) -> np.ndarray:
        """Places of the free directions in a flat (d, m) array."""
        return np.arange(self.start.size) if self.mask is None else np.flatnonzero(self.mask)

    @cached_property
    def largest_at_start(self) -> float:
        """The largest k l at the start: what a shape shrunk to a point is measured by."""
        s, X = self.structure, self.all
        return float((self.k * elements.lengths(X[:, s.start] - X[:, s.end])).max())

    @cached_property
    def nodal_stiffness(self) -> np.ndarray:
        """(m,) total stiffness of each moving node's elements, slack or not."""
        own = self.structure.at_nodes(self.k)
        return own if self.moves is None else own[self.moves]

    @cached_property
    def scale_stiffness(self) -> np.ndarray:
        """(m,) the same, the mean for a node without elements: what a shift is measured in is never 0."""
        own = self.nodal_stiffness
        return own if own.all() else np.where(own > 0.0, own, own.mean())

    def at(self, X: np.ndarray) -> "State":
        """Return the state at (d, m) positions X."""
        return State(self, X)

    def everywhere(self, X: np.ndarray) -> np.ndarray:
        """Return (d, n) positions of all nodes for (d, m) of those that move."""
        if self.moves is None:
            return X
        full = self.all.copy()
        full[:, self.moves] = X
        return full

    def moving(self, shape: np.ndarray) -> np.ndarray:
        """Return (d, m) positions for a shape (n, d) about the centroid, in the user's units."""
        return self._moving(shape * (1.0 / self.frame.length))

    def shape(self, X: np.ndarray) -> np.ndarray:
        """Return (n, d) positions of all nodes about the centroid of the start, in the user's units."""
        return self.everywhere(X).T * self.frame.length


class State:
    """Columns at positions X (d, m).

    V (d, b) element vectors; l, stretch, e, t, q (b,) lengths, l - l0, extensions, forces, force densities;
    g (d, m) gradient of the energy, -eta of eq. (9) in free directions, 0 in held ones.
    norm, reach: Euclidean norms of g and X.
    """

    def __init__(self, mechanics: Mechanics, X: np.ndarray):
        self.mechanics = mechanics
        self.X = X
        V = mechanics.connectivity.differences(X)
        if mechanics.fixed is not None:
            V += mechanics.fixed
        self.V = V
        self.l = elements.lengths(V)
        self.stretch = self.l - mechanics.l0
        self.e = elements.extensions(self.stretch, mechanics.least)
        self.t = elements.forces(mechanics.k, self.e)
        self.q = elements.force_densities(self.t, self.l)
        g = internal_forces(mechanics.connectivity, V, self.q)
        if mechanics.mask is not None:
            g *= mechanics.mask
        if mechanics.F is not None:
            g -= mechanics.F
        self.g = g
        self.norm, self.reach = norm(g), norm(X)

    @property
    def energy(self) -> float:
        """Total potential energy: elastic energy less the work of the loads."""
        elastic, F = float(elements.energy(self.t, self.e)), self.mechanics.F
        return elastic - self.mechanics.held_work - (0.0 if F is None else float(np.vdot(F, self.X)))

    def rise(self, old: "State") -> float:
        """Return how much more energy this state has, summed element by element: no totals cancel."""
        F, elastic = self.mechanics.F, 0.5 * float((self.e - old.e).dot(self.t + old.t))
        return elastic if F is None else elastic - float(np.vdot(F, self.X - old.X))

    @cached_property
    def residual_gradient(self) -> np.ndarray:
        """(d, m) gradient of eq. (10), H^T eta = K g, eq. (12)."""
        return self.tangent_times(self.g)

    @cached_property
    def rigid(self) -> RigidMotions:
        """The rigid motions that supports allow."""
        return RigidMotions(self.mechanics.everywhere(self.X), self.mechanics.structure.free.T)

    @property
    def taut(self) -> np.ndarray:
        """(b,) bool, not slack."""
        return elements.taut(self.stretch, self.mechanics.least)

    @property
    def slack(self) -> np.ndarray:
        """(b,) bool, cables shorter than their rest length, which carry nothing."""
        return ~self.taut

    @property
    def size(self) -> float:
        """Largest coordinate, length and extension added up: what rounding is relative to."""
        return largest(self.mechanics.everywhere(self.X)) + largest(self.l) + largest(self.e)

    @cached_property
    def rounding(self) -> np.ndarray:
        """(b,) how far rounding blurs each extension: by eps of its ends' coordinates, of l and of e."""
        reach = np.abs(self.mechanics.everywhere(self.X)).max(axis=0)
        structure = self.mechanics.structure
        far = np.maximum(reach[structure.start], reach[structure.end])
        return elements.EPS * (far + self.l + np.abs(self.e))

    def parts(self, q: np.ndarray | None = None, taut: np.ndarray | None = None) -> tangent.Parts:
        """Return what K is the sum of. q: (b,) nonnegative force densities in place of the state's own.

        w = (k - q) / l^2 with k = 0 where not taut, (b,) bool; where taut, k - q = k l0 / l.
        """
        l2 = self.l * self.l
        w = self.mechanics.kl0 / (l2 * self.l)
        w *= self.taut if taut is None else taut
        if q is None:
            return tangent.Parts(self.X, self.V, w, self.q)
        return tangent.Parts(self.X, self.V, w + (self.q - q) / l2, q)

    def tangent_times(self, Y: np.ndarray) -> np.ndarray:
        """Return K Y, (d, m), without forming K."""
        KY = tangent.times(self.mechanics.connectivity, self.parts(), Y)
        return KY if self.mechanics.mask is None else KY * self.mechanics.mask

    @cached_property
    def own_tangent(self) -> np.ndarray:
        """(d m, d m) the tangent as `dense_tangent` makes it, kept: not to be written to."""
        return self.dense_tangent()

    def dense_tangent(self, q: np.ndarray | None = None, taut: np.ndarray | None = None) -> np.ndarray:
        """Return K, (d m, d m), axis by axis, a fresh one; held directions keep only 1 on the diagonal.

        q: (b,) nonnegative force densities to use in place of the state's own; taut: (b,) bool, likewise.
        """
        return tangent.stiffness_matrix(self.mechanics.connectivity, self.parts(q, taut), self.mechanics.mask)

    def pull(self) -> np.ndarray:
        """Return U q, (n, d), at all nodes, those that do not move included, in the frame's units."""
        s, pull = self.mechanics.structure, self.V * self.q
        n = len(s.free)
        return np.stack([np.bincount(s.start, p, n) - np.bincount(s.end, p, n) for p in pull], axis=1)
