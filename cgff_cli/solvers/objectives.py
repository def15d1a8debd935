"""What the loop minimises: the potential energy, or the paper's eq. (10), half the squared residual.

An objective gives the value and gradient at a state, the change between two states, and a `Line`: change,
slope and curvature along X + a d as functions of the step a. Changes are summed element by element; `noise`
says how far rounding blurs them.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.elements import EPS, TINY
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import Mechanics, State


class Trial(NamedTuple):
    """The objective at step a along a line, against its start."""

    step: float
    change: float
    slope: float
    curvature: float


Line = Callable[[float], Trial]


class Energy:
    """P = sum k e^2 / 2 - loads . X; its gradient is -eta, its Hessian K: minima are stable equilibria."""

    name = "energy"

    def __init__(self, mechanics: Mechanics):
        self.mechanics = mechanics

    def value(self, state: State) -> float:
        """Return P."""
        return state.energy

    def gradient(self, state: State) -> np.ndarray:
        """Return dP/dX over the free directions, (n, d)."""
        return -state.free_eta

    def change(self, old: State, new: State) -> float:
        """Return P(new) - P(old)."""
        structure = self.mechanics.structure
        elastic = 0.5 * float(structure.stiffness @ ((new.e - old.e) * (new.e + old.e)))
        return (
            elastic - float(np.vdot(structure.loads, new.X - old.X)) if self.mechanics.has_loads else elastic
        )

    def line(self, state: State, d: np.ndarray) -> Line:
        """Return P along X + a d; along it l^2 = A + 2 a B + a^2 C, so a trial costs O(b) and no scatter."""
        structure, least = self.mechanics.structure, self.mechanics.least
        W = self.mechanics.connectivity.differences(d)
        A = state.l * state.l
        B = np.einsum("ij,ij->i", state.V, W)
        C = np.einsum("ij,ij->i", W, W)
        k, l0, e0 = structure.stiffness, structure.rest_lengths, state.e
        work = float(np.vdot(structure.loads, d)) if self.mechanics.has_loads else 0.0

        def trial(a: float) -> Trial:
            """Return the trial at step a, from three numbers per element."""
            half = B + a * C
            l = np.maximum(np.sqrt(np.maximum(A + a * (B + half), 0.0)), TINY)
            stretch = l - l0
            e = np.maximum(stretch, least)
            t = k * e
            rate = half / l
            change = 0.5 * float(k @ ((e - e0) * (e + e0))) - a * work
            slope = float(t @ rate) - work
            across = t / l
            curvature = float((np.where(stretch >= least, k, 0.0) - across) @ (rate * rate) + across @ C)
            return Trial(a, change, slope, curvature)

        return trial

    def noise(self, state: State) -> float:
        """Return the rounding error to expect in a change of P."""
        return 4.0 * norm(state.t * state.rounding)


class Residual:
    """f = |eta|^2 / 2, eq. (10); gradient H^T eta = -K eta, eq. (12); unstable equilibria are minima too."""

    name = "residual"

    def __init__(self, mechanics: Mechanics):
        self.mechanics = mechanics
        self.largest_stiffness = float(mechanics.nodal_stiffness.max())

    def value(self, state: State) -> float:
        """Return f."""
        return 0.5 * float(np.vdot(state.free_eta, state.free_eta))

    def gradient(self, state: State) -> np.ndarray:
        """Return df/dX over the free directions, (n, d)."""
        return -state.tangent_times(state.free_eta)

    def change(self, old: State, new: State) -> float:
        """Return f(new) - f(old)."""
        return 0.5 * float(np.vdot(new.free_eta - old.free_eta, new.free_eta + old.free_eta))

    def line(self, state: State, d: np.ndarray) -> Line:
        """Return f along X + a d; the curvature leaves out second derivatives of eta."""

        def trial(a: float) -> Trial:
            """Return the trial at step a, from the state there."""
            there = self.mechanics.at(state.X + a * d)
            Kd = there.tangent_times(d)
            slope = -float(np.vdot(there.free_eta, Kd))
            return Trial(a, self.change(state, there), slope, float(np.vdot(Kd, Kd)))

        return trial

    def noise(self, state: State) -> float:
        """Return the rounding error to expect in a change of f: that of each force, times the force."""
        rounding = EPS * self.largest_stiffness * (float(np.abs(state.X).max()) + float(state.l.max()))
        return rounding * float(np.abs(state.free_eta).sum())


Objective = Energy | Residual
OBJECTIVES: dict[str, type[Energy] | type[Residual]] = {"energy": Energy, "residual": Residual}
