"""The loop of eq. (13) for many rows at once, each at its own pace.

In turn every row is evaluated at the end of its step. Where the step is a strong Wolfe one the row moves
there and takes a new direction, elsewhere it gets the next trial of its line: the rules and numbers of
`descent` and `line_search`, for one row as for a thousand. Rows that balance leave, others take their place.
Rows that need more than this, or are no equilibrium that arithmetic is sure of, are left to `form_find`.
"""

import numpy as np

from cgff_cli.mechanics import elements
from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.signs import MOST_REFINEMENTS
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.batch.lines import is_met, search
from cgff_cli.solvers.batch.rows import Rows, Topology, dot, joined, shifted, solved
from cgff_cli.solvers.batch.signs import BALANCED, NEUTRAL, OPEN, measured, signs
from cgff_cli.solvers.batch.values import Values
from cgff_cli.solvers.descent import DOWNHILL, LOST_CONJUGACY, MOST_FAILURES
from cgff_cli.solvers.preconditioners.base import (
    CAUTION,
    FIRST_SHIFT,
    GOOD_PROGRESS,
    LEAST_SHIFT,
    LONG_STEP,
    SHORT_STEP,
)
from cgff_cli.solvers.saddles import COINCIDENT
from cgff_cli.solvers.stopping import FAR, FAR_ABOVE, PATIENCE, VANISHED, WAIT
from cgff_cli.structure import Structure

MOTIONS = ("X", "all", "loose")
MATRIX = (*MOTIONS, "V", "l", "q", "g", "l0", "kl0", "S", "mu")
STATE = (*MATRIX, "e", "t", "norm", "k", "load", "at_start", "stiffest", "is_covered")
ANSWER = (*STATE, "F", "held", "number", "iteration", "centre", "length", "stiffness")
LINE = ("X", "all", "l", "e", "t", "norm", "alpha", "slope", "tries", "shrinks", "low", "high")
"""Columns that tell loose motions, a matrix, a state's signs, an answer, and the next trial of a line."""

AT_ONCE = 1024
"""Rows in work at a time: prisms take a tenth longer with 512, no less with 2048 (tests/studies/many.py)."""

ENTRIES = 2**21
"""Entries of all matrices in work at a time: 16 MB each for those of a step and of loose motions."""


