"""CGFF beside fsolve and root lm: same start, same residual, one process, in turn.

Every run ends as soon as the largest out-of-balance force is within TOLERANCE of the largest element force,
or where its own test ends it. "fd" takes the Jacobian by finite differences, MATLAB's default; "by loop"
takes the residual from a loop over the elements in plain Python in place of whole columns in numpy. "plain"
is Fletcher-Reeves on eq. (10) without preconditioner. Table I ends by its own test.
"""

import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from math import sqrt
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import fsolve, root

from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers import cgff, table1
from cgff_cli.structure import Structure
from tests.studies.claims.cases import NAMES, all_starts, structure_of

TOLERANCE = 1e-10
TIGHT = 1e-15
PAPER_SECONDS = {"cgff": 49.76, "fsolve": 255.08}


class End(NamedTuple):
    """Whether the forces balance to TOLERANCE, what is left, how often they and tangents were evaluated."""

    reached: bool
    left: float
    evaluations: int
    tangents: int


class Balanced(Exception):  # noqa: N818 -- the aim of every run
    """Raised by the residual as soon as forces balance."""


class System:
    """The functions that scipy calls, centred and scaled as CGFF does it."""

    def __init__(self, structure: Structure, *, by_loop: bool = False):
        self.mechanics = Mechanics(structure)
        self.start = self.mechanics.start.ravel()
        self.evaluations, self.tangents, self.left = 0, 0, float("inf")
        self.elements = list(
            zip(
                structure.start.tolist(),
                structure.end.tolist(),
                self.mechanics.k.tolist(),
                self.mechanics.l0.tolist(),
                structure.tension_only.tolist(),
                strict=True,
            )
        )
        self.forces = self.looped if by_loop else self.vectorised

    def residual(self, x: np.ndarray) -> Any:
        """Return minus the out-of-balance forces (m,); raises Balanced where they are within TOLERANCE."""
        self.evaluations += 1
        gradient, unbalanced, largest = self.forces(x)
        self.left = unbalanced / largest
        if unbalanced <= TOLERANCE * largest:
            raise Balanced
        return gradient

    def vectorised(self, x: np.ndarray) -> tuple[np.ndarray, float, float]:
        """Return minus the out-of-balance forces, their largest, and the largest element force."""
        state = self.state = self.mechanics.at(x.reshape(self.mechanics.start.shape))
        return state.g.ravel(), float(np.abs(state.g).max()), float(np.abs(state.t).max())

    def looped(self, x: np.ndarray) -> tuple[list[float], float, float]:
        """Return the same from a loop over the elements."""
        d, n = self.mechanics.start.shape
        X, axes = x.tolist(), range(d)
        total, largest = [0.0] * len(X), 0.0
        for i, j, k, rest, slackens in self.elements:
            V = [X[axis * n + i] - X[axis * n + j] for axis in axes]
            length = sqrt(sum(part * part for part in V))
            t = k * (length - rest)
            if slackens and t < 0.0:
                continue
            largest = max(largest, abs(t))
            for axis in axes:
                pull = t / length * V[axis]
                total[axis * n + i] += pull
                total[axis * n + j] -= pull
        return total, max(map(abs, total)), largest

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Return K (m, m) at the shape last evaluated, which is where scipy asks for it."""
        self.tangents += 1
        X = x.reshape(self.mechanics.start.shape)
        if not np.array_equal(self.state.X, X):
            self.state = self.mechanics.at(X)
        return self.state.dense_tangent()


def by_scipy(structure: Structure, method: str, *, exact: bool, by_loop: bool = False) -> End:
    """Run a solver of scipy's."""
    system = System(structure, by_loop=by_loop)
    jacobian = system.jacobian if exact else None
    try:
        if method == "fsolve":
            fsolve(system.residual, system.start, fprime=jacobian, xtol=TIGHT, full_output=True)
        else:
            options = {"xtol": TIGHT, "ftol": TIGHT, "gtol": 0.0}
            root(system.residual, system.start, jac=jacobian, method="lm", options=options)
    except Balanced:
        return End(True, system.left, system.evaluations, system.tangents)
    return End(False, system.left, system.evaluations, system.tangents)


def by_ours(structure: Structure, **options: object) -> End:
    """Run CGFF or Table I."""
    chosen = SolveOptions().merged({"tolerance": TOLERANCE, **options})
    solver = table1 if chosen.method == "table1" else cgff
    end = solver.form_find(structure, chosen)
    left = end.residual_max / end.reference
    return End(left <= TOLERANCE, left, end.evaluations, end.factorizations)


