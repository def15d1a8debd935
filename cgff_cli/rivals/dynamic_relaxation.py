"""Dynamic relaxation with kinetic damping (Barnes 1999), fictitious masses from nodal stiffness.

    v <- v + eta / m,   X <- X + v        one time step of length 1
    kinetic energy past its peak:         step back to the peak, v = 0, new masses

A step is stable while m is at least half a node's total stiffness, the sum of k and of q in tension, and
stiffness does not change; where peaks no longer fall the masses are too small for the changes, and double.
"""

import numpy as np

from cgff_cli.mechanics.state import State
from cgff_cli.rivals.task import End, Task, Unknowns

LIGHTEST = 1.5
"""First mass over a node's total stiffness: three times the least that a constant stiffness asks for."""

PATIENCE = 20
"""Peaks in a row, none below the lowest, after which the masses double."""


def dynamic_relaxation(task: Task) -> End:
    """Let the structure swing, stopping it at every peak of its kinetic energy; the trace ends the run."""
    task.trace.start()
    unknowns = Unknowns(task)
    at = unknowns.mechanics.at
    state = at(unknowns.mechanics.start)
    weight, steps, evaluations = _Weight(), 0, 1
    unknowns.add(steps, evaluations, state)
    while True:
        masses = weight.masses(state)
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
        weight.see(energy)


class _Weight:
    """Fictitious masses, and the peaks that tell whether they are heavy enough."""

    def __init__(self) -> None:
        self.factor = LIGHTEST
        self.lowest = float("inf")
        self.waited = 0

    def masses(self, state: State) -> np.ndarray:
        """Return (m,) masses."""
        structure, moves = state.mechanics.structure, state.mechanics.moves
        along = state.mechanics.k + np.maximum(state.q, 0.0)  # slack cables too: they may tighten
        n = len(structure.free)
        total = np.bincount(structure.start, along, n) + np.bincount(structure.end, along, n)
        return np.asarray(self.factor * (total if moves is None else total[moves]))

    def see(self, peak: float) -> None:
        """Remember a peak of the kinetic energy."""
        if peak < self.lowest:
            self.lowest, self.waited = peak, 0
            return
        self.waited += 1
        if self.waited >= PATIENCE:
            self.factor, self.waited, self.lowest = 2.0 * self.factor, 0, float("inf")
