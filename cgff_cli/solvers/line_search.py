"""Strong Wolfe steps from changes and slopes.

A step a along a descent direction is accepted when

    phi(a) - phi(0) <= c1 a phi'(0) + noise        (enough decrease)
    |phi'(a)| <= c2 |phi'(0)|                      (near a stationary point of the line)

with c2 a tenth where conjugacy does the work, and the 1/2 that Fletcher-Reeves needs for descent (Al-Baali
1985) where a fresh tangent does and a flatter point of the line gains nothing. The search interpolates
slopes by their secant inside a bracket, and halves a bracket that a secant did not; it needs no more where
changes are rounding error, which the noise term allows for.
"""

from collections.abc import Callable
from functools import cached_property

from cgff_cli.solvers.objectives import Line, Trial

TENFOLD = 10.0
"""The one factor by which what is too small grows, and what is too large shrinks (with 8 a scene is lost:
tests/studies/hard_suite.py)."""

HUNDREDFOLD = TENFOLD * TENFOLD
"""Where a little more is not enough."""

MOST_TRIALS = 60
"""Trials on a line, and unstable equilibria left behind, before it is enough (100 did as well, 20 did not at
kinks of eq. (10): tests/studies/hard_suite.py, tests/solvers/test_verdicts.py)."""

ENOUGH_DECREASE = 1e-4
"""c1, the textbook's; 0 did as well (tests/studies/hard_suite.py)."""
FLAT_ENOUGH = 1.0 / TENFOLD
FLAT_ENOUGH_FOR_NEWTON = 0.5


class Goal:
    """What a step has to satisfy: the slope at 0, the rounding error of a change, asked for once, and c2."""

    def __init__(self, slope: float, noise: Callable[[], float], flat: float):
        self.slope, self.flat, self._noise = slope, flat, noise

    @cached_property
    def noise(self) -> float:
        """The rounding error to expect in a change."""
        return self._noise()

    def descends(self, trial: Trial) -> bool:
        """Return whether a step satisfies the first condition."""
        least = ENOUGH_DECREASE * trial.step * self.slope
        return trial.change <= least or trial.change <= least + self.noise

    def is_met(self, trial: Trial) -> bool:
        """Return whether a step satisfies both conditions."""
        return abs(trial.slope) <= -self.flat * self.slope and self.descends(trial)


def strong_wolfe(line: Line, goal: Goal, trial: Trial) -> tuple[Trial, int]:
    """Return a strong Wolfe step along `line`, given a first trial, and how many more it took.

    low holds a trial that descends and still points down (or 0), high one beyond a minimum of the line.
    Where no trial satisfies both conditions, the last low is returned: it still descends, or is 0.
    """
    low, high, width = Trial(0.0, 0.0, goal.slope), None, float("inf")
    for count in range(MOST_TRIALS):
        if goal.is_met(trial):
            return trial, count
        if goal.descends(trial) and trial.slope < 0.0:
            low = trial
        else:
            high = trial
        if high is None:
            a = min(max(_secant(trial, goal.slope), trial.step), TENFOLD * trial.step)
        else:
            last, width = width, high.step - low.step
            a = _inside(low, high) if width <= 0.5 * last else low.step + 0.5 * width
            if not low.step < a < high.step:
                return low, count
        trial = line(a)
    return low, MOST_TRIALS


def _secant(trial: Trial, slope: float) -> float:
    """Return where the slope would vanish if it went on changing as it did from 0 to the trial."""
    return trial.step * slope / (slope - trial.slope) if trial.slope > slope else float("inf")


def _inside(low: Trial, high: Trial) -> float:
    """Return where the secant of the slopes crosses zero, or the middle if that is near either end."""
    width, rise = high.step - low.step, high.slope - low.slope
    share = -low.slope / rise if rise > 0.0 else 0.0
    return low.step + width * (share if 1.0 / TENFOLD <= share <= 1.0 - 1.0 / TENFOLD else 0.5)
