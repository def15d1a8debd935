"""All equilibria that can be found: many starts solved as batches, distinct answers, kinds, counts.

Half of the starts are the scene's own and random ones. The others go along the softest modes of what these
found, then of what those found, and what is left is random again. Starts are numbered in this order and
solved in fixed chunks, so that nothing depends on how many processes share the work.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import count, islice
from typing import Any

import numpy as np

from cgff_cli import TOOL
from cgff_cli.many import solve_many
from cgff_cli.options import DEFAULTS, SolveOptions
from cgff_cli.scene.scene import Scene
from cgff_cli.structure import Structure, from_scene
from cgff_cli.study.alignment import size
from cgff_cli.study.machine import done
from cgff_cli.study.sameness import laid
from cgff_cli.study.shapes import Shape, Shapes
from cgff_cli.study.starts import along_modes, by_energy, random_start
from cgff_cli.study.symmetries import Symmetries
from cgff_cli.values import Rule

EQUILIBRIA_SCHEMA = "cgff-equilibria/1"

SEARCH = {
    "starts": Rule("how many solves, all told", int, least=1, most=10**7),
    "seed": Rule("of the random starts", int, least=0, largest=2**53),
    "jobs": Rule("processes at work", int, least=1, most=10**4),
}
"""What a search is asked for beside solve options, and what each may be."""

CHUNK, CHUNK_ELEMENTS = 100, 4000
"""Starts solved together: at most as many, and as many as have so many elements in all."""

Watcher = Callable[[int, int], None]
"""Called with the starts solved so far, and the distinct equilibria among their answers."""


@dataclass(frozen=True, eq=False)
class Chunk:
    """Some starts, a job of the machine: the number of the first, and coordinates (m, n, d)."""

    first: int
    coordinates: np.ndarray
    digest: str = ""


@dataclass(eq=False)
class Findings:
    """What came of some starts: the distinct shapes, and how many answers are none, or left out as neutral."""

    shapes: Shapes
    solved: int = 0
    not_converged: int = 0
    left_neutral: int = 0

    def add(self, others: "Findings") -> None:
        """Take in what came of other starts, later ones."""
        for shape in others.shapes:
            self.shapes.add(shape)
        self.solved += others.solved
        self.not_converged += others.not_converged
        self.left_neutral += others.left_neutral


@dataclass(frozen=True, eq=False)
class Equilibria:
    """What a search found. kinds_of: the kind of each shape, from 1; is_interrupted: Ctrl-C ended it early."""

    source: Scene
    seed: int
    findings: Findings
    shapes: tuple[Shape, ...]
    kinds_of: tuple[int, ...]
    is_interrupted: bool = False

    @property
    def starts(self) -> int:
        """Starts solved."""
        return self.findings.solved

    @property
    def kinds(self) -> int:
        """Number of kinds among the equilibria listed."""
        return len(set(self.kinds_of))

    def led_to(self, stability: str | None) -> int:
        """Return how many starts led to equilibria of that stability; None: which it is cannot be told."""
        found = sum(own.count for own in self.findings.shapes if own.stability == stability)
        return found + (self.findings.left_neutral if stability == "neutral" else 0)

    @property
    def equilibria(self) -> list[dict[str, Any]]:
        """The equilibria listed, as plain values, by energy."""
        names = self.source.node_names
        return [
            {
                "energy": own.energy,
                "kind": kind,
                "count": own.count,
                "stability": own.stability,
                "smallest_stiffness": own.smallest_stiffness,
                "slack_count": own.slack_count,
                "residual_relative": own.residual_relative,
                "nodes": dict(zip(names, own.coordinates.tolist(), strict=True)),
                "first_start": own.first_start,
            }
            for own, kind in zip(self.shapes, self.kinds_of, strict=True)
        ]

    def to_dict(self) -> dict[str, Any]:
        """Return every field of the JSON, in the order it is written."""
        return {
            "schema": EQUILIBRIA_SCHEMA,
            "tool": dict(TOOL),
            "scene": self.source.summary,
            "starts": self.starts,
            "seed": self.seed,
            "interrupted": self.is_interrupted,
            "not_converged": self.findings.not_converged,
            "unstable": self.led_to("unstable"),
            "neutral": self.led_to("neutral"),
            "undecided": self.led_to(None),
            "kinds": self.kinds,
            "equilibria": self.equilibria,
        }


def equilibria(
    scene: Scene | str,
    *,
    starts: int = 200,
    seed: int = 0,
    jobs: int = 1,
    everything: bool = False,
    watcher: Watcher | None = None,
    **changes: object,
) -> Equilibria:
    """Return the distinct stable equilibria of a scene, or of the scene file at a path, best first.

    starts counts every solve; jobs: processes, of which nothing found depends; everything: unstable and
    neutral ones too. Other keywords are solve options. Raises OptionError for a bad value; Ctrl-C ends the
    search and leaves what was found.
    """
    if not isinstance(scene, Scene):
        from cgff_cli.scene.read import load

        scene = load(scene)
    starts, seed, jobs = (
        SEARCH[name].checked(name, value)
        for name, value in (("starts", starts), ("seed", seed), ("jobs", jobs))
    )
    options = DEFAULTS.merged({**scene.solver, **changes, "analysis": "auto", "seed": seed})
    search = Search(scene, options, starts, jobs, everything, watcher)
    try:
        search.run()
    except KeyboardInterrupt:
        search.is_interrupted = True
    return search.told(everything)


class Search:
    """A search under way."""

    def __init__(
        self,
        scene: Scene,
        options: SolveOptions,
        starts: int,
        jobs: int,
        everything: bool,
        watcher: Watcher | None,
    ):
        self.scene, self.options, self.starts, self.jobs = scene, options, starts, jobs
        self.watcher = watcher
        self.structure = from_scene(scene)
        self.work = partial(settled, scene, options, everything)
        self.at_once = max(1, min(CHUNK, CHUNK_ELEMENTS // len(self.structure.start)))
        self.findings = Findings(Shapes())
        self.is_interrupted = False

    def run(self) -> None:
        """Solve all starts: random ones, those along modes of what is new, and what is left."""
        self.solve(self._random(), (self.starts + 1) // 2)
        explored = 0
        while (self.left and explored < len(self.findings.shapes.found)) and not self.is_interrupted:
            new = self.findings.shapes.found[explored:]
            explored = len(self.findings.shapes.found)
            self.solve(along_modes(self.structure, by_energy(new)), self.left)
        self.solve(self._random(), self.left)

    @property
    def left(self) -> int:
        """Starts not yet solved."""
        return self.starts - self.findings.solved

    def _random(self) -> Iterator[np.ndarray]:
        return (
            random_start(self.structure, self.options.seed, number) for number in count(self.findings.solved)
        )

    def solve(self, coordinates: Iterator[np.ndarray], most: int) -> None:
        """Solve at most so many starts, in chunks; a few need no other processes."""
        chunks = list(self._chunks(islice(coordinates, 0 if self.is_interrupted else most)))
        processes = min(self.jobs, len(chunks)) or 1
        for ended in done(chunks, self.work, processes=processes):
            if ended.is_interrupt:
                self.is_interrupted = True
                return
            if ended.error is not None:
                raise ended.error
            self.findings.add(ended.found)
            if self.watcher is not None:
                self.watcher(self.findings.solved, len(self.findings.shapes.found))

    def _chunks(self, coordinates: Iterator[np.ndarray]) -> Iterator[Chunk]:
        first = self.findings.solved
        while rows := list(islice(coordinates, self.at_once)):
            yield Chunk(first, np.stack(rows))
            first += len(rows)

    def told(self, everything: bool) -> Equilibria:
        """Return what was found, sorted: the best first, laid over the scene's start, the others over it."""
        found = [own for own in self.findings.shapes if everything or own.stability == "stable"]
        kinds, found = _by_kind(self.structure, found)
        target, placed = self.structure.coordinates, []
        for own in found:
            X = laid(own.coordinates, target, own.leeway)
            X = np.where(self.structure.free, X, self.structure.coordinates)
            target = target if placed else X
            placed.append(replace(own, coordinates=X))
        return Equilibria(
            self.scene, self.options.seed, self.findings, tuple(placed), tuple(kinds), self.is_interrupted
        )


