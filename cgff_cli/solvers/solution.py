"""What a solver hands on: the last state, how it ended, and one row per iteration."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cgff_cli.solvers.stopping import Verdict

HISTORY_COLUMNS = (
    "iteration",
    "objective",
    "residual_max",
    "gradient_norm",
    "step_norm",
    "alpha",
    "beta",
    "evaluations",
    "restarted",
)

Observer = Callable[[dict[str, Any]], None]
"""Called once per iteration with that iteration's row of the history."""


@dataclass(frozen=True)
class Solution:
    """The last state of a run, in the user's units.

    coordinates   : (n, d), final node positions
    residual_max  : largest out-of-balance force component over the free directions
    residual_norm : its Euclidean norm over the free directions
    reference     : the force that residual_max was compared with
    floor         : estimated rounding error of residual_max
    energy        : total potential energy
    history       : column name -> one value per iteration, row 0 the start
    """

    coordinates: np.ndarray
    verdict: Verdict
    message: str
    residual_max: float
    residual_norm: float
    reference: float
    floor: float
    energy: float
    iterations: int
    evaluations: int
    factorizations: int
    restarts: int
    history: dict[str, list[Any]]
    warnings: tuple[str, ...] = field(default=())
