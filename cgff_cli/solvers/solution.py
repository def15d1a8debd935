"""What a solver hands on: the last state, how it ended, and one row per iteration."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from cgff_cli.mechanics import elements
from cgff_cli.mechanics.elements import TINY
from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.solvers.objectives import Objective
from cgff_cli.solvers.run import Iterate
from cgff_cli.solvers.stopping import Balance, Gauge, Verdict, sentence

Observer = Callable[[dict[str, Any]], None]
"""Called once per iteration with that iteration's row of the history."""

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
    """The iterates of a run as rows of numbers, row 0 the start; never a copy of the shape.

    Rows are made when somebody reads or watches. Until then a small scene's keep two gradients, which cost
    less than their norms; a large scene's do not.
    """

    def __init__(self, mechanics: Mechanics, objective: Objective, observer: Observer | None = None):
        self.frame, self.is_small = mechanics.frame, mechanics.is_small
        self.is_energy, self.observer = objective.name == "energy", observer
        self.rows: list[tuple[Any, ...]] = []

    def add(self, iterate: Iterate) -> None:
        """Append an iterate, and show it to the observer."""
        k, state, value, g, move, evaluations = iterate
        row = (k, value, state.g, g, *move, evaluations)
        if not self.is_small or self.observer is not None:
            row = self._measured(row)
        self.rows.append(row)
        if self.observer is not None:
            self.observer(dict(zip(COLUMNS, self._told(row), strict=True)))

    @property
    def restarts(self) -> int:
        """Iterations whose direction was reset."""
        return sum(row[7] for row in self.rows)

    def columns(self) -> dict[str, list[Any]]:
        """Return column name -> one value per iteration, in the user's units."""
        told = [self._told(self._measured(row)) for row in self.rows]
        return dict(zip(COLUMNS, map(list, zip(*told, strict=True)), strict=True))

    def _measured(self, row: tuple[Any, ...]) -> tuple[Any, ...]:
        """Return a row with norms in place of gradients."""
        if isinstance(row[2], float):
            return row
        return (*row[:2], float(np.abs(row[2]).max(initial=0.0)), norm(row[3]), *row[4:])

    def _told(self, row: tuple[Any, ...]) -> tuple[Any, ...]:
        """Return a measured row in the order of COLUMNS and in the user's units."""
        k, value, residual, slope, step, alpha, cg_beta, restarted, evaluations = row
        frame = self.frame
        unit = frame.energy if self.is_energy else frame.force * frame.force
        slope_unit = frame.force if self.is_energy else frame.force * frame.stiffness
        return (
            k,
            value * unit,
            residual * frame.force,
            slope * slope_unit,
            step * frame.length,
            alpha,
            cg_beta,
            evaluations,
            restarted,
        )


@dataclass(frozen=True, eq=False)
class Solution:
    """The last state of a run, and how it ended; all that is public is in the user's units.

    Scaling back by powers of two rounds nothing: lengths, forces and residuals are those of the state.
    """

    state: State
    verdict: Verdict
    tolerance: float
    evaluations: int
    factorizations: int = 0
    record: History | None = None
    warnings: tuple[str, ...] = ()

    @property
    def mechanics(self) -> Mechanics:
        """The structure in its frame."""
        return self.state.mechanics

    @cached_property
    def balance(self) -> Balance:
        """How far the forces are from balance, in the frame's units, the floor measured."""
        gauge = Gauge(self.mechanics)
        balance = gauge.measure(self.state)
        return balance._replace(floor=balance.floor or gauge.rounding_floor(self.state))

    @property
    def message(self) -> str:
        """What was reached, and which test ended the run, in one sentence."""
        return sentence(self.verdict, self.balance, self.tolerance)

    @property
    def iterations(self) -> int:
        """Steps taken."""
        return len(self.record.rows) - 1 if self.record else 0

    @property
    def restarts(self) -> int:
        """Iterations whose direction was reset."""
        return self.record.restarts if self.record else 0

    @cached_property
    def history(self) -> dict[str, list[Any]]:
        """Column name -> one value per iteration."""
        return self.record.columns() if self.record else {}

    @cached_property
    def shape(self) -> np.ndarray:
        """(n, d) positions about the centroid of the start: a far-away origin costs them no digits."""
        return self.mechanics.shape(self.state.X)

    @cached_property
    def coordinates(self) -> np.ndarray:
        """(n, d) final node positions."""
        return self.placed(self.shape)

    def placed(self, shape: np.ndarray) -> np.ndarray:
        """Return a shape about the centroid where the user has it; what is held keeps the number given."""
        structure = self.mechanics.structure
        return np.where(structure.free, shape + self.mechanics.frame.centre, structure.coordinates)

    @property
    def lengths(self) -> np.ndarray:
        """(b,) lengths, eq. (7)."""
        return self._some_length * self.state.l * self.mechanics.frame.length

    @property
    def forces(self) -> np.ndarray:
        """(b,) forces, eq. (2); tension > 0, a slack cable 0."""
        t = np.where(self.mechanics.l0 > 0.0, self.state.t, self.state.t * self._some_length)
        return t * self.mechanics.frame.force

    @property
    def _some_length(self) -> np.ndarray:
        """(b,) 1, but 0 where ends coincide, which the mechanics gives a length all the same."""
        return np.where(self.state.l > 2.0 * TINY, 1.0, 0.0)

    @property
    def force_densities(self) -> np.ndarray:
        """(b,) force densities q = t / l."""
        return self.state.q * self.mechanics.frame.stiffness

    @property
    def slack(self) -> np.ndarray:
        """(b,) bool, cables shorter than their rest length."""
        return self.state.slack

    @property
    def reactions(self) -> np.ndarray:
        """(n, d) forces that supports exert on their nodes, zero in free directions."""
        structure, frame = self.mechanics.structure, self.mechanics.frame
        return np.where(structure.free, 0.0, self.state.pull() * frame.force - structure.loads)

    @property
    def residual_max(self) -> float:
        """Largest out-of-balance force component over the free directions."""
        return self.balance.residual * self.mechanics.frame.force

    @property
    def residual_norm(self) -> float:
        """Its Euclidean norm."""
        return norm(self.state.g) * self.mechanics.frame.force

    @property
    def reference(self) -> float:
        """The force that residual_max is compared with."""
        return self.balance.reference * self.mechanics.frame.force

    @property
    def floor(self) -> float:
        """Estimated rounding error of residual_max."""
        return self.balance.floor * self.mechanics.frame.force

    @property
    def relative(self) -> float:
        """residual_max over reference; the residual itself where there is nothing to compare it with."""
        return self.balance.relative

    @property
    def energy(self) -> float:
        """Total potential energy; loads do work from the user's own origin."""
        state, structure, frame = self.state, self.mechanics.structure, self.mechanics.frame
        shrunk = (self.mechanics.l0 == 0.0) & (self._some_length == 0.0)
        energy = state.energy - float(elements.energy(state.t[shrunk], state.e[shrunk]))
        return energy * frame.energy - float((structure.loads * frame.centre).sum())
