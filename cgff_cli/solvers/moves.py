"""What the loop remembers from one iteration to the next."""

from typing import NamedTuple

import numpy as np

from cgff_cli.solvers.objectives import Line


class Direction(NamedTuple):
    """What a beta rule needs of the last iteration: gradient, preconditioned gradient, direction."""

    g: np.ndarray
    z: np.ndarray
    d: np.ndarray


class Move(NamedTuple):
    """One step taken, for the history."""

    step_norm: float
    alpha: float
    cg_beta: float
    restarted: bool


def parabola_step(line: Line, slope: float) -> float:
    """Return the step to the minimum of the parabola with the line's slope and curvature at 0."""
    curvature = line(0.0).curvature
    return -slope / curvature if curvature > 0.0 else 1.0
