"""Running one method once, under the clock, whatever becomes of it."""

from typing import NamedTuple

import numpy as np

from cgff_cli.errors import CgffError
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.rivals.registry import REGISTRY
from cgff_cli.rivals.task import End, Reference, Task
from cgff_cli.rivals.trace import Stop, Trace
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Gauge, Watch
from cgff_cli.structure import Structure
from cgff_cli.study.alignment import affinely, laid_over, largest_move, size

EVALUATIONS_PER_ITERATION = 50
"""Evaluations a rival may take for every iteration that the option max_iterations gives CGFF."""


class Setting(NamedTuple):
    """What all runs on one scene share.

    groups    : (b,) int, the scene's group of every element
    best      : the answer to the rounding floor
    alignment : how shapes are laid over it, "rigid" or "none"
    """

    structure: Structure
    groups: np.ndarray
    options: SolveOptions
    time_limit: float
    best: Solution
    alignment: str


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


def attempted(name: str, setting: Setting) -> Attempt:
    """Run a method once; an error is a run that failed, and its words say how."""
    trace = _trace(name, setting)
    reference = Reference(setting.best.shape, setting.best.force_densities)
    task = Task(setting.structure, setting.groups, setting.options, trace, reference)
    try:
        end = REGISTRY[name].run(task)
    except Stop as stop:
        return Attempt(End(trace.X, stop.verdict), trace.seconds, trace)
    except CgffError as error:
        return Attempt(None, trace.seconds, trace, str(error))
    except Exception as error:  # a rival of any make: its row says how it failed
        return Attempt(None, trace.seconds, trace, f"{type(error).__name__}: {error}".rstrip(": "))
    return Attempt(end, trace.seconds, trace)


def _trace(name: str, setting: Setting) -> Trace:
    """Return what watches a run of a method, and ends it unless it judges itself."""
    entry, options, target = REGISTRY[name], setting.options, setting.best.shape
    mechanics, unit = Mechanics(setting.structure), size(target)
    most = EVALUATIONS_PER_ITERATION * options.max_iterations
    watch = None if entry.judges_itself else Watch(Gauge(mechanics), options.tolerance, most)
    if entry.is_affine:
        return Trace(
            mechanics,
            watch,
            setting.time_limit,
            lambda X: largest_move(X, target) / unit,
            lambda X: affinely(X, target),
        )
    return Trace(
        mechanics,
        watch,
        setting.time_limit,
        lambda X: largest_move(laid_over(X, target, setting.alignment), target) / unit,
    )
