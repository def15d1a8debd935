"""Running one method once, under the clock, whatever becomes of it."""

from typing import NamedTuple

import numpy as np

from cgff_cli.errors import CgffError
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.rivals.registry import REGISTRY
from cgff_cli.rivals.task import End, Reference, Task
from cgff_cli.rivals.trace import Stop, Trace
from cgff_cli.solvers.stopping import Gauge, Watch
from cgff_cli.structure import Structure
from cgff_cli.study.alignment import affinely, aligned, largest_move, size

EVALUATIONS_PER_ITERATION = 50
"""Evaluations a rival may take for every iteration that the option max_iterations gives CGFF."""


class Case(NamedTuple):
    """What all runs on one scene share.

    groups    : (b,) int, the scene's group of every element
    alignment : how shapes are laid over the reference, "rigid" or "none"
    """

    structure: Structure
    groups: np.ndarray
    options: SolveOptions
    time_limit: float
    reference: Reference
    alignment: str


class Run(NamedTuple):
    """One run: where it came to (None if it failed), how long it took, what it passed through."""

    end: End | None
    seconds: float
    trace: Trace
    failure: str = ""

    @property
    def tells_all(self) -> bool:
        """Whether another run would add nothing: this one failed, or ran out of time."""
        return self.end is None or self.end.verdict == "time_limit"


def run(name: str, case: Case) -> Run:
    """Run a method once; an error is a run that failed, and its words say how."""
    entry = REGISTRY[name]
    options = case.options
    most = EVALUATIONS_PER_ITERATION * options.max_iterations
    mechanics = Mechanics(case.structure)
    watch = None if entry.judges_itself else Watch(Gauge(mechanics), options.tolerance, most)
    target = case.reference.X
    unit = size(target)

    def distance(X: np.ndarray) -> float:
        """Return the error in shape of (n, d) positions, over the structure's size."""
        laid = X if entry.is_affine else aligned(X, target, case.alignment)
        return largest_move(laid, target) / unit

    trace = Trace(mechanics, watch, case.time_limit, distance)
    if entry.is_affine:
        trace.fit = lambda X: affinely(X, target)
    try:
        end = entry.run(Task(case.structure, case.groups, options, trace, case.reference))
    except Stop as stop:
        return Run(End(trace.X, stop.verdict), trace.seconds, trace)
    except CgffError as error:
        return Run(None, trace.seconds, trace, str(error))
    except Exception as error:  # a rival of any make: its row says how it failed
        return Run(None, trace.seconds, trace, f"{type(error).__name__}: {error}".rstrip(": "))
    return Run(end, trace.seconds, trace)
