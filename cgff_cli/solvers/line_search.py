"""Strong Wolfe steps from changes and slopes.

A step a along a descent direction is accepted when

    phi(a) - phi(0) <= c1 a phi'(0) + noise        (enough decrease)
    |phi'(a)| <= c2 |phi'(0)|                      (near a stationary point of the line)

with c2 below the 1/2 that Fletcher-Reeves needs for descent (Al-Baali 1985): 0.1 where conjugacy does the
work, 0.4 where a fresh tangent does and a flatter point of the line gains nothing. The search interpolates
by cubics inside a bracket; the noise term lets it go on by slopes alone where changes are rounding error.
"""

from math import sqrt
from typing import NamedTuple

from cgff_cli.solvers.objectives import Line, Trial

ENOUGH_DECREASE = 1e-4
FLAT = 0.1
FLAT_ENOUGH_FOR_NEWTON = 0.4
LARGEST_GROWTH = 10.0
INSIDE = 0.05
"""Share of the bracket that a trial keeps from either end."""
MAX_TRIALS = 60


class Goal(NamedTuple):
    """What a step has to satisfy: the slope at 0, the rounding error of a change, and c2."""

    slope: float
    noise: float
    flat: float

    def descends(self, trial: Trial) -> bool:
        """Return whether a step satisfies the first condition."""
        return trial.change <= ENOUGH_DECREASE * trial.step * self.slope + self.noise

    def is_met(self, trial: Trial) -> bool:
        """Return whether a step satisfies both conditions."""
        return self.descends(trial) and abs(trial.slope) <= -self.flat * self.slope


def strong_wolfe(line: Line, goal: Goal, trial: Trial) -> tuple[Trial, int]:
    """Return a strong Wolfe step along `line`, given a first trial, and how many more it took.

    low holds a trial that descends and still points down (or 0), high one beyond a minimum of the line.
    Where no trial satisfies both conditions, the last low is returned: it still descends, or is 0.
    """
    low, high = Trial(0.0, 0.0, goal.slope), None
    for count in range(MAX_TRIALS):
        if goal.is_met(trial):
            return trial, count
        if goal.descends(trial) and trial.slope < 0.0:
            low = trial
        else:
            high = trial
        a = _next(trial, low, high, goal)
        if high is not None and not low.step < a < high.step:
            return low, count
        trial = line(a)
    return low, MAX_TRIALS


def _next(trial: Trial, low: Trial, high: Trial | None, goal: Goal) -> float:
    """Return the next step: the secant's, or beyond, until there is a bracket; else the cubic's inside it.

    Where changes are rounding error slopes alone tell, and the secant takes the cubic's place.
    """
    a, slope = trial.step, goal.slope
    if high is None:
        secant = a * slope / (slope - trial.slope) if trial.slope > slope else float("inf")
        return min(max(secant, 1.1 * a), LARGEST_GROWTH * a)
    width = high.step - low.step
    if abs(high.change - low.change) <= goal.noise:
        rise = high.slope - low.slope
        a = low.step - width * low.slope / rise if rise > 0.0 else float("inf")
    else:
        a = _cubic(low, high)
    return a if INSIDE * width <= a - low.step <= (1.0 - INSIDE) * width else low.step + 0.5 * width


def _cubic(low: Trial, high: Trial) -> float:
    """Return the minimum of the cubic through changes and slopes at both ends (Nocedal and Wright, 3.59)."""
    width = high.step - low.step
    s = low.slope + high.slope + 3.0 * (low.change - high.change) / width
    square = s * s - low.slope * high.slope
    if not square >= 0.0:
        return float("inf")
    root = sqrt(square)
    below = high.slope - low.slope + 2.0 * root
    return high.step - width * (high.slope + root - s) / below if below else float("inf")
