"""Strong Wolfe steps from directional derivatives.

A step a along a descent direction is accepted when

    phi(a) <= phi(0) + c1 a phi'(0) + noise        (enough decrease)
    |phi'(a)| <= c2 |phi'(0)|                      (near a stationary point of the line)

with c2 = 0.1, below the 1/2 that Fletcher-Reeves needs for descent (Al-Baali 1985). The search is a
safeguarded Newton iteration on phi': the noise term lets it go on judging by slopes when differences of
phi are rounding error.
"""

from typing import NamedTuple

from cgff_cli.solvers.objectives import Line, Trial

ENOUGH_DECREASE = 1e-4
ENOUGH_FLATNESS = 0.1
LARGEST_GROWTH = 10.0
MAX_TRIALS = 60


class Step(NamedTuple):
    """An accepted step, or the best one found; `evaluations` counts the trials."""

    length: float
    change: float
    accepted: bool
    evaluations: int


def strong_wolfe(line: Line, slope: float, noise: float, first: float = 1.0) -> Step:
    """Return a strong Wolfe step along `line`, whose slope at 0 is `slope` < 0.

    low holds a trial that descends and still points down (or 0), high one beyond a minimum of the line.
    """
    low = Trial(0.0, 0.0, slope, 0.0)
    high: Trial | None = None
    a = first
    for evaluations in range(1, MAX_TRIALS + 1):
        trial = line(a)
        enough = trial.change <= ENOUGH_DECREASE * a * slope + noise
        if enough and abs(trial.slope) <= -ENOUGH_FLATNESS * slope:
            return Step(a, trial.change, True, evaluations)
        if not enough or trial.slope > 0.0 or trial.change != trial.change:
            high = trial
        else:
            low = trial
        a = _next(trial, low, high)
        if high is not None and not low.step < a < high.step:
            break
    return Step(low.step, low.change, False, evaluations)


def _next(trial: Trial, low: Trial, high: Trial | None) -> float:
    """Return a Newton step on phi' from the last trial, kept well inside the bracket."""
    newton = trial.step - trial.slope / trial.curvature if trial.curvature > 0.0 else float("inf")
    if high is None:
        most = LARGEST_GROWTH * max(trial.step, low.step)
        return min(max(newton, 1.1 * trial.step), most)
    width = high.step - low.step
    if not low.step + 0.01 * width <= newton <= high.step - 0.01 * width:
        newton = low.step + 0.5 * width
    return newton
