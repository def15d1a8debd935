"""The parameter study: one scene, many sets of numbers, a row for each.

Rows are numbered: a grid with its last axis fastest, axes side by side, or at random. They fall into fixed
chunks by number, each a job of the machine: what a row holds depends on its number alone.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import prod
from typing import Any, NamedTuple

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.many import net_loads, own_numbers, solve_many, total_loads
from cgff_cli.options import DEFAULTS, SolveOptions
from cgff_cli.scene.laws import rest_lengths_for
from cgff_cli.scene.physics import all_pairs
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.many.loop import Solutions
from cgff_cli.structure import from_scene, refuse_geometry
from cgff_cli.study.axes import Axis, Values, axes, numbers_of
from cgff_cli.study.load_factors import with_factors
from cgff_cli.study.outs import Answers, Out, outs
from cgff_cli.values import Rule

CHUNK, CHUNK_ELEMENTS = 1000, 12_000
"""Rows solved together: at most as many, and as many as have so many elements in all.

In chunks of 100, 200, 500, 1000, 2000 the prism makes 5300, 6300, 9000, 10 500, 12 600 rows a second; what is
killed loses the more, the larger they are.
"""

HOW_ROWS_ENDED = ("verdict", "converged", "stability", "iterations", "residual_relative", "energy")
"""What is told of every row, after its swept values."""

BAD_SCENE, NO_SCENE = "bad_scene", "nothing can balance the loads, or no rest length gives the pretension"
"""The verdict of a row with loads that nothing can balance, or a pretension that no rest length gives."""

MOST_ROWS = Rule("how many rows", int, least=1, most=10**12)


class Span(NamedTuple):
    """Rows from first up to, not including, last: a job of the machine; values: of theirs, (rows, axes)."""

    first: int
    last: int
    values: np.ndarray
    digest: str = ""


class SolvedRows(NamedTuple):
    """What became of a chunk: columns by name, (rows,) each; how many rows did not converge, or were bad.

    not_judged: balance, but are so far from it that nothing is told of their stability, where that is asked
    """

    columns: dict[str, list[Any]]
    not_converged: int
    bad: int
    not_judged: int


@dataclass(frozen=True, eq=False)
class Sweep:
    """A study as asked for; order: grid, zip or random."""

    scene: Scene
    options: SolveOptions
    axes: tuple[Axis, ...]
    outs: dict[str, Out]
    order: str
    rows: int

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, in order."""
        return (*(axis.key for axis in self.axes), *HOW_ROWS_ENDED, *self.outs)

    @property
    def at_once(self) -> int:
        """How many rows a chunk has."""
        return max(1, min(CHUNK, CHUNK_ELEMENTS // self.scene.element_count))

    def chunks(self, rows: range) -> Iterator[Span]:
        """Yield the chunks of some rows."""
        for first in range(rows.start, rows.stop, self.at_once):
            yield self.span(first, min(first + self.at_once, rows.stop))

    def span(self, first: int, last: int) -> Span:
        """Return the rows from first up to, not including, last, with their swept values."""
        return Span(first, last, self.values(first, last))

    @property
    def for_workers(self) -> "Sweep":
        """The sweep without what may be millions of values: those of a chunk's rows come with the chunk."""
        return replace(self, axes=tuple(axis._replace(values=axis.values[:0]) for axis in self.axes))

    def rows_of(self, shard: tuple[int, int]) -> range:
        """Return the numbers of the rows of a shard, (i, n), the first being (1, n): whole chunks."""
        count, (i, n) = -(-self.rows // self.at_once), shard
        first, last = (i - 1) * count // n * self.at_once, i * count // n * self.at_once
        return range(min(first, self.rows), min(last, self.rows))

    def values(self, first: int, last: int) -> np.ndarray:
        """Return the swept values of some rows, (rows, axes)."""
        numbers, columns = np.arange(first, last), len(self.axes)
        if self.order == "random":  # a row's numbers depend on its own number, not on its chunk
            draws = np.random.Generator(np.random.PCG64(self.options.seed).advance(first * columns))
            shares = draws.random((last - first, columns))
            found = [axis.at(share) for axis, share in zip(self.axes, shares.T, strict=True)]
        else:
            counts = [len(axis.values) for axis in self.axes]
            places = [numbers] * columns if self.order == "zip" else np.unravel_index(numbers, counts)
            found = [axis.values[place] for axis, place in zip(self.axes, places, strict=True)]
        return np.stack(found, axis=1)

    def arrays(self, values: np.ndarray) -> dict[str, np.ndarray]:
        """Return what `solve_many` takes for swept values, (m, axes): the arrays that they change.

        A swept pretension is the force that an element has at the file's own coordinates, with the row's EA.
        """
        own = numbers_of(self.scene)
        found: dict[str, np.ndarray] = {}
        for axis, column in zip(self.axes, values.T, strict=True):
            numbers = own[axis.array]
            array = found.setdefault(axis.array, np.tile(numbers, (len(values), *(1,) * numbers.ndim)))
            factors = column.reshape(-1, *(1,) * numbers[axis.place].ndim)
            at = (slice(None), *axis.place)
            array[at] = array[at] * factors if axis.is_factor else factors
        if "factors" in found:
            loads, weights = (found.get(name, own[name][None]) for name in ("loads", "weights"))
            found |= with_factors(self.scene, found.pop("factors"), loads, weights)
        if "pretension" in found:
            t, EA = found.pop("pretension"), found.get("EA", own["EA"])
            rest = found.setdefault("rest_lengths", np.tile(own["rest_lengths"], (len(values), 1)))
            swept = np.concatenate([axis.place[0] for axis in self.axes if axis.array == "pretension"])
            pairs, X = all_pairs(self.scene.groups), self.scene.coordinates
            l = np.linalg.norm(X[pairs[:, 0]] - X[pairs[:, 1]], axis=1)
            rest[:, swept] = rest_lengths_for(self.scene.law, l, t, EA)[:, swept]
        return found

    def scene_at(self, values: np.ndarray, shape: np.ndarray | None = None) -> Scene:
        """Return the scene with swept values, (axes,), its start another shape, (n, d), where it is free."""
        scene = self.scene
        found = {name: rows[0] for name, rows in self.arrays(values[None]).items()}
        start = found.get("coordinates", scene.coordinates)
        if shape is not None:
            start = np.where(from_scene(scene).free, shape, start)
        scene = replace(scene, coordinates=start)
        if "rest_lengths" in found:
            scene = scene.with_rest_lengths(found["rest_lengths"])
        if "EA" in found:
            scene = scene.with_axial_stiffness(found["EA"])
        if "weights" in found:
            scene = scene.with_weights(found["weights"])
        if "loads" in found:
            scene = replace(scene, loads=dict(enumerate(map(tuple, found["loads"].tolist()))))
        return scene

    def solved(self, chunk: Span) -> SolvedRows:
        """Return the rows of a chunk, each from the scene's own start."""
        values = chunk.values
        arrays, structure = self.arrays(values), from_scene(self.scene)
        good = self.may_be(arrays, len(values))
        arrays = {name: array[good] for name, array in arrays.items()}
        swept = {axis.key: column.tolist() for axis, column in zip(self.axes, values.T, strict=True)}
        answers = solve_many(self.scene, **arrays, **self.options.to_dict())
        rest = np.broadcast_to(arrays.get("rest_lengths", structure.rest_lengths), answers.forces.shape)
        told = self.told(answers, Answers(structure, answers.coordinates, answers.forces, rest))
        if not good.all():
            told = {name: _spread(column, good) for name, column in told.items()}
            told["verdict"] = np.where(good, told["verdict"], BAD_SCENE)
            told["converged"] = np.where(good, told["converged"], False)
        columns = swept | {name: column.tolist() for name, column in told.items()}
        asked = self.options.analysis != "never"
        unsaid = asked and answers.converged & [word is None for word in answers.stability]
        return SolvedRows(columns, *(int(np.sum(rows)) for rows in (~answers.converged, ~good, unsaid)))

    def may_be(self, arrays: dict[str, np.ndarray], count: int) -> np.ndarray:
        """Return (m,) bool: rows whose pretensions have rest lengths, and whose loads can be held."""
        good: np.ndarray = np.ones(count, dtype=bool)
        if "rest_lengths" in arrays:
            good &= np.isfinite(arrays["rest_lengths"]).all(axis=1)
        if "loads" in arrays or "weights" in arrays:
            structure = from_scene(self.scene)
            own = {name: array[None] for name, array in own_numbers(self.scene, structure).items()}
            loads = total_loads(self.scene, structure, own | arrays)
            good &= ~net_loads(self.scene, structure.free, loads).any(axis=(1, 2))
        return good

    def told(self, answers: Solutions, shapes: Answers) -> dict[str, np.ndarray]:
        """Return the columns that follow the swept values, (m,) each."""
        return {name: getattr(answers, column) for name, column in _COLUMNS.items()} | {
            name: out(shapes) for name, out in self.outs.items()
        }


_COLUMNS = dict(zip(HOW_ROWS_ENDED, HOW_ROWS_ENDED, strict=True)) | {"verdict": "verdicts"}


def _spread(column: np.ndarray, good: np.ndarray) -> np.ndarray:
    """Return the values of good rows, (g,), at their places among all, (m,); None elsewhere."""
    found = np.full(len(good), None, dtype=object)
    found[good] = column.tolist()
    return found


def planned(
    scene: Scene,
    *,
    set: Mapping[str, Values] | None = None,
    scale: Mapping[str, Values] | None = None,
    out: Sequence[str] = (),
    zip: bool = False,
    random: int | None = None,
    **changes: object,
) -> Sweep:
    """Return a sweep, all of it checked.

    set, scale: key -> values, or factors of the scene's own, as on the command line or as numbers; out: words
    on what is told of each shape. All combinations make a row each unless zip, side by side, or random, so
    many rows, by the solve option seed. Raises OptionError for what is asked wrongly, SceneError for a
    geometry.
    """
    refuse_geometry(scene)
    if zip and random is not None:
        raise OptionError("a sweep is zipped or random, not both")
    own = axes(scene, set or {}, scale or {}, random is not None)
    options = DEFAULTS.merged({**scene.solver, **changes})
    counts = [len(axis.values) for axis in own]
    order = "zip" if zip else "grid" if random is None else "random"
    if zip and len({*counts}) > 1:
        told = ", ".join(f"{axis.key} has {len(axis.values)}" for axis in own)
        raise OptionError(f"zipped axes must have as many values each; {told}")
    rows = MOST_ROWS.checked(
        "the number of rows", {"grid": prod(counts), "zip": counts[0]}.get(order, random)
    )
    return Sweep(scene, options, own, outs(scene, out), order, rows)
