"""Dynamic relaxation with kinetic damping (Barnes 1999), fictitious masses from nodal stiffness.

    v <- v + eta / m,   X <- X + v        one time step of length 1
    kinetic energy past its peak:         step back to the peak, v = 0, new masses

A step is stable while m is at least half a node's total stiffness, the sum of k and of q in tension, and
stiffness does not change; where peaks no longer fall the masses are too small for the changes, and double.
"""

import numpy as np

from cgff_cli.mechanics.state import State
from cgff_cli.rivals.task import End, Task, Trace, Unknowns

LIGHTEST = 1.5
"""First mass over a node's total stiffness: three times the least that a constant stiffness asks for."""

PEAKS = 20
"""Peaks in a row, none below the lowest, after which the masses double."""


def dynamic_relaxation(task: Task, trace: Trace) -> End:
    """Let the structure swing, stopping it at every peak of its kinetic energy; the trace ends the run."""
    unknowns = Unknowns(task, trace)
    at = unknowns.mechanics.at
    state = at(unknowns.mechanics.start)
    steps, evaluations = 0, 1
    factor, lowest, waited = LIGHTEST, float("inf"), 0
    unknowns.add(steps, evaluations, state)
    while True:
        masses = factor * _stiffness(state)
        v = -0.5 * state.g / masses
        energy = 0.0
        while True:
            steps, evaluations = steps + 1, evaluations + 1
            state = at(state.X + v)
            unknowns.add(steps, evaluations, state)
            swing = float((masses * v * v).sum())
            if swing < energy:
                break
            energy = swing
            v = v - state.g / masses
        # The peak lay between the last two steps: half way back on each (Barnes 1999).
        state = at(state.X - 1.5 * v - 0.5 * state.g / masses)
        evaluations += 1
        lowest, waited = (energy, 0) if energy < lowest else (lowest, waited + 1)
        if waited >= PEAKS:
            factor, lowest, waited = 2.0 * factor, float("inf"), 0


def _stiffness(state: State) -> np.ndarray:
    """Return (m,) what the elements of each node resist with; slack cables too: they may tighten."""
    mechanics = state.mechanics
    total = mechanics.structure.at_nodes(mechanics.k + np.maximum(state.q, 0.0))
    return total if mechanics.moves is None else total[mechanics.moves]
