"""Distinct equilibria among many answers: each brought down to rounding, judged, and counted once."""

from bisect import bisect_left, bisect_right
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from cgff_cli.analysis.equilibrium import stability_of
from cgff_cli.analysis.measures import reach
from cgff_cli.analysis.modes import modes_of, spectrum_of
from cgff_cli.analysis.stability import Signs, resists
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Gauge, Verdict
from cgff_cli.structure import Structure
from cgff_cli.study.alignment import largest_move, size
from cgff_cli.study.sameness import Leeway, laid, leeway_of

SAME = 1e-6
"""Share of the size within which nodes are in the same place."""

COARSEST = 1e-3
"""Most of that share, where softness leaves a shape unsure by more than SAME."""

SOFTEST = 3
"""Softest motions that are kept of each shape."""

STEPS_TO_FLOOR = 6
"""Newton steps at most that bring a shape down to rounding."""


@dataclass(frozen=True, eq=False)
class Shape:
    """A distinct equilibrium.

    coordinates : (n, d)          modes : (m, n, d) softest motions, the node that moves most by 1
    energy_floor : estimated error of the energy, by rounding and by what is left out of balance
    within      : how far a node may be from its place in the same shape
    count, first_start : starts that led here, and the number of the first
    """

    coordinates: np.ndarray
    energy: float
    energy_floor: float
    stability: str | None
    smallest_stiffness: float | None
    slack_count: int
    residual_relative: float
    modes: np.ndarray
    leeway: Leeway
    within: float
    count: int
    first_start: int

    @property
    def energy_told(self) -> float:
        """The energy, 0 where it is no more than rounding of 0."""
        return self.energy if abs(self.energy) > self.energy_floor else 0.0

    def is_at(self, X: np.ndarray, within: float = 0.0) -> bool:
        """Return whether coordinates (n, d), in doubt by `within`, are this shape."""
        moved = largest_move(laid(X, self.coordinates, self.leeway), self.coordinates)
        return moved <= max(self.within, within)


class Nearby:
    """Places by a number each, so that those with one near another's are found without asking all."""

    def __init__(self) -> None:
        self.numbers: list[float] = []
        self.places: list[int] = []

    def add(self, number: float) -> None:
        """Give the next place a number."""
        at = bisect_left(self.numbers, number)
        self.places.insert(at, len(self.places))
        self.numbers.insert(at, number)

    def to(self, number: float, reach: float) -> list[int]:
        """Return the places of numbers within reach of a number, in the order they were added."""
        first, last = bisect_left(self.numbers, number - reach), bisect_right(self.numbers, number + reach)
        return sorted(self.places[first:last])


class Shapes:
    """Distinct shapes in the order found; a new one is held against the first of each: nothing chains."""

    def __init__(self) -> None:
        self.found: list[Shape] = []
        self._nearby, self._widest = Nearby(), 0.0

    def __iter__(self) -> Iterator[Shape]:
        return iter(self.found)

    def place(self, X: np.ndarray, within: float = 0.0) -> int | None:
        """Return the place of the shape that coordinates are, None where there is none of it yet."""
        near = self._nearby.to(_mixed(X), 2.0 * max(self._widest, within))
        return next((place for place in near if self.found[place].is_at(X, within)), None)

    def add(self, shape: Shape) -> None:
        """Count a shape in."""
        place = self.place(shape.coordinates, shape.within)
        if place is not None:
            self.seen(place, shape.count)
            return
        self.found.append(shape)
        self._nearby.add(_mixed(shape.coordinates))
        self._widest = max(self._widest, shape.within)

    def seen(self, place: int, count: int = 1) -> None:
        """Count starts that led to a shape."""
        known = self.found[place]
        self.found[place] = replace(known, count=known.count + count)

    def add_answers(
        self, structure: Structure, options: SolveOptions, answers: Iterable[tuple[int, np.ndarray]]
    ) -> None:
        """Count in answers: number of the start, and coordinates (n, d), balanced to the tolerance."""
        for number, X in answers:
            place = self.place(X)
            if place is None:
                self.add(shape_at(replace(structure, coordinates=X), options, number))
            else:
                self.seen(place)


def _mixed(X: np.ndarray) -> float:
    """Return a mean of the nodes' distances from the centroid, each times a number of its own of at most 1.

    The same at the same shape; where nodes move by some distance, it changes by no more than twice that.
    """
    return float((reach(X) * np.cos(np.arange(len(X)) ** 2.0)).mean())


def shape_at(structure: Structure, options: SolveOptions, number: int) -> Shape:
    """Return the equilibrium at a structure's coordinates, refined and judged, as found from one start."""
    mechanics = Mechanics(structure)
    gauge = Gauge(mechanics)
    state = _refined(mechanics.at(mechanics.start), gauge, options)
    solution = Solution(state, Verdict.CONVERGED, options.tolerance, 1)
    floor = solution.balance.floor
    told = stability_of(solution, options)
    signs = _signs(state, floor, options)
    shapes = modes_of(signs, state, SOFTEST).shapes
    X, moved = solution.coordinates, np.sqrt((shapes**2).sum(axis=2)).max(axis=1, initial=0.0)
    blur = state.norm / signs.softest * mechanics.frame.length if signs.softest > 0.0 else 0.0
    whole = size(X)
    return Shape(
        coordinates=X,
        energy=solution.energy,
        energy_floor=solution.energy_floor + 0.5 * solution.residual_norm * blur,
        stability=told["stability"],
        smallest_stiffness=told["smallest_stiffness"],
        slack_count=int(state.slack.sum()),
        residual_relative=solution.relative,
        modes=shapes / moved[:, None, None],
        leeway=leeway_of(state, floor),
        within=min(max(SAME * whole, 4.0 * blur), COARSEST * whole),
        count=1,
        first_start=number,
    )


def _signs(state: State, floor: float, options: SolveOptions) -> Signs:
    return spectrum_of(state, resists(state, floor), floor, options.factor, SOFTEST)


def _refined(state: State, gauge: Gauge, options: SolveOptions) -> State:
    """Return a state after Newton steps, as long as they bring forces nearer to balance."""
    for _ in range(STEPS_TO_FLOOR):
        floor = gauge.rounding_floor(state)
        if state.norm <= floor:
            break
        steps = _signs(state, floor, options).newton_steps()
        there = min((state.mechanics.at(state.X + step) for step in steps), key=lambda s: s.norm)
        if not there.norm < state.norm:
            break
        state = there
    return state
