"""The loop of `descent` for many rows at once, each at its own pace.

In turn every row is evaluated at the end of its step. Where the step is a strong Wolfe one the row moves
there and takes a new direction, elsewhere its line gets another trial. Rows that balance leave, others take
their place. Rows that need more than this, or whose balance is no equilibrium that arithmetic is sure of,
are left to `form_find`.
"""

from math import sqrt

import numpy as np

from cgff_cli.mechanics import elements
from cgff_cli.mechanics.elements import EPS
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.line_search import ENOUGH_DECREASE, FLAT_ENOUGH_FOR_NEWTON, MOST_TRIALS, TENFOLD
from cgff_cli.solvers.many.rows import Rows, Topology, dot, flat, joined, shifted, solved
from cgff_cli.solvers.many.signs import BALANCED, NEUTRAL, OPEN, measured, signs
from cgff_cli.solvers.preconditioners.base import FIRST_SHIFT, LONG_STEP, QUARTER
from cgff_cli.structure import Structure

ENTRIES = 2**20
"""Entries of all matrices in work at a time, 8 MB."""


class Many:
    """What came of m rows.

    values    : coordinates and loads (m, n, d), stiffness and rest_lengths (m, b)
    known     : (m,) OPEN, BALANCED, NEUTRAL or STABLE     iterations, relative, energy : (m,)
    coordinates (m, n, d), forces (m, b), energy in the user's units, of rows that are not OPEN
    nearly    : row -> (d, n) positions in the row's frame, where no more is known than BALANCED
    """

    def __init__(self, structure: Structure, values: dict[str, np.ndarray], options: SolveOptions):
        self.structure, self.values, self.options = structure, values, options
        m = len(values["loads"])
        self.known, self.iterations = np.full(m, OPEN), np.zeros(m, dtype=int)
        self.relative, self.energy = np.zeros(m), np.zeros(m)
        self.coordinates = np.array(values["coordinates"])
        self.forces = np.zeros(values["stiffness"].shape)
        self.nearly: dict[int, np.ndarray] = {}

    def run(self) -> None:
        """Go through all rows."""
        self.topology = Topology(self.structure)
        m, begun = len(self.known), 0
        at_once = 1 + ENTRIES // (len(self.topology.free) + self.forces.shape[1]) ** 2
        parts: list[Rows] = []
        with np.errstate(all="ignore"):
            while True:
                room = min(at_once - sum(len(part.number) for part in parts), m - begun)
                if 4 * room >= min(at_once, m - begun) and room:
                    parts.append(self._begun(np.arange(begun, begun + room)))
                    begun += room
                rows = joined(parts)
                if not len(rows.number):
                    break
                parts = self._step(rows)

    def _begun(self, number: np.ndarray) -> Rows:
        """Return rows at their starts, with their first directions."""
        names = ("coordinates", "stiffness", "rest_lengths", "loads")
        r = self.topology.framed(*(self.values[name][number] for name in names))
        r.number, r.iteration, r.waited = number, np.zeros_like(number), np.zeros_like(number)
        r.best, r.mu = np.full(len(number), np.inf), np.full(len(number), FIRST_SHIFT)
        return self._set_out(r, self.topology.at(r, r.X))

    def _step(self, r: Rows) -> list[Rows]:
        """Evaluate every row at the end of its step; return those that search on, and those that set out."""
        step = r.alpha[:, None] * r.d
        s = self.topology.at(r, self.topology.moved(r.X, step))
        rise = 0.5 * dot(r.t + s.t, s.e - r.e) - dot(r.F, step)
        slope, blur = dot(s.g, r.d), s.t * self.topology.rounding(s)
        descends = rise <= ENOUGH_DECREASE * r.alpha * r.slope + 4.0 * np.sqrt(dot(blur, blur))
        met = descends & (np.abs(slope) <= -FLAT_ENOUGH_FOR_NEWTON * r.slope)
        search = self._searched(r, slope, descends).take(~met)
        r, s = r.take(met), s.take(met)
        shrinkage = s.norm / np.where(r.norm > 0.0, r.norm, 1.0)
        lower = np.maximum(r.mu * np.minimum(shrinkage, 1.0 / TENFOLD), sqrt(EPS))
        r.mu = np.where(r.alpha > LONG_STEP, lower, np.where(r.alpha < QUARTER, TENFOLD, 1.0) * r.mu)
        r.iteration += 1
        return [search.take(search.alpha > EPS), self._set_out(r, s)]

    def _searched(self, r: Rows, slope: np.ndarray, descends: np.ndarray) -> Rows:
        """Return rows with the next trials of their lines, as in `line_search`; 0 where none is left."""
        trial = np.stack((r.alpha, slope), axis=1)
        is_low = (descends & (slope < 0.0))[:, None]
        low, high = np.where(is_low, trial, r.low), np.where(is_low, r.high, trial)
        width, bend = (high - low).T
        share = -low[:, 1] / bend
        share = np.where((share >= 1.0 / TENFOLD) & (share <= 1.0 - 1.0 / TENFOLD), share, 0.5)
        inside = low[:, 0] + width * share
        inside = np.where((low[:, 0] < inside) & (inside < high[:, 0]), inside, 0.0)
        secant = np.where(slope > r.slope, r.alpha * r.slope / (r.slope - slope), np.inf)
        beyond = np.minimum(np.maximum(secant, r.alpha), TENFOLD * r.alpha)
        alpha = np.where(np.isinf(high[:, 0]), beyond, inside)
        return Rows(**{**vars(r), "low": low, "high": high, "alpha": alpha})

    def _set_out(self, r: Rows, s: Rows) -> Rows:
        """Return the rows that go on from states s, with full steps in new directions, M^-1 g."""
        r.X, r.e, r.t, r.norm = s.X, s.e, s.t, s.norm
        goes = self._goes_on(r, s)
        r, s = r.take(goes), s.take(goes)
        taut = self.topology.taut(r, s)
        M = shifted(self.topology.stiffness(r, s, s.q, taut), r.mu[:, None] * r.S)
        z, refused = solved(M, s.g)
        if refused.any():
            a, b = r.take(refused), s.take(refused)
            M = self.topology.stiffness(a, b, np.maximum(b.q, 0.0), taut[refused])
            z[refused], failed = solved(shifted(M, a.mu[:, None] * a.S), b.g)
            z[np.flatnonzero(refused)[failed]] = np.nan
        r.d, r.slope, r.alpha = -z, -dot(s.g, z), np.ones(len(z))
        r.low = np.stack((np.zeros(len(z)), r.slope), axis=1)
        r.high = np.full((len(z), 2), np.inf)
        return r.take(r.slope < 0.0)

    def _goes_on(self, r: Rows, s: Rows) -> np.ndarray:
        """Return which rows go on, (N,) bool, and note those that balance.

        Of these go on, as long as that helps, those that are to be nearer before their signs are sure.
        """
        halved = r.norm <= 0.5 * r.best
        r.best, r.waited = np.where(halved, r.norm, r.best), np.where(halved, 0, r.waited + 1)
        residual, tolerance = np.abs(s.g).max(1), self.options.tolerance
        goes = r.waited < MOST_TRIALS
        near = np.flatnonzero(residual <= tolerance * np.maximum((r.k * s.l).max(1), r.load))
        reference, floor = measured(self.topology, r.take(near), s.take(near))
        balanced = residual[near] <= tolerance * reference
        near, relative, floor = near[balanced], (residual[near] / reference)[balanced], floor[balanced]
        found = self._note(r.take(near), s.take(near), relative, floor)
        goes[near] = (found == BALANCED) & (s.norm[near] > floor) & halved[near]
        return goes & (r.iteration < self.options.max_iterations)

    def _note(self, r: Rows, s: Rows, relative: np.ndarray, floor: np.ndarray) -> np.ndarray:
        """Write down the answers of rows that balance, in the user's units; return what is known of them."""
        number, unit = r.number, r.length * r.stiffness
        self.known[number] = found = signs(self.topology, r, s, floor)
        self.nearly |= {int(number[row]): s.X[row] for row in np.flatnonzero(found == BALANCED)}
        shape = s.X.swapaxes(1, 2) * r.length[:, None, None] + r.centre[:, None]
        self.coordinates[number] = np.where(self.structure.free, shape, self.values["coordinates"][number])
        self.forces[number] = s.t * unit[:, None]
        work = dot(flat(self.values["loads"][number]), flat(shape))
        self.energy[number] = elements.energy(s.t, s.e) * (unit * r.length) - work
        self.relative[number], self.iterations[number] = relative, r.iteration
        return found
