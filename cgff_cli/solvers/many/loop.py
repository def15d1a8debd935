"""The loop of `descent` for many rows at once, each at its own pace and restarted at every step.

In turn every row is evaluated at the end of its step. Where the step is a strong Wolfe one the row moves
there and takes a new direction, elsewhere its line gets another trial. Rows that balance leave, others take
their place. Rows that need more than this, or whose balance is no equilibrium that arithmetic is sure of,
are left to `form_find`.
"""

from dataclasses import dataclass
from math import sqrt

import numpy as np

from cgff_cli.mechanics import elements
from cgff_cli.mechanics.elements import EPS
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.line_search import ENOUGH_DECREASE, FLAT_ENOUGH_FOR_NEWTON, MOST_TRIALS, TENFOLD
from cgff_cli.solvers.many.rows import Batch, Topology, dot, flat, norms, solved
from cgff_cli.solvers.many.signs import OPEN, WORDS, references, signs
from cgff_cli.solvers.preconditioners.base import FIRST_SHIFT, LONG_STEP, QUARTER
from cgff_cli.structure import Structure

ENTRIES = 2**20
"""Entries of all matrices in work at a time, 8 MB (tests/studies/many.py --entries)."""


@dataclass(frozen=True, eq=False)
class Solutions:
    """The answers of m rows; units, signs and words are a Result's.

    coordinates : (m, n, d)            forces : (m, b)        energy, residual_relative : (m,)
    verdicts, stability : (m,) words   iterations : (m,)      stability: None where it is not told
    converged, alone    : (m,) bool; alone: solved by itself, not in the batch
    """

    coordinates: np.ndarray
    converged: np.ndarray
    verdicts: np.ndarray
    stability: np.ndarray
    iterations: np.ndarray
    residual_relative: np.ndarray
    energy: np.ndarray
    forces: np.ndarray
    alone: np.ndarray


