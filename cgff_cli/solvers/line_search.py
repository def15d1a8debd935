"""Strong Wolfe steps from directional derivatives.

A step a along a descent direction is accepted when

    phi(a) - phi(0) <= c1 a phi'(0) + noise        (enough decrease)
    |phi'(a)| <= c2 |phi'(0)|                      (near a stationary point of the line)

with c2 below the 1/2 that Fletcher-Reeves needs for descent (Al-Baali 1985): 0.1 where conjugacy does the
work, 0.4 where a fresh tangent does and a flatter point of the line gains nothing. The search is a
safeguarded Newton iteration on phi'; the noise term lets it go on by slopes alone when changes of phi are
rounding error.
"""

from typing import NamedTuple

from cgff_cli.solvers.objectives import Line, Trial

ENOUGH_DECREASE = 1e-4
FLAT = 0.1
FLAT_ENOUGH_FOR_NEWTON = 0.4
LARGEST_GROWTH = 10.0
MAX_TRIALS = 60


class Step(NamedTuple):
    """The step found, 0 if none descends; `evaluations` counts the trials."""

    length: float
    evaluations: int


class Goal(NamedTuple):
    """What a step has to satisfy: the slope at 0, the rounding error of a change, and c2."""

    slope: float
    noise: float
    flat: float

    def descends(self, a: float, change: float) -> bool:
        """Return whether a step with this change satisfies the first condition."""
        return change <= ENOUGH_DECREASE * a * self.slope + self.noise

    def is_met(self, a: float, change: float, slope: float) -> bool:
        """Return whether a step with this change and slope satisfies both conditions."""
        return self.descends(a, change) and abs(slope) <= -self.flat * self.slope


def strong_wolfe(line: Line, goal: Goal, first: float) -> Step:
    """Return a strong Wolfe step along `line`, trying `first` first.

    low holds a trial that descends and still points down (or 0), high one beyond a minimum of the line.
    Where no trial satisfies both conditions, the last low is returned: it still descends.
    """
    low, high = Trial(0.0, 0.0, goal.slope, 0.0), None
    a = first
    for evaluations in range(1, MAX_TRIALS + 1):
        trial = line(a)
        if goal.is_met(a, trial.change, trial.slope):
            return Step(a, evaluations)
        if goal.descends(a, trial.change) and trial.slope < 0.0:
            low = trial
        else:
            high = trial
        a = _next(trial, low, high)
        if high is not None and not low.step < a < high.step:
            break
    return Step(low.step, evaluations)


def _next(trial: Trial, low: Trial, high: Trial | None) -> float:
    """Return a Newton step on phi' from the last trial, kept well inside the bracket."""
    newton = trial.step - trial.slope / trial.curvature if trial.curvature > 0.0 else float("inf")
    if high is None:
        return min(max(newton, 1.1 * trial.step), LARGEST_GROWTH * trial.step)
    width = high.step - low.step
    if not low.step + 0.01 * width <= newton <= high.step - 0.01 * width:
        newton = low.step + 0.5 * width
    return newton
