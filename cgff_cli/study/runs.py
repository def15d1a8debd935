"""Running one method once, under the clock, whatever becomes of it."""

from typing import NamedTuple

import numpy as np

from cgff_cli.errors import CgffError
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.rivals.registry import REGISTRY
from cgff_cli.rivals.task import End, Task
from cgff_cli.rivals.trace import Stop, Trace
from cgff_cli.solvers.stopping import Gauge, Watch
from cgff_cli.study.alignment import affinely, laid_over, largest_move, size

EVALUATIONS_PER_ITERATION = 50
"""Evaluations a rival may take for every iteration that the option max_iterations gives CGFF."""


class Attempt(NamedTuple):
    """One run: where it came to (None if it failed), how long it took, what it passed through."""

    end: End | None
    seconds: float
    trace: Trace
    failure: str = ""

    @property
    def tells_all(self) -> bool:
        """Whether another run would add nothing: this one failed, or ran out of time."""
        return self.end is None or self.end.verdict == "time_limit"


def attempted(name: str, task: Task, time_limit: float) -> Attempt:
    """Run a method once; an error is a run that failed, and its words say how."""
    entry, target, unit = REGISTRY[name], task.best.shape, size(task.best.shape)
    mechanics = Mechanics(task.structure)
    most = EVALUATIONS_PER_ITERATION * task.options.max_iterations
    watch = None if entry.judges_itself else Watch(Gauge(mechanics), task.options.tolerance, most)

    def distance(X: np.ndarray) -> float:
        """Return the error in shape of (n, d) positions, over the structure's size."""
        return largest_move(X if entry.is_affine else laid_over(X, target, task.alignment), target) / unit

    trace = Trace(mechanics, watch, time_limit, distance)
    if entry.is_affine:
        trace.judged = lambda X: affinely(X, target)
    try:
        end = entry.run(task, trace)
    except Stop as stop:
        return Attempt(End(trace.X, stop.verdict), trace.seconds, trace)
    except CgffError as error:
        return Attempt(None, trace.seconds, trace, str(error))
    except Exception as error:  # a rival of any make: its row says how it failed
        return Attempt(None, trace.seconds, trace, f"{type(error).__name__}: {error}".rstrip(": "))
    return Attempt(end, trace.seconds, trace)
