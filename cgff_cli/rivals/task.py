"""What a rival is given and gives back, and what watches it, with the clock stopped meanwhile."""

from collections.abc import Callable, Iterator, Sized
from dataclasses import replace
from itertools import takewhile
from time import perf_counter
from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Gauge, Verdict, Watch
from cgff_cli.structure import Structure

TOLERANCES = tuple(float(f"1e-{digits}") for digits in range(2, 13))
"""Relative residuals and shape errors at which iterations and time are noted."""


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


class AtResidual(NamedTuple):
    """When a run first had a relative residual within the tolerance, and its shape error then."""

    tolerance: float
    iterations: int | None = None
    seconds: float | None = None
    shape_error: float | None = None


class AtShape(NamedTuple):
    """When a run first had a shape error within the tolerance, and its relative residual then."""

    tolerance: float
    iterations: int | None = None
    seconds: float | None = None
    residual_relative: float | None = None


class Stop(Exception):  # noqa: N818 -- ends a run, not always in failure
    """Raised out of a rival when a stopping test holds; carries the verdict."""

    def __init__(self, verdict: str):
        self.verdict = verdict
        super().__init__(verdict)


class Trace:
    """Watches one run: a rival calls `start` once it is set up, and `add` for every shape it tries.

    All shapes are (n, d), about the centroid of the start, in the user's units. Measuring them is not
    counted in the rival's time. Where `watch` is given, `add` ends the run by raising Stop as soon as its
    tests hold, the same tests that end CGFF.

    distance : shape -> how far it is from the reference, over the reference's size
    judged   : shape -> the one to measure, for a rival whose answer is known up to an affine map
    """

    def __init__(
        self,
        mechanics: Mechanics,
        watch: Watch | None,
        time_limit: float,
        distance: Callable[[np.ndarray], float] | None = None,
    ):
        self.mechanics, self.watch, self.time_limit = mechanics, watch, time_limit
        self.distance = distance
        self.judged: Callable[[np.ndarray], np.ndarray] = np.asarray
        self.gauge = Gauge(mechanics)
        self.by_residual: dict[float, AtResidual] = {}
        self.by_shape: dict[float, AtShape] = {}
        self.X = mechanics.shape(mechanics.start)
        self.iterations: int | None = 0
        self.evaluations: int | None = 0
        self.start()

    def start(self) -> None:
        """Set the clock to zero."""
        self.begun, self.aside = perf_counter(), 0.0

    @property
    def seconds(self) -> float:
        """Wall clock since the start, without the time spent in `add`."""
        return perf_counter() - self.begun - self.aside

    def add(self, iterations: int | None, evaluations: int | None, X: np.ndarray) -> None:
        """Note the shape a run has come to; raises Stop where the run is to end here."""
        entered = perf_counter()
        seconds = entered - self.begun - self.aside
        self.X, self.iterations, self.evaluations = X, iterations, evaluations
        verdict = self._noted(seconds) if np.isfinite(X).all() else Verdict.DIVERGED
        self.aside += perf_counter() - entered
        if verdict is not None:
            raise Stop(verdict.value)
        if seconds > self.time_limit:
            raise Stop("time_limit")

    def _noted(self, seconds: float) -> Verdict | None:
        X = self.judged(self.X)
        state = self.mechanics.at(self.mechanics.moving(X))
        residual = self.gauge.measure(state).relative
        error = None if self.distance is None else self.distance(X)
        for tolerance in _passed(self.by_residual, residual):
            self.by_residual[tolerance] = AtResidual(tolerance, self.iterations, seconds, error)
        for tolerance in () if error is None else _passed(self.by_shape, error):
            self.by_shape[tolerance] = AtShape(tolerance, self.iterations, seconds, residual)
        return None if self.watch is None else self.watch.judge(state, self.evaluations or 0)


def _passed(reached: Sized, value: float) -> Iterator[float]:
    """Return the tolerances, not yet reached, that a value is within."""
    return takewhile(lambda tolerance: value <= tolerance, TOLERANCES[len(reached) :])


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