class Loop:
    """Solves what rows it can, and fills in their answers; all others stay `alone`.

    values: (m, n, d) coordinates and loads, (m, b) stiffness and rest_lengths. Columns of rows in work:
    waited, best : (N,) evaluations since the residual's norm last halved, and that norm
    low, high    : (N, 2) steps and slopes at the ends of the bracket of a line
    """

    def __init__(
        self, structure: Structure, values: dict[str, np.ndarray], options: SolveOptions, answers: Solutions
    ):
        self.values, self.options, self.answers, self.free = values, options, answers, structure.free
        self.topology = Topology(structure)
        self.at_once = 1 + ENTRIES // (len(self.topology.free) + len(structure.start)) ** 2

    def run(self) -> None:
        """Go through all rows; work in hand is filled up when a quarter of it has left."""
        m, begun = len(self.answers.alone), self.at_once
        with np.errstate(all="ignore"):
            rows = self._begun(0, begun)
            while begun < m or len(rows.number):
                parts = self._step(rows)
                room = self.at_once - sum(len(part.number) for part in parts)
                if begun < m and room >= QUARTER * self.at_once:
                    parts.append(self._begun(begun, begun + room))
                    begun += room
                columns = {key: np.concatenate([vars(part)[key] for part in parts]) for key in vars(rows)}
                rows = Batch(**columns)

    def _begun(self, first: int, last: int) -> Batch:
        """Return rows at their starts, with their first directions."""
        number = np.arange(first, min(last, len(self.answers.alone)))
        names = ("coordinates", "stiffness", "rest_lengths", "loads")
        r = self.topology.begun(*(self.values[name][number] for name in names))
        r.number, r.iteration, r.waited = number, np.zeros_like(number), np.zeros_like(number)
        r.mu, r.best = np.full(len(number), FIRST_SHIFT), np.full(len(number), np.inf)
        return self._set_out(r, self.topology.at(r, np.zeros_like(r.F)))

    def _step(self, r: Batch) -> list[Batch]:
        """Evaluate rows at the ends of their steps; return those that search on, and that set out again."""
        r.waited += 1
        step = r.alpha[:, None] * r.d
        s = self.topology.at(r, step)
        rise = 0.5 * dot(r.t + s.t, s.e - r.e) - dot(r.F, step)
        slope, noise = dot(s.g, r.d), 2.0 * norms(s.t * s.rounding)
        descends = rise <= ENOUGH_DECREASE * r.alpha * r.slope + noise
        met = descends & (np.abs(slope) <= -FLAT_ENOUGH_FOR_NEWTON * r.slope)
        on = ~met & (r.waited < MOST_TRIALS)
        search = _searched(r.take(on), slope[on], descends[on])
        r, s = r.take(met), s.take(met)
        lower = np.maximum(r.mu * np.minimum(s.norm / r.norm, 1.0 / TENFOLD), sqrt(EPS))
        r.mu = np.where(r.alpha > LONG_STEP, lower, np.where(r.alpha < QUARTER, TENFOLD, 1.0) * r.mu)
        r.iteration += 1
        return [search, self._set_out(r, s)]

    def _set_out(self, r: Batch, s: Batch) -> Batch:
        """Return the rows that go on from states s, with full steps along -M^-1 g.

        Where K and its shift have no Cholesky factor, M is without negative force densities; where that has
        none either, M is 1, as dposv leaves g alone.
        """
        r.X, r.e, r.t, r.norm = s.X, s.e, s.t, s.norm
        goes = self._goes_on(r, s)
        r, s = r.take(goes), s.take(goes)
        z, refused = solved(self.topology.stiffness(r, s, s.q, s.taut, r.mu), s.g)
        a, b = r.take(refused), s.take(refused)
        z[refused], _ = solved(self.topology.stiffness(a, b, np.maximum(b.q, 0.0), b.taut, a.mu), b.g)
        r.d, r.slope, r.alpha = -z, -dot(s.g, z), np.ones(len(z))
        r.low = np.stack((np.zeros(len(z)), r.slope), axis=1)
        r.high = np.full((len(z), 2), np.inf)
        return r

    def _goes_on(self, r: Batch, s: Batch) -> np.ndarray:
        """Return which rows go on, (N,) bool, and note those that balance.

        Of these go on those that are to be nearer before their signs are sure.
        """
        halved = r.norm <= 0.5 * r.best
        r.best, r.waited = np.where(halved, r.norm, r.best), np.where(halved, 0, r.waited)
        residual, tolerance = np.abs(s.g).max(1), self.options.tolerance
        goes = (r.waited < MOST_TRIALS) & (r.iteration < self.options.max_iterations)
        near = np.flatnonzero(residual <= tolerance * np.maximum((r.k * s.l).max(1), r.load))
        reference, floor = references(self.topology, r.take(near), s.take(near))
        relative = residual[near] / reference
        near, relative, floor = (column[relative <= tolerance] for column in (near, relative, floor))
        found = signs(self.topology, r.take(near), s.take(near), floor)
        sure = found != OPEN
        goes[near] &= ~sure & (s.norm[near] > floor)
        self._note(r.take(near[sure]), s.take(near[sure]), relative[sure], found[sure])
        return goes

    def _note(self, r: Batch, s: Batch, relative: np.ndarray, found: np.ndarray) -> None:
        """Write down the answers of rows, in the user's units."""
        number, to, X = r.number, self.answers, s.X.swapaxes(1, 2) + r.centre[:, None]
        stays = ~self.free | (r.iteration == 0)[:, None, None]
        to.coordinates[number] = np.where(stays, self.values["coordinates"][number], X)
        work = dot(flat(self.values["loads"][number]), flat(X))
        to.forces[number], to.energy[number] = s.t, elements.energy(s.t, s.e) - work
        to.residual_relative[number], to.iterations[number] = relative, r.iteration
        to.stability[number], to.alone[number] = WORDS[found], False


def _searched(r: Batch, slope: np.ndarray, descends: np.ndarray) -> Batch:
    """Return rows with the next trials of their lines: by secants, or halves, as in `line_search`."""
    trial = np.stack((r.alpha, slope), axis=1)
    is_low = (descends & (slope < 0.0))[:, None]
    r.low, r.high = np.where(is_low, trial, r.low), np.where(is_low, r.high, trial)
    width, bend = (r.high - r.low).T
    share = np.fmin(np.fmax(-r.low[:, 1] / bend, 1.0 / TENFOLD), 1.0 - 1.0 / TENFOLD)
    beyond = r.alpha / np.maximum(1.0 - slope / r.slope, 1.0 / TENFOLD)
    r.alpha = np.where(np.isinf(width), beyond, r.low[:, 0] + width * share)
    return r
