"""What the loop minimises: the potential energy, or the paper's eq. (10), half the squared residual.

An objective gives the value and gradient at a state, the curvature along a direction, how far rounding blurs
a change, and a `Line`: the objective along X + a d as a function of the step a.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.elements import EPS, TINY
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import State


class Trial(NamedTuple):
    """A step along a line: change of the objective since its start, slope, and the state, if it is known."""

    step: float
    change: float
    slope: float
    there: State | None = None


Line = Callable[[float], Trial]


class Energy:
    """P = sum k e^2 / 2 - loads . X; its gradient is -eta, its Hessian K: minima are stable equilibria."""

    name = "energy"

    def value(self, state: State) -> float:
        """Return P."""
        return state.energy

    def gradient(self, state: State) -> np.ndarray:
        """Return dP/dX over the free directions, (d, m)."""
        return state.g

    def change(self, old: State, new: State) -> float:
        """Return P(new) - P(old)."""
        return new.rise(old)

    def size(self, state: State) -> float:
        """Return the norm of the gradient."""
        return state.norm

    def curvature(self, state: State, d: np.ndarray) -> float:
        """Return d.K d, element by element: half of K d."""
        W = state.mechanics.connectivity.differences(d)
        along, square = np.einsum("ab,ab->b", state.V, W), np.einsum("ab,ab->b", W, W)
        return float(state.parts().w @ (along * along) + state.q @ square)

    def noise(self, state: State) -> float:
        """Return the rounding error to expect in a change of P."""
        return 2.0 * norm(state.t * state.rounding)

    def line(self, state: State, d: np.ndarray) -> Line:
        """Return P along X + a d: by states if small, else in closed form, which tells no state.

        Along it l^2 = A + 2 a B + a^2 C, so that a trial costs O(b) and no product with rho.
        """
        mechanics = state.mechanics
        if mechanics.is_small:
            return _line_of_states(self, state, d)
        W = mechanics.connectivity.differences(d)
        A, B, C = state.l * state.l, np.einsum("ab,ab->b", state.V, W), np.einsum("ab,ab->b", W, W)
        k, l0, least, e0 = mechanics.k, mechanics.l0, mechanics.least, state.e
        work = 0.0 if mechanics.F is None else float(np.vdot(mechanics.F, d))

        def trial(a: float) -> Trial:
            """Return the trial at step a, from three numbers per element."""
            half = B + a * C
            l = np.maximum(np.sqrt(np.maximum(A + a * (B + half), 0.0)), TINY)
            e = np.maximum(l - l0, least)
            change = 0.5 * float(k @ ((e - e0) * (e + e0))) - a * work
            return Trial(a, change, float((k * e) @ (half / l)) - work)

        return trial


class Residual:
    """f = |eta|^2 / 2, eq. (10); gradient H^T eta = -K eta, eq. (12); unstable equilibria are minima too."""

    name = "residual"

    def value(self, state: State) -> float:
        """Return f."""
        return 0.5 * float(np.vdot(state.g, state.g))

    def gradient(self, state: State) -> np.ndarray:
        """Return df/dX over the free directions, (d, m)."""
        return state.residual_gradient

    def change(self, old: State, new: State) -> float:
        """Return f(new) - f(old)."""
        return 0.5 * float(np.vdot(new.g - old.g, new.g + old.g))

    def size(self, state: State) -> float:
        """Return the norm of the gradient."""
        return norm(state.residual_gradient)

    def curvature(self, state: State, d: np.ndarray) -> float:
        """Return |K d|^2, without second derivatives of eta."""
        Kd = state.tangent_times(d)
        return float(np.vdot(Kd, Kd))

    def noise(self, state: State) -> float:
        """Return the rounding error to expect in a change of f: that of each force, times the force."""
        mechanics = state.mechanics
        rounding = EPS * float(mechanics.nodal_stiffness.max()) * state.size
        return rounding * float(np.abs(state.g).sum())

    def line(self, state: State, d: np.ndarray) -> Line:
        """Return f along X + a d."""
        return _line_of_states(self, state, d)


Objective = Energy | Residual
OBJECTIVES: dict[str, type[Energy] | type[Residual]] = {"energy": Energy, "residual": Residual}


def _line_of_states(objective: Objective, state: State, d: np.ndarray) -> Line:
    """Return the objective along X + a d, a state for every trial."""

    def trial(a: float) -> Trial:
        """Return the trial at step a."""
        there = state.mechanics.at(state.X + a * d)
        slope = float(np.vdot(objective.gradient(there), d))
        return Trial(a, objective.change(state, there), slope, there)

    return trial
