"""Load cases: one scene, solved under each, from its equilibrium without them."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from cgff_cli import pipeline
from cgff_cli.errors import OptionError
from cgff_cli.result import Result
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.solution import Observer
from cgff_cli.values import ALL_CASES, DEAD

BEGINS = "equilibrium without cases", "start of the scene", "shape given"
"""Where a case begins: the first if there is one, else the second; the third where it was put there."""


def asked_cases(scene: Scene, case: str) -> tuple[str, ...]:
    """Return the names that a name, or "all", asks for; raises OptionError for all where there is none."""
    if case != ALL_CASES:
        return (case,)
    if not scene.cases:
        raise OptionError(f"{scene.path}: --case all: the scene has no load_cases or combinations")
    return scene.cases


def scene_in_case(scene: Scene, name: str | None) -> Scene:
    """Return a scene in a load case or combination, at its own start; as it is where none is named.

    What was read from a result is in the case that it was solved in. Raises OptionError for another.
    """
    if name is None:
        return scene
    if not scene.answer:
        return replace(scene.in_case(name), begins=BEGINS[1])
    if name != (scene.case or DEAD):
        own = f"in case {scene.case!r}" if scene.case else "without a load case"
        raise OptionError(f"{scene.path}: this is the result of a solve {own}, not in {name!r}")
    return scene


def solve_cases(
    scene: Scene | str, names: Iterable[str], *, observer: Observer | None = None, **changes: object
) -> Iterator[Result]:
    """Yield the Result of a scene in each load case or combination, whatever their order; see `solve`.

    Each begins at the scene's own equilibrium without cases, where it has one, unless the scene's `begins`
    says that it is to begin where it stands: result.scene["begins"] tells. Raises OptionError for a case that
    the scene has not.
    """
    if not isinstance(scene, Scene):
        from cgff_cli.scene.read import load

        scene = load(scene)
    scenes = [scene.in_case(name) for name in names]  # before anything is solved

    def run(own: Scene) -> Result:
        return pipeline.solve(own, observer=observer, **changes)

    dead = None if scene.begins else run(scene.in_case(DEAD))
    if dead and dead.interrupted:  # what is left of it is the result of none of them
        raise KeyboardInterrupt
    for own in scenes:
        if dead and own.case == DEAD:
            yield dead
            continue
        result = run(_after(dead, own) if dead else own)
        yield result
        if result.interrupted:
            return


def _after(dead: Result, scene: Scene) -> Scene:
    """Return a scene that begins where the one without cases came to, if its forces balance there."""
    begun = scene.with_coordinates(dead.coordinates) if dead.converged else scene
    return replace(begun, begins=BEGINS[not dead.converged])


@dataclass
class Envelope:
    """Least and greatest of what results of one scene have, and in which case.

    least, greatest : forces (b,), then reactions (s d,) of the s supports   cases : names, results' order
    least_in, greatest_in : the numbers of the cases                        left_out : those without balance
    """

    least: np.ndarray
    greatest: np.ndarray
    least_in: np.ndarray
    greatest_in: np.ndarray
    cases: list[str]
    left_out: list[str]


def envelope_of(results: Iterable[Result]) -> Envelope | None:
    """Return the envelope of the results whose forces balance; None where there is none."""
    cases, rows, left_out = [], [], []
    for result in results:
        if not result.converged:
            left_out.append(result.source.case)
            continue
        held = sorted(result.source.supports)
        cases.append(result.source.case)
        rows.append(np.concatenate([result.forces, result.solution.reactions[held].ravel()]))
    if not rows:
        return None
    table = np.stack(rows)
    least, greatest = table.argmin(axis=0), table.argmax(axis=0)
    return Envelope(table.min(axis=0), table.max(axis=0), least, greatest, cases, left_out)
