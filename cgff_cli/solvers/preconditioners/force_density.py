"""The force density start of an anchored net: linear solves that bring it near its shape."""

from collections.abc import Callable

import numpy as np

from cgff_cli.mechanics.elements import TINY
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.solvers.factors import Factor
from cgff_cli.solvers.line_search import FLAT, Goal, strong_wolfe
from cgff_cli.solvers.objectives import Energy
from cgff_cli.solvers.tightening import fit

Factored = Callable[[np.ndarray], Factor]
"""From (b,) force densities to a factor of D_ff over the nodes that move, eq. (4)."""

DRAWN_IN = 0.01
"""Mean of l / l0 in a net that force densities alone draw into its anchors: it has no ratio to go by."""


def force_density_start(mechanics: Mechanics, state: State, factored: Factored) -> State:
    """Return the force density solution (Schek 1974) with q = k if its energy is lower, else `state`.

    Where its lengths do not fit the rest lengths it is repeated once with q times (l / l0)^1.5, to pull at
    what is too long; a cable whose force density alone changed would answer with about the inverse.
    """
    structure = mechanics.structure
    q = structure.stiffness
    best = _solved(mechanics, state, q, factored(q))
    ratio = best.l / structure.rest_lengths.clip(TINY)
    mean = float(ratio.mean())
    if not fit(best.l, structure).is_good and mean > DRAWN_IN:
        q = q * ((ratio / mean) ** 1.5).clip(0.01, 100.0)
        best = min(best, _solved(mechanics, state, q, factored(q)), key=lambda found: found.energy)
    return best if best.energy < state.energy else state


def _solved(mechanics: Mechanics, state: State, q: np.ndarray, factor: Factor) -> State:
    """Return the state at the force density solution, D_ff x_f = F - D_fc x_c, one factor for all axes.

    Loads would need force densities of the right size, not only proportion: their share of the shape is
    scaled to the least energy along it.
    """
    structure, connectivity = mechanics.structure, mechanics.connectivity
    moves = structure.free[:, 0]

    def answer(forces: np.ndarray) -> np.ndarray:
        """Return (n, d) positions under (n, d) nodal forces, zero at held nodes."""
        x = np.zeros_like(forces)
        x[moves] = factor.solve(np.asfortranarray(forces[moves]))
        return x

    held = np.where(structure.free, 0.0, state.X)
    found = mechanics.at(held - answer(connectivity.gather(q[:, None] * connectivity.differences(held))))
    if not mechanics.has_loads:
        return found
    energy = Energy(mechanics)
    sag = answer(structure.loads)
    line = energy.line(found, sag)
    goal = Goal(line(0.0).slope, energy.noise(found), FLAT)
    return mechanics.at(found.X + strong_wolfe(line, goal, 1.0).length * sag)
