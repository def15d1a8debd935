"""What a solver hands on: the last state, how it ended, and one row per iteration."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.solvers.stopping import Gauge, Verdict, sentence
from cgff_cli.structure import Structure

Observer = Callable[[dict[str, Any]], None]
"""Called once per iteration with that iteration's row of the history."""

Watcher = Callable[[int, int, np.ndarray], None]
"""Called once per iteration with its number, the evaluations so far, and the (n, d) shape about the
centroid of the start, in the user's units; what it raises ends the run."""

COLUMNS = (
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


class History:
    """One row of numbers per iteration, row 0 the start; never a copy of the shape."""

    def __init__(self, observer: Observer | None = None, watcher: Watcher | None = None):
        self.rows: list[tuple[float, ...]] = []
        self.observer, self.watcher = observer, watcher

    def add(self, *row: float) -> None:
        """Append one row, in the order of COLUMNS, and show it to the observer."""
        self.rows.append(row)
        if self.observer is not None:
            self.observer(dict(zip(COLUMNS, row, strict=True)))

    def columns(self) -> dict[str, list[Any]]:
        """Return column name -> one value per iteration."""
        return dict(zip(COLUMNS, map(list, zip(*self.rows, strict=True)), strict=True))


@dataclass(frozen=True)
class Solution:
    """The last state of a run, in the user's units, positions relative to `centre`.

    structure     : what was solved, where the user put it
    state         : shape, lengths, forces about `centre`: a far-away origin costs them no digits
    residual_max  : largest out-of-balance force component over the free directions
    residual_norm : its Euclidean norm over the free directions
    reference     : the force that residual_max was compared with
    floor         : estimated rounding error of residual_max
    history       : column name -> one value per iteration
    """

    structure: Structure
    state: State
    centre: np.ndarray
    verdict: Verdict
    message: str
    residual_max: float
    residual_norm: float
    reference: float
    floor: float
    iterations: int
    evaluations: int
    factorizations: int
    restarts: int
    history: dict[str, list[Any]]
    warnings: tuple[str, ...] = ()

    @property
    def coordinates(self) -> np.ndarray:
        """(n, d) final node positions."""
        return self.placed(self.state.X)

    def placed(self, X: np.ndarray) -> np.ndarray:
        """Return a shape about `centre` where the user has it: what is held keeps the very number given."""
        return np.where(self.structure.free, X + self.centre, self.structure.coordinates)

    @property
    def energy(self) -> float:
        """Total potential energy; loads do work from the user's own origin."""
        return self.state.energy - float((self.structure.loads @ self.centre).sum())


def concluded(
    structure: Structure,
    X: np.ndarray,
    centre: np.ndarray,
    verdict: Verdict,
    tolerance: float,
    history: History,
    evaluations: int,
    factorizations: int = 0,
    warnings: tuple[str, ...] = (),
) -> Solution:
    """Return the Solution for a last shape X, (n, d), in the user's units about `centre`."""
    state = Mechanics(replace(structure, coordinates=structure.coordinates - centre)).at(X)
    gauge = Gauge(state.mechanics)
    columns = history.columns()
    balance = gauge.measure(state)
    floor = balance.floor or gauge.rounding_floor(state)
    return Solution(
        structure=structure,
        state=state,
        centre=centre,
        verdict=verdict,
        message=sentence(verdict, balance, tolerance),
        residual_max=balance.residual,
        residual_norm=norm(state.free_eta),
        reference=balance.reference,
        floor=floor,
        iterations=len(history.rows) - 1,
        evaluations=evaluations,
        factorizations=factorizations,
        restarts=sum(columns["restarted"]),
        history=columns,
        warnings=warnings,
    )
