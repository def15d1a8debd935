"""The search for all equilibria: many starts solved as batches, distinct answers, kinds, counts.

Half of the starts are the scene's own and random ones. The others go along the softest modes of what these
found, then of what those found, and what is left is random again. Starts are numbered in this order and
solved in fixed chunks, so that nothing depends on how many processes share the work.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import count, islice

import numpy as np

from cgff_cli.many import solve_many
from cgff_cli.options import DEFAULTS, SolveOptions
from cgff_cli.scene.scene import Scene
from cgff_cli.structure import from_scene
from cgff_cli.study.kinds import by_kind
from cgff_cli.study.landscape import Equilibria, Landscape
from cgff_cli.study.machine import done
from cgff_cli.study.sameness import laid
from cgff_cli.study.shapes import Shapes
from cgff_cli.study.starts import along_modes, by_energy, random_start
from cgff_cli.values import Rule

SEARCH = {
    "starts": Rule("how many solves, all told", int, least=1, most=10**7),
    "seed": Rule("of the random starts", int, least=0, largest=2**53),
    "jobs": Rule("processes at work", int, least=1, most=10**4),
}
"""What a search is asked for beside solve options, and what each may be."""

CHUNK, CHUNK_ELEMENTS = 200, 6000
"""Starts solved together: at most as many, and as many as have so many elements in all. With 50 a search
takes twice as long, with 1000 a fourth less, and is heard of less often."""

Watcher = Callable[[int, int, str], None]
"""Called with how many starts are solved, of how many, and words on what they found."""


@dataclass(frozen=True, eq=False)
class Chunk:
    """Some starts, a job of the machine: the number of the first, and coordinates (m, n, d)."""

    first: int
    coordinates: np.ndarray
    digest: str = ""


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
        self.landscape = Landscape()
        self.is_interrupted = False

    def run(self) -> None:
        """Solve all starts: random ones, those along modes of what is new, and what is left."""
        self.solve(self._random(), (self.starts + 1) // 2)
        explored = 0
        while (self.left and explored < len(self.landscape.shapes.found)) and not self.is_interrupted:
            new = self.landscape.shapes.found[explored:]
            explored = len(self.landscape.shapes.found)
            along = list(islice(along_modes(self.structure, by_energy(new)), self.left))
            self.solve(iter(along), len(along))
        self.solve(self._random(), self.left)

    @property
    def left(self) -> int:
        """Starts not yet solved."""
        return self.starts - self.landscape.solved

    def _random(self) -> Iterator[np.ndarray]:
        return (
            random_start(self.structure, self.options.seed, number) for number in count(self.landscape.solved)
        )

    def solve(self, coordinates: Iterator[np.ndarray], most: int) -> None:
        """Solve at most so many starts, in chunks; a process is worth starting for two."""
        chunks = self._chunks(islice(coordinates, 0 if self.is_interrupted else most))
        processes = max(1, min(self.jobs, most // (2 * self.at_once)))
        for ended in done(chunks, self.work, processes=processes):
            if ended.is_interrupt:
                self.is_interrupted = True
                return
            if ended.error is not None:
                raise ended.error
            self.landscape.add(ended.found)
            found = self.landscape.shapes.found
            if self.watcher is not None:
                words = f"starts, distinct equilibria: {len(found)}"
                self.watcher(self.landscape.solved, self.starts, words)

    def _chunks(self, coordinates: Iterator[np.ndarray]) -> Iterator[Chunk]:
        first = self.landscape.solved
        while rows := list(islice(coordinates, self.at_once)):
            yield Chunk(first, np.stack(rows))
            first += len(rows)

    def told(self, everything: bool) -> Equilibria:
        """Return what was found, by energy; free bodies laid over the first, that over the start."""
        found = [own for own in self.landscape.shapes if everything or own.stability == "stable"]
        kinds, found = by_kind(self.structure, found)
        if self.structure.free.all():
            target = self.structure.coordinates
            for place, own in enumerate(found):
                found[place] = replace(own, coordinates=laid(own.coordinates, target, own.leeway))
                target = found[0].coordinates
        told = self.scene, self.options.seed, self.landscape, tuple(found), tuple(kinds)
        return Equilibria(*told, self.is_interrupted)


def settled(scene: Scene, options: SolveOptions, everything: bool, chunk: Chunk) -> Landscape:
    """Return what came of some starts; a neutral answer, one of many, is only counted unless asked for."""
    answers = solve_many(scene, coordinates=chunk.coordinates, **options.to_dict())
    neutral = answers.stability == "neutral"
    kept = answers.converged & (everything | ~neutral)
    shapes = Shapes()
    rows = np.flatnonzero(kept).tolist()
    numbered = ((chunk.first + row, answers.coordinates[row]) for row in rows)
    shapes.add_answers(from_scene(scene), options, numbered)
    return Landscape(
        shapes,
        solved=len(kept),
        not_converged=int((~answers.converged).sum()),
        left_neutral=int((answers.converged & ~kept).sum()),
    )