class Many:
    """What came of m rows.

    known     : (m,) OPEN, BALANCED, NEUTRAL or STABLE     iterations, relative, energy : (m,)
    coordinates (m, n, d), forces (m, b), energy in the user's units, of rows that are not OPEN
    nearly    : row -> (d, n_moving) positions in the row's frame, where the batch knows no more than BALANCED
    """

    def __init__(self, structure: Structure, values: Values, options: SolveOptions):
        self.structure, self.values, self.options = structure, values, options
        m = len(values.loads)
        self.known, self.iterations = np.full(m, OPEN), np.zeros(m, dtype=int)
        self.relative, self.energy = np.zeros(m), np.zeros(m)
        self.coordinates = np.array(values.coordinates)
        self.forces = np.zeros(values.stiffness.shape)
        self.nearly: dict[int, np.ndarray] = {}
        self.balanced: list[Rows] = []

    def run(self) -> None:
        """Go through all rows; work in hand is filled up when a quarter of it has left."""
        self.topology = Topology(self.structure)
        m, f = len(self.known), len(self.topology.dofs)
        at_once = min(AT_ONCE, 1 + ENTRIES // (f * f))
        with np.errstate(all="ignore"):
            rows = self._begun(np.arange(min(m, at_once)))
            begun = len(rows.number)
            while rows.active.any() or begun < m:
                idle = np.flatnonzero(~rows.active)[: m - begun]
                if begun == m:
                    rows = rows.take(rows.active) if 2 * rows.active.sum() <= len(rows.active) else rows
                elif 4 * len(idle) >= min(at_once, m - begun):
                    rows.fill(idle, self._begun(np.arange(begun, begun + len(idle))))
                    begun += len(idle)
                self._step(rows)
                if sum(len(s.number) for s in self.balanced) >= at_once:
                    self._conclude()
            if self.balanced:
                self._conclude()

    def _begun(self, number: np.ndarray) -> Rows:
        """Return rows at their starts, with their first directions."""
        top, N, f = self.topology, len(number), len(self.topology.dofs)
        rows = top.framed(*self.values.take(number))
        start = top.at(rows, rows.start)
        short = (start.l < COINCIDENT) & (top.least < 0.0) & (rows.l0 > 0.0)
        rows = Rows(
            number=number,
            **vars(rows),
            **vars(start),
            active=~short.any(1),
            iteration=np.zeros(N, dtype=int),
            best=np.full(N, np.inf),
            waited=np.zeros(N, dtype=int),
            R=np.zeros((N, f, f)),
            mu=np.full(N, FIRST_SHIFT),
            trusted=np.zeros(N, dtype=bool),
            z=np.zeros((N, f)),
            gz=np.zeros(N),
            d=np.zeros((N, f)),
            slope=np.zeros(N),
            alpha=np.zeros(N),
            final=np.zeros(N, dtype=bool),
            tries=np.zeros(N, dtype=int),
            shrinks=np.zeros(N, dtype=bool),
            low=np.zeros((N, 3)),
            high=np.full((N, 3), np.inf),
        )
        self._turn(rows, rows.active.copy())
        return rows

    def _step(self, rows: Rows) -> None:
        """Evaluate every row at the end of its step; it moves there, or gets another step."""
        step = rows.alpha[:, None] * rows.d
        there = self.topology.at(rows, self.topology.moved(rows.X, step))
        rise = 0.5 * dot(rows.k * (there.e - rows.e), there.e + rows.e) - dot(rows.F, step)
        slope = dot(there.g, rows.d)
        moves = rows.final | is_met(rows, rise, slope, 0.0)
        short = np.flatnonzero(rows.active & ~moves)
        if len(short):
            s = rows.take(short, *LINE)
            blur = s.t * self.topology.rounding(s)
            noise = 4.0 * np.sqrt(dot(blur, blur))
            moves[short] = is_met(s, rise[short], slope[short], noise)
            rows.fill(short, search(s, rise[short], slope[short], noise, there.norm[short] < s.norm))
        X = rows.X.reshape(len(step), -1)
        rows.active &= ~moves | (np.sqrt(dot(step, step)) > EPS * np.sqrt(dot(X, X)))
        self._arrive(rows, there, rows.active & moves)

    def _arrive(self, rows: Rows, there: Rows, moved: np.ndarray) -> None:
        """Move rows to their states, adapt shifts, and set out again; moved: (N,) bool."""
        shrinkage = np.minimum(there.norm / np.where(rows.norm > 0.0, rows.norm, 1.0), 0.1)
        lower = np.maximum(rows.mu * shrinkage, LEAST_SHIFT)
        mu = np.where(rows.alpha > LONG_STEP, lower, np.where(rows.alpha < SHORT_STEP, 10.0, 1.0) * rows.mu)
        rows.mu = np.where(moved, mu, rows.mu)
        rows.iteration += moved
        rows.trusted = np.where(
            moved, (rows.alpha == 1.0) & (there.norm < GOOD_PROGRESS * rows.norm), rows.trusted
        )
        rows.put(moved, there)
        self._turn(rows, moved)

    def _turn(self, rows: Rows, moved: np.ndarray) -> None:
        """Ask the stopping tests of rows that have moved, and give those that go on a new direction."""
        halved = rows.norm <= 0.5 * rows.best
        rows.best = np.where(halved & moved, rows.norm, rows.best)
        rows.waited = np.where(halved, 0, rows.waited + moved)
        residual, reference = np.abs(rows.g).max(1), np.maximum(np.abs(rows.t).max(1), rows.load)
        balanced = moved & (residual <= self.options.tolerance * reference)
        no_force = reference <= VANISHED * FAR_ABOVE * EPS * rows.at_start
        hopeless = (rows.waited >= WAIT) | (rows.iteration >= self.options.max_iterations)
        near = np.flatnonzero(moved & ~balanced & (no_force | (rows.waited >= PATIENCE)))
        if len(near):
            other, floor = measured(self.topology, rows.take(near, *STATE), reference[near])
            balanced[near] = residual[near] <= self.options.tolerance * other
            hopeless[near] |= (rows.waited[near] >= PATIENCE) & (residual[near] <= floor)
        if (balanced & rows.active).any():
            self.balanced.append(rows.take(balanced & rows.active, *ANSWER))
        rows.active &= ~balanced & ~hopeless & (rows.norm < FAR)
        self._direct(rows, moved & rows.active)

    def _direct(self, rows: Rows, goes: np.ndarray) -> None:
        """Give rows the direction of eq. (13), restarted as in `descent`, and its full step to try."""
        first = rows.iteration == 0
        z, uphill = self._preconditioned(rows, goes, first)
        gz = dot(rows.g, z)
        fr = np.where(rows.gz != 0.0, gz / rows.gz, 0.0)
        d = fr[:, None] * rows.d - z
        slope = dot(rows.g, d)
        restart = (
            first | uphill | (np.abs(dot(rows.g, rows.z)) > LOST_CONJUGACY * gz) | (slope > -DOWNHILL * gz)
        )
        d, slope = np.where(restart[:, None], -z, d), np.where(restart, -gz, slope)
        line = np.stack((np.zeros_like(slope), np.zeros_like(slope), slope), axis=1)
        new = Rows(
            z=z, gz=gz, d=d, slope=slope, low=line, alpha=np.ones_like(slope), final=np.zeros_like(goes)
        )
        rows.put(goes, new)
        rows.high[goes], rows.tries[goes] = np.inf, 0
        rows.active &= ~goes | (slope < 0.0)

    def _preconditioned(
        self, rows: Rows, goes: np.ndarray, first: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return M^-1 g, (N, f), NaN where no M has a Cholesky factor, and (N,) bool: where trust failed.

        Shifts grow and loose motions are renewed as `Tangent` and `DenseTangent` do it.
        """
        renew = goes & (rows.loose > 0.0) & (first | (rows.alpha < LONG_STEP))
        if renew.any():
            rows.R[renew] = self.topology.loose_motions(rows.take(renew, *MOTIONS))
        z, refused = self._solved(rows, goes, first)
        uphill = goes & ~refused & ~(dot(rows.g, z) > 0.0)
        if uphill.any():
            rows.mu[uphill] *= CAUTION
            rows.trusted[uphill] = False
            again = rows.take(uphill, *MATRIX, "R", "trusted")
            z[uphill], refused[uphill] = self._solved(again, ~again.trusted, again.trusted)
        for _ in range(MOST_FAILURES):
            left = np.flatnonzero(refused)
            if not len(left):
                break
            again, every = rows.take(left, *MATRIX), np.ones(len(left), dtype=bool)
            again.R = rows.R[left] = self.topology.loose_motions(again)
            again.trusted = ~every
            z[left], refused[left] = self._solved(again, every, every)
            rows.mu[left] *= np.where(refused[left], 10.0, 1.0)
        z[refused] = np.nan
        return z, uphill

    def _solved(self, rows: Rows, goes: np.ndarray, clipped: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return M^-1 g, and where M has no factor; clipped: (N,) bool, without negative force densities."""
        q = np.where(clipped[:, None], np.maximum(rows.q, 0.0), rows.q)
        M = self.topology.stiffness(rows, q, self.topology.taut(rows))
        M += rows.R
        return solved(shifted(M, rows.mu[:, None] * rows.S), rows.g, goes, rows.trusted)

    def _conclude(self) -> None:
        """Write down the answers of rows that balance, and how K's signs are."""
        s, is_told = joined(self.balanced), self.options.analysis != "never"
        self.balanced = []
        residual, reference = np.abs(s.g).max(1), np.maximum(np.abs(s.t).max(1), s.load)
        reference, floor = measured(self.topology, s, reference)
        found = signs(self.topology, s, floor, MOST_REFINEMENTS if is_told else 0)
        if not is_told:
            found[s.is_covered & (found == BALANCED)] = NEUTRAL
        self.known[s.number] = found
        for row in np.flatnonzero(found == BALANCED).tolist():
            self.nearly[int(s.number[row])] = s.X[row]
        self._note(s, residual / reference)

    def _note(self, s: Rows, relative: np.ndarray) -> None:
        """Write down the answers of rows, in the user's units."""
        number, unit = s.number, s.length * s.stiffness
        shape = self.topology.everywhere(s, s.X).swapaxes(1, 2) * s.length[:, None, None]
        free, loads = self.structure.free, self.values.loads[number]
        held = self.values.coordinates[number]
        self.coordinates[number] = np.where(free, shape + s.centre[:, None], held)
        self.forces[number] = s.t * unit[:, None]
        work = dot(loads.reshape(len(s.t), -1), (shape + s.centre[:, None]).reshape(len(s.t), -1))
        self.energy[number] = elements.energy(s.t, s.e) * (unit * s.length) - work
        self.relative[number], self.iterations[number] = relative, s.iteration
