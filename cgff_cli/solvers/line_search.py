"""Strong Wolfe steps from directional derivatives.

A step a along a descent direction is accepted when

    phi(a) - phi(0) <= c1 a phi'(0) + noise        (enough decrease)
    |phi'(a)| <= c2 |phi'(0)|                      (near a stationary point of the line)

with c2 = 0.1, below the 1/2 that Fletcher-Reeves needs for descent (Al-Baali 1985). The search is a
safeguarded Newton iteration on phi'; the noise term lets it go on by slopes alone when changes of phi are
rounding error.
"""

from typing import NamedTuple

from cgff_cli.solvers.objectives import Line, Trial

ENOUGH_DECREASE = 1e-4
ENOUGH_FLATNESS = 0.1
LARGEST_GROWTH = 10.0
MAX_TRIALS = 60


class Step(NamedTuple):
    """The step found, 0 if none descends; `evaluations` counts the trials."""

    length: float
    evaluations: int


def is_strong_wolfe(a: float, change: float, slope: float, slope_at_0: float, noise: float) -> bool:
    """Return whether a step with this change and slope satisfies both conditions."""
    enough = change <= ENOUGH_DECREASE * a * slope_at_0 + noise
    return enough and abs(slope) <= -ENOUGH_FLATNESS * slope_at_0


def strong_wolfe(line: Line, slope: float, noise: float, first: float) -> Step:
    """Return a strong Wolfe step along `line`, whose slope at 0 is `slope` < 0, trying `first` first.

    low holds a trial that descends and still points down (or 0), high one beyond a minimum of the line.
    Where no trial satisfies both conditions, the last low is returned: it still descends.
    """
    low, high = Trial(0.0, 0.0, slope, 0.0), None
    a = first
    for evaluations in range(1, MAX_TRIALS + 1):
        trial = line(a)
        if is_strong_wolfe(a, trial.change, trial.slope, slope, noise):
            return Step(a, evaluations)
        if trial.change <= ENOUGH_DECREASE * a * slope + noise and trial.slope < 0.0:
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