RIVALS: dict[str, Callable[[Structure], End]] = {
    "cgff energy": by_ours,
    "cgff residual": lambda structure: by_ours(structure, objective="residual"),
    "plain residual": lambda structure: by_ours(structure, objective="residual", preconditioner="none"),
    "table1": lambda structure: by_ours(structure, method="table1", max_iterations=20_000),
    "fsolve": lambda structure: by_scipy(structure, "fsolve", exact=True),
    "fsolve fd": lambda structure: by_scipy(structure, "fsolve", exact=False),
    "fsolve fd by loop": lambda structure: by_scipy(structure, "fsolve", exact=False, by_loop=True),
    "lm": lambda structure: by_scipy(structure, "lm", exact=True),
    "lm fd": lambda structure: by_scipy(structure, "lm", exact=False),
    "lm fd by loop": lambda structure: by_scipy(structure, "lm", exact=False, by_loop=True),
}


def measure(count: int, repeat: int) -> dict[str, Any]:
    """Return how long every rival takes from each scene's own start and from random ones."""
    return {name: one_structure(name, count, repeat) for name in NAMES}


def one_structure(name: str, count: int, repeat: int) -> dict[str, Any]:
    """Return an object per rival, and how long the loop's residual takes against numpy's.

    `seconds` is the median from the scene's own start. `times_as_long` is the median over all starts from
    which a rival reached balance of its time over that of CGFF on the energy; of Table I, over all starts.
    """
    starts = [replace(structure_of(name), coordinates=X) for X in all_starts(name, count)]
    ends = {rival: [run(start) for start in starts] for rival, run in RIVALS.items()}
    times = [in_turn(start, repeat) for start in starts]
    found: dict[str, Any] = {"loop_over_numpy": loop_over_numpy(starts[0], repeat)}
    for rival in RIVALS:
        counted = [
            time[rival] / time["cgff energy"]
            for time, end in zip(times, ends[rival], strict=True)
            if end.reached or rival == "table1"
        ]
        found[rival] = {
            "seconds": times[0][rival],
            "times_as_long": statistics.median(counted),
            **ends[rival][0]._asdict(),
            "random_starts": count,
            "random_starts_reached": sum(end.reached for end in ends[rival][1:]),
        }
    return found


def in_turn(structure: Structure, repeat: int) -> dict[str, float]:
    """Return the median time of each rival, run one after the other `repeat` times."""
    times: dict[str, list[float]] = {rival: [] for rival in RIVALS}
    for _ in range(repeat):
        for rival, run in RIVALS.items():
            times[rival].append(timed(run, structure))
    return {rival: statistics.median(seconds) for rival, seconds in times.items()}


def timed(call: Callable[..., object], *arguments: object) -> float:
    """Return the seconds that a call takes."""
    begun = time.perf_counter()
    call(*arguments)
    return time.perf_counter() - begun


def loop_over_numpy(structure: Structure, repeat: int) -> float:
    """Return how many times as long the residual takes by a loop as by numpy."""
    systems = [System(structure, by_loop=by_loop) for by_loop in (True, False)]
    rounds = [[timed(system.residual, system.start) for system in systems] for _ in range(100 * repeat)]
    looped, vectorised = (statistics.median(column) for column in zip(*rounds, strict=True))
    return looped / vectorised


def show(found: dict[str, Any]) -> None:
    """Print a line per structure and rival."""
    print(
        f"{'':24}{'median ms':>10}{'reached':>8}{'left':>9}{'evaluations':>12}{'tangents':>9}"
        f"{'random starts':>14}{'times as long':>14}"
    )
    for name, one in found.items():
        for rival in RIVALS:
            row = one[rival]
            print(
                f"{NAMES[name]:5}{rival:19}{1e3 * row['seconds']:10.3f}{'yes' if row['reached'] else 'no':>8}"
                f"{row['left']:9.1e}{row['evaluations']:12}{row['tangents']:9}"
                f"{row['random_starts_reached']:8} of {row['random_starts']}{row['times_as_long']:14.2f}"
            )
        print(
            f"{NAMES[name]:5}a residual by loop takes {one['loop_over_numpy']:.2f} times as long as by numpy"
        )
