"""What a solver hands on: the last state, how it ended, and one row per iteration."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from cgff_cli.mechanics import elements
from cgff_cli.mechanics.connectivity import DENSE_ENTRIES
from cgff_cli.mechanics.elements import TINY
from cgff_cli.mechanics.norms import largest, norm
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
    """The iterates of a run as rows of numbers, row 0 the start; never a copy of a large shape.

    Rows are made when somebody reads or watches. Until then a small scene keeps its states, which cost
    nothing more, as long as they are no more than a dense rho; a large scene keeps none.
    """

    def __init__(self, mechanics: Mechanics, objective: Objective, observer: Observer | None = None):
        self.frame, self.objective, self.observer = mechanics.frame, objective, observer
        is_lazy = mechanics.is_small and observer is None
        self.most_kept = DENSE_ENTRIES // len(mechanics.k) if is_lazy else 0
        self._kept: list[Iterate] = []
        self._rows: list[tuple[Any, ...]] = []

    def __len__(self) -> int:
        return len(self._rows) + len(self._kept)

    def add(self, iterate: Iterate) -> None:
        """Append an iterate, and show it to the observer."""
        self._kept.append(iterate)
        if len(self._kept) > self.most_kept:
            rows = self.rows()
            if self.observer is not None:
                self.observer(dict(zip(COLUMNS, rows[-1], strict=True)))

    def rows(self) -> list[tuple[Any, ...]]:
        """Return a row per iterate, in the order of COLUMNS and in the user's units."""
        self._rows += map(self._row, self._kept)
        self._kept.clear()
        return self._rows

    def columns(self) -> dict[str, list[Any]]:
        """Return column name -> one value per iteration."""
        return dict(zip(COLUMNS, map(list, zip(*self.rows(), strict=True)), strict=True))

    def _row(self, iterate: Iterate) -> tuple[Any, ...]:
        k, state, (step, alpha, cg_beta, restarted), evaluations = iterate
        frame, objective = self.frame, self.objective
        is_energy = objective.name == "energy"
        value = objective.value(state)
        return (
            k,
            _from_origin(value, state.mechanics) if is_energy else value * frame.force * frame.force,
            largest(state.g) * frame.force,
            objective.size(state) * (frame.force if is_energy else frame.force * frame.stiffness),
            step * frame.length,
            alpha,
            cg_beta,
            evaluations,
            restarted,
        )


def _from_origin(energy: float, mechanics: Mechanics) -> float:
    """Return an energy of the frame where loads do work from the user's own origin."""
    frame = mechanics.frame
    return energy * frame.energy - float((mechanics.structure.loads * frame.centre).sum())


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
        """How far the forces are from balance, in the frame's units."""
        return Gauge(self.mechanics).measure(self.state)

    @property
    def message(self) -> str:
        """What was reached, and which test ended the run, in one sentence."""
        return sentence(self.verdict, self.balance, self.tolerance)

    @property
    def iterations(self) -> int:
        """Steps taken."""
        return len(self.record) - 1 if self.record else 0

    @property
    def restarts(self) -> int:
        """Iterations whose direction was reset."""
        return sum(row[-1] for row in self.record.rows()) if self.record else 0

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
        """(n, d) final node positions; where nothing moved, to the bit those of the start."""
        m = self.mechanics
        if np.array_equal(self.state.X, m.start):
            return np.array(m.structure.coordinates)
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
        state = self.state
        shrunk = (self.mechanics.l0 == 0.0) & (self._some_length == 0.0)
        gone = float(elements.energy(state.t[shrunk], state.e[shrunk]))
        return _from_origin(state.energy - gone, self.mechanics)

    @property
    def energy_floor(self) -> float:
        """Estimated rounding error of energy: of extensions, however small, and of the work of loads."""
        state, structure, frame = self.state, self.mechanics.structure, self.mechanics.frame
        blur = self.mechanics.k * state.rounding * (np.abs(state.e) + state.rounding)
        places = np.abs(self.shape) + np.abs(frame.centre)
        return float(blur.sum()) * frame.energy + elements.EPS * float(
            (np.abs(structure.loads) * places).sum()
        )
