"""A structure at one shape: every column of the mechanics, each computed once."""

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

    def at(self, X: np.ndarray) -> "State":
        """Return the state at (n, d) positions X."""
        return State(self, X)


class State:
    """Columns at positions X (n, d): vectors V (b, d), lengths l, extensions e, forces t, q (b,)."""

    def __init__(self, mechanics: Mechanics, X: np.ndarray):
        structure = mechanics.structure
        self.mechanics = mechanics
        self.X = X
        self.V = mechanics.connectivity.differences(X)
        self.l = elements.lengths(self.V)
        self.e = elements.extensions(self.l, structure.rest_lengths, mechanics.least)
        self.t = elements.forces(structure.stiffness, self.e)
        self.q = elements.force_densities(self.t, self.l)
        if len(mechanics.without_rest):  # t = k l: the force density is k at any length, zero included
            self.q[mechanics.without_rest] = structure.stiffness[mechanics.without_rest]

    @cached_property
    def eta(self) -> np.ndarray:
        """(n, d) out-of-balance forces, supports' reactions included, eq. (9)."""
        structure = self.mechanics.structure
        return residual(self.mechanics.connectivity, self.V, self.q, structure.loads)

    @cached_property
    def free_eta(self) -> np.ndarray:
        """(n, d) out-of-balance forces with zeros in the directions supports hold."""
        return self.eta if self.mechanics.all_free else np.where(self.mechanics.structure.free, self.eta, 0.0)

    @cached_property
    def slack(self) -> np.ndarray:
        """(b,) bool, cables shorter than their rest length, which carry nothing."""
        return ~elements.active(self.l, self.mechanics.structure.rest_lengths, self.mechanics.least)

    @cached_property
    def active_stiffness(self) -> np.ndarray:
        """(b,) stiffness k, zero for slack cables."""
        structure = self.mechanics.structure
        if not structure.tension_only.any():
            return structure.stiffness
        return np.where(self.slack, 0.0, structure.stiffness)

    @cached_property
    def u(self) -> np.ndarray:
        """(b, d) unit vectors, zero for an element of no length."""
        return tangent.unit_vectors(self.V, self.l)

    def tangent_times(self, W: np.ndarray) -> np.ndarray:
        """Return K W over the free directions, (n, d), without forming K."""
        product = tangent.times(self.mechanics.connectivity, self.u, self.active_stiffness, self.q, W)
        return product if self.mechanics.all_free else np.where(self.mechanics.structure.free, product, 0.0)

    def dense_tangent(self) -> np.ndarray:
        """Return K over the free directions as a dense matrix, a fresh one each time."""
        K = tangent.dense(self.mechanics.connectivity.dense, self.u, self.active_stiffness, self.q)
        if self.mechanics.all_free:
            return K
        return K[np.ix_(self.mechanics.dofs, self.mechanics.dofs)]

    @cached_property
    def energy(self) -> float:
        """Total potential energy: elastic energy less the work of the loads."""
        elastic = elements.energy(self.t, self.e)
        if not self.mechanics.has_loads:
            return elastic
        return elastic - float(np.vdot(self.mechanics.structure.loads, self.X))
