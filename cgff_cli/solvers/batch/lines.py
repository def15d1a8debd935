"""The line searches of many rows, one trial at a time: `line_search` with arrays for numbers."""

import numpy as np

from cgff_cli.solvers.batch.rows import Rows
from cgff_cli.solvers.line_search import (
    ENOUGH_DECREASE,
    FLAT_ENOUGH_FOR_NEWTON,
    INSIDE,
    LARGEST_GROWTH,
    MAX_TRIALS,
)


def descends(s: Rows, rise: np.ndarray, noise: np.ndarray | float) -> np.ndarray:
    """Return where trials satisfy the first Wolfe condition."""
    return rise <= ENOUGH_DECREASE * s.alpha * s.slope + noise


def is_met(s: Rows, rise: np.ndarray, slope: np.ndarray, noise: np.ndarray | float) -> np.ndarray:
    """Return where trials satisfy both."""
    return descends(s, rise, noise) & (np.abs(slope) <= -FLAT_ENOUGH_FOR_NEWTON * s.slope)


def search(s: Rows, rise: np.ndarray, slope: np.ndarray, noise: np.ndarray, shrinks: np.ndarray) -> Rows:
    """Return the columns of lines after trials that do not meet both: brackets, and the next steps.

    shrinks: (N,) bool, whether the gradient is smaller there; a full step that shrinks it is as good where
    changes are rounding error. A step that is final is taken, whatever it meets; none is left where it is 0.
    """
    trial = np.stack((s.alpha, rise, slope), axis=1)
    is_low = (descends(s, rise, noise) & (slope < 0.0))[:, None]
    s.shrinks, s.tries = np.where(s.tries == 0, shrinks, s.shrinks), s.tries + 1
    s.low, s.high = np.where(is_low, trial, s.low), np.where(is_low, s.high, trial)
    low, high, a = s.low[:, 0], s.high[:, 0], _next(s, slope, noise)
    final = np.isfinite(high) & ~((low < a) & (a < high)) | (s.tries >= MAX_TRIALS)
    best = np.where((low == 0.0) & s.shrinks, 1.0, low)
    met = is_met(s, rise, slope, noise)
    alpha = np.where(met, s.alpha, np.where(final, best, a))
    return Rows(shrinks=s.shrinks, tries=s.tries, low=s.low, high=s.high, final=final, alpha=alpha)


def _next(s: Rows, slope: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Return the next steps of lines, as `line_search._next` does for one."""
    (low, low_rise, low_slope), (high, high_rise, high_slope) = s.low.T, s.high.T
    secant = np.where(slope > s.slope, s.alpha * s.slope / (s.slope - slope), np.inf)
    beyond = np.minimum(np.maximum(secant, 1.1 * s.alpha), LARGEST_GROWTH * s.alpha)
    width, bend = high - low, high_slope - low_slope
    c = low_slope + high_slope + 3.0 * (low_rise - high_rise) / width
    root = np.sqrt(c * c - low_slope * high_slope)
    cubic = high - width * (high_slope + root - c) / (bend + 2.0 * root)
    by_slopes = np.abs(high_rise - low_rise) <= noise
    a = np.where(by_slopes, np.where(bend > 0.0, low - width * low_slope / bend, np.inf), cubic)
    inside = (INSIDE * width <= a - low) & (a - low <= (1.0 - INSIDE) * width)
    return np.where(np.isinf(high), beyond, np.where(inside, a, low + 0.5 * width))