def settled(scene: Scene, options: SolveOptions, everything: bool, chunk: Chunk) -> Findings:
    """Return what came of a chunk of starts; what is neutral is one of many, and only counted unless asked."""
    answers = solve_many(scene, coordinates=chunk.coordinates, **options.to_dict())
    neutral = answers.stability == "neutral"
    kept = answers.converged & (everything | ~neutral)
    shapes = Shapes()
    rows = np.flatnonzero(kept).tolist()
    numbered = ((chunk.first + row, answers.coordinates[row]) for row in rows)
    shapes.add_answers(from_scene(scene), options, numbered)
    return Findings(
        shapes,
        solved=len(kept),
        not_converged=int((~answers.converged).sum()),
        left_neutral=int((answers.converged & ~kept).sum()),
    )


def _by_kind(structure: Structure, shapes: list[Shape]) -> tuple[list[int], list[Shape]]:
    """Return kinds, from 1, and the shapes in the order of energies; of one kind all have the first's."""
    symmetries = Symmetries(structure)
    firsts: list[Shape] = []
    kinds: list[tuple[Shape, int]] = []
    for own in shapes:
        place = next((i for i, first in enumerate(firsts) if _is_image(symmetries, own, first)), len(firsts))
        firsts += [own] if place == len(firsts) else []
        kinds.append((replace(own, energy=firsts[place].energy), place))
    kinds.sort(key=lambda pair: (pair[0].energy, pair[1], pair[0].first_start))
    numbers: dict[int, int] = {}
    return [numbers.setdefault(place, len(numbers) + 1) for _, place in kinds], [own for own, _ in kinds]


def _is_image(symmetries: Symmetries, own: Shape, other: Shape) -> bool:
    """Return whether a symmetry maps a shape to another: lengths in order tell most apart."""
    within = max(own.within, other.within)
    if own.stability != other.stability:
        return False
    if np.abs(np.sort(own.lengths) - np.sort(other.lengths)).max() > 2.0 * within:
        return False
    return symmetries.map(own.coordinates, other.coordinates, size(other.coordinates), within)
