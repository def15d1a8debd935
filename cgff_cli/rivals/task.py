"""What a rival is given, and what it gives back."""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.options import SolveOptions
from cgff_cli.rivals.trace import Trace
from cgff_cli.solvers.solution import Solution
from cgff_cli.structure import Structure


class End(NamedTuple):
    """Where a rival came to by itself.

    X               : (n, d) shape about the centroid of the start; None where it failed
    verdict         : how it ended, or "" to let the residual tell
    message         : its own words on how it ended
    force_densities : (b,) where it has its own, not those of the scene's EA and rest lengths
    """

    X: np.ndarray | None
    verdict: str = ""
    message: str = ""
    force_densities: np.ndarray | None = None


class Task(NamedTuple):
    """One structure to form-find, by every rival.

    groups    : (b,) int, the scene's group of every element
    best      : CGFF's answer to the rounding floor
    alignment : how shapes are laid over it, "rigid" or "none"
    """

    structure: Structure
    groups: np.ndarray
    options: SolveOptions
    best: Solution
    alignment: str = "rigid"


Rival = Callable[[Task, Trace], End]


def centred(structure: Structure) -> Structure:
    """Return a structure about the centroid of its start."""
    X = structure.coordinates
    return replace(structure, coordinates=X - X.mean(axis=0))


class Unknowns:
    """The free coordinates of a task as one vector, centred and scaled as CGFF does it.

    Every rival so gets numbers of order one, and its absolute tolerances mean something.
    """

    def __init__(self, task: Task, trace: Trace):
        trace.start()
        self.mechanics, self.trace = Mechanics(task.structure), trace
        self.start: np.ndarray = self.mechanics.start.reshape(-1)[self.mechanics.dofs]

    def state(self, x: np.ndarray) -> State:
        """Return the state at free coordinates x (f,)."""
        X = self.mechanics.start.copy()
        X.reshape(-1)[self.mechanics.dofs] = x
        return self.mechanics.at(X)

    def gradient(self, state: State) -> np.ndarray:
        """Return minus the out-of-balance forces on the free coordinates, (f,)."""
        return state.g.reshape(-1)[self.mechanics.dofs]

    def add(self, iterations: int | None, evaluations: int, state: State) -> None:
        """Note a state in the trace."""
        self.trace.add(iterations, evaluations, self.mechanics.shape(state.X))
