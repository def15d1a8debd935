"""What a suite may do to a scene before it is solved: move, scale, stiffen, disturb; and a chain of its own.

A change is a function of a scene and of the value that the suite gives it, and one line in CHANGES.
"""

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.scene.scene import AXES, Scene


def changed(scene: Scene, name: str, value: Any) -> Scene:
    """Return a scene after the change of that name; raises OptionError where the value does not suit it."""
    try:
        found = CHANGES[name](scene, value)
    except (TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise OptionError(f"{name} cannot be {value!r}: {error}") from None
    if not _is_sound(found):
        raise OptionError(f"{name} {value!r} makes numbers that no scene may have")
    return found


def _is_sound(scene: Scene) -> bool:
    stiffness = np.concatenate([group.EA for group in scene.groups])
    rest = np.concatenate([group.rest_length for group in scene.groups])
    least = rest > 0.0 if scene.law == "hooke" else rest >= 0.0
    numbers = np.concatenate([scene.coordinates.ravel(), stiffness, rest])
    return bool(np.isfinite(numbers).all() and (stiffness > 0.0).all() and least.all())


def chain(links: int, span: float, length: float, EA: Sequence[float], weight: float) -> dict[str, Any]:
    """Return a chain of equal links, of the stiffnesses EA in turn, that starts as a level line."""
    last = f"n{links}"
    return {
        "law": "hooke",
        "nodes": {f"n{i}": [span * i / links, 0.0] for i in range(links + 1)},
        "elements": {
            "links": {
                "kind": "cable",
                "EA": [EA[i % len(EA)] for i in range(links)],
                "rest_length": length / links,
                "pairs": [[f"n{i}", f"n{i + 1}"] for i in range(links)],
            }
        },
        "supports": {"n0": "xy", last: "xy"},
        "loads": {f"n{i}": [0.0, -weight / links] for i in range(1, links)},
    }


def _flattened(scene: Scene, factors: Sequence[float]) -> Scene:
    return replace(scene, coordinates=scene.coordinates * np.array(factors))


def _offset(scene: Scene, by: Sequence[float]) -> Scene:
    return replace(scene, coordinates=scene.coordinates + np.array(by))


def _in_units(scene: Scene, units: tuple[float, float]) -> Scene:
    length, force = units
    stiffness = force / length if scene.law == "paper" else force
    groups = tuple(
        replace(group, EA=group.EA * stiffness, rest_length=group.rest_length * length)
        for group in scene.groups
    )
    loads = {row: tuple(force * part for part in load) for row, load in scene.loads.items()}
    return replace(scene, coordinates=scene.coordinates * length, groups=groups, loads=loads)


def _random_start(scene: Scene, seed: int) -> Scene:
    """Return the scene with its free directions anywhere in a box of twice the longest rest length."""
    return _moved(scene, seed, max(float(group.rest_length.max()) for group in scene.groups), 0.0)


def _noisy(scene: Scene, given: tuple[int, float]) -> Scene:
    seed, reach = given
    X, groups = scene.coordinates, scene.groups
    l = np.concatenate([np.linalg.norm(X[g.pairs[:, 0]] - X[g.pairs[:, 1]], axis=1) for g in groups])
    return _moved(scene, seed, reach * float(l.mean()), 1.0)


def _moved(scene: Scene, seed: int, reach: float, kept: float) -> Scene:
    draw = random.Random(f"hard {seed}").uniform
    X = scene.coordinates
    moved = kept * X + np.array([draw(-reach, reach) for _ in range(X.size)]).reshape(X.shape)
    for row, axes in scene.supports.items():
        held = [AXES.index(axis) for axis in axes]
        moved[row, held] = X[row, held]
    return replace(scene, coordinates=moved)


def _stiffened(scene: Scene, factors: Mapping[str, float]) -> Scene:
    unknown = set(factors) - {group.name for group in scene.groups}
    if unknown:
        raise ValueError(f"the scene has no group {', '.join(sorted(unknown))}")
    groups = tuple(replace(group, EA=group.EA * factors.get(group.name, 1.0)) for group in scene.groups)
    return replace(scene, groups=groups)


def _every_other_stiffened(scene: Scene, factor: float) -> Scene:
    """Return the scene with every other element of each group stiffer."""
    groups = tuple(
        replace(group, EA=group.EA * np.where(np.arange(len(group.EA)) % 2, factor, 1.0))
        for group in scene.groups
    )
    return replace(scene, groups=groups)


CHANGES: dict[str, Callable[[Scene, Any], Scene]] = {
    "flatten": _flattened,
    "units": _in_units,
    "random_start": _random_start,
    "noise": _noisy,
    "stiffen": _stiffened,
    "stiffen_every_other": _every_other_stiffened,
    "offset": _offset,
}
"""Key of a case's scene -> what it does: (scene, value) -> scene."""
