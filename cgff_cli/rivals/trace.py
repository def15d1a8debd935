"""What a run passes through: when it first reached each tolerance, with the clock stopped meanwhile."""

from collections.abc import Callable
from time import perf_counter
from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics.state import Mechanics
from cgff_cli.solvers.stopping import Gauge, Verdict, Watch

TOLERANCES = tuple(float(f"1e-{digits}") for digits in range(2, 13))
"""Relative residuals and shape errors at which iterations and time are noted."""

Distance = Callable[[np.ndarray], float]
"""Shape (n, d) -> how far it is from the reference, over the reference's size."""

Fit = Callable[[np.ndarray], np.ndarray]
"""Shape (n, d) -> the shape that is judged, for a rival whose answer is known up to an affine map."""


class Mark(NamedTuple):
    """The first time that a run was within a tolerance; iterations is None where a rival counts none."""

    iterations: int | None
    seconds: float
    residual: float
    shape_error: float | None


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
    """

    def __init__(
        self,
        mechanics: Mechanics,
        watch: Watch | None,
        time_limit: float,
        distance: Distance | None = None,
    ):
        self.mechanics, self.watch = mechanics, watch
        self.time_limit, self.distance = time_limit, distance
        self.fit: Fit = np.asarray
        self.gauge = Gauge(mechanics)
        self.by_residual: dict[float, Mark] = {}
        self.by_shape: dict[float, Mark] = {}
        self.X = mechanics.shape(mechanics.start)
        self.iterations: int | None = 0
        self.evaluations: int | None = 0
        self.begun = perf_counter()
        self.aside = 0.0

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
        verdict = self._noted(X, iterations, evaluations, seconds)
        self.aside += perf_counter() - entered
        if verdict is not None:
            raise Stop(verdict.value)
        if seconds > self.time_limit:
            raise Stop("time_limit")

    def _noted(
        self, X: np.ndarray, iterations: int | None, evaluations: int | None, seconds: float
    ) -> Verdict | None:
        if not np.isfinite(X).all():
            return Verdict.DIVERGED
        judged = self.fit(X)
        state = self.mechanics.at(self.mechanics.moving(judged))
        residual = self.gauge.measure(state).relative
        error = None if self.distance is None else self.distance(judged)
        mark = Mark(iterations, seconds, residual, error)
        _note(self.by_residual, residual, mark)
        if error is not None:
            _note(self.by_shape, error, mark)
        return None if self.watch is None else self.watch.judge(state, evaluations or 0)


def _note(marks: dict[float, Mark], value: float, mark: Mark) -> None:
    for tolerance in TOLERANCES[len(marks) :]:
        if not value <= tolerance:
            return
        marks[tolerance] = mark
