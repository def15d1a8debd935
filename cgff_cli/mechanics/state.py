"""A structure at one shape: the columns of the mechanics, each computed once."""

from functools import cached_property

import numpy as np

from cgff_cli.mechanics import elements, tangent
from cgff_cli.mechanics.connectivity import Connectivity
from cgff_cli.mechanics.equilibrium import residual
from cgff_cli.structure import Structure


class Mechanics:
    """What stays the same while a structure moves."""

    def __init__(self, structure: Structure):
        self.structure = structure
        self.connectivity = Connectivity(structure.start, structure.end, len(structure.coordinates))
        self.least = elements.least_extensions(structure.tension_only)
        self.all_free = bool(structure.free.all())
        self.has_loads = bool(structure.loads.any())
        self.dofs = np.flatnonzero(structure.free)
        self.without_rest = np.flatnonzero(structure.rest_lengths == 0.0)

    @cached_property
    def nodal_stiffness(self) -> np.ndarray:
        """(n,) total stiffness of each node's elements, slack or not."""
        structure = self.structure
        ends = np.concatenate((structure.start, structure.end))
        return np.bincount(ends, np.tile(structure.stiffness, 2), minlength=len(structure.coordinates))

    @cached_property
    def scale_stiffness(self) -> np.ndarray:
        """(n,) the same, the mean for a node without elements: what a shift is measured in is never 0."""
        own = self.nodal_stiffness
        return np.where(own > 0.0, own, own.mean())

    def at(self, X: np.ndarray) -> "State":
        """Return the state at (n, d) positions X."""
        return State(self, X)

    def on_free(self, vectors: np.ndarray) -> np.ndarray:
        """Return (n, d) nodal vectors with zeros in the directions that supports hold."""
        return vectors if self.all_free else np.where(self.structure.free, vectors, 0.0)


class State:
    """Columns at positions X (n, d).

    V (b, d) element vectors; l, stretch, e, t, q (b,) lengths, l - l0, extensions, forces, force densities;
    eta (n, d) out-of-balance forces, eq. (9), supports' reactions included; free_eta without them.
    """

    def __init__(self, mechanics: Mechanics, X: np.ndarray):
        structure, connectivity = mechanics.structure, mechanics.connectivity
        self.mechanics = mechanics
        self.X = X
        self.V = connectivity.differences(X)
        self.l = elements.lengths(self.V)
        self.stretch = self.l - structure.rest_lengths
        self.e = elements.extensions(self.stretch, mechanics.least)
        self.t = elements.forces(structure.stiffness, self.e)
        self.q = elements.force_densities(self.t, self.l)
        if len(mechanics.without_rest):  # t = k l: the force density is k at any length, zero included
            self.q[mechanics.without_rest] = structure.stiffness[mechanics.without_rest]
        self.eta = residual(connectivity, self.V, self.q, structure.loads)
        self.free_eta = mechanics.on_free(self.eta)

    @property
    def slack(self) -> np.ndarray:
        """(b,) bool, cables shorter than their rest length, which carry nothing."""
        return ~elements.taut(self.stretch, self.mechanics.least)

    @property
    def size(self) -> float:
        """Largest coordinate, length and extension added up: what rounding is relative to."""
        return float(np.abs(self.X).max()) + float(self.l.max()) + float(np.abs(self.e).max())

    @property
    def rounding(self) -> np.ndarray:
        """(b,) how far rounding blurs each extension: by eps of its ends' coordinates, of l and of e."""
        reach = np.abs(self.X).max(axis=1)
        structure = self.mechanics.structure
        far = np.maximum(reach[structure.start], reach[structure.end])
        return elements.EPS * (far + self.l + np.abs(self.e))

    @property
    def active_stiffness(self) -> np.ndarray:
        """(b,) stiffness k, zero for slack cables."""
        return self.mechanics.structure.stiffness * elements.taut(self.stretch, self.mechanics.least)

    @property
    def u(self) -> np.ndarray:
        """(b, d) unit vectors, zero for an element of no length."""
        return tangent.unit_vectors(self.V, self.l)

    @property
    def energy(self) -> float:
        """Total potential energy: elastic energy less the work of the loads."""
        elastic = elements.energy(self.t, self.e)
        if not self.mechanics.has_loads:
            return elastic
        return elastic - float(np.vdot(self.mechanics.structure.loads, self.X))

    def tangent_times(self, W: np.ndarray) -> np.ndarray:
        """Return K W over the free directions, (n, d), without forming K."""
        connectivity = self.mechanics.connectivity
        return self.mechanics.on_free(tangent.times(connectivity, self.u, self.active_stiffness, self.q, W))

    def dense_tangent(self, q: np.ndarray | None = None, k: np.ndarray | None = None) -> np.ndarray:
        """Return K over the free directions as a dense matrix, a fresh one each time.

        q, k: (b,) force densities and stiffnesses to use in place of the state's own.
        """
        q = self.q if q is None else q
        k = self.active_stiffness if k is None else k
        K = tangent.dense(self.mechanics.connectivity.dense, self.u, k, q)
        if self.mechanics.all_free:
            return K
        return K[np.ix_(self.mechanics.dofs, self.mechanics.dofs)]
