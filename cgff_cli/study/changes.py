"""What a suite may do to a scene before it is solved: move, scale, stiffen, disturb; and a chain of its own.

A change is a function of a scene and of the value that the suite gives it, and one line in CHANGES.
"""

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.scene.scene import AXES, Group, Scene


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
    EA, rest = (np.concatenate([getattr(own, of) for own in scene.groups]) for of in ("EA", "rest_length"))
    least = rest > 0.0 if scene.law == "hooke" else rest >= 0.0
    numbers = np.concatenate([scene.coordinates.ravel(), EA, rest])
    return bool(np.isfinite(numbers).all() and (EA > 0.0).all() and least.all())


def chain(links: int, span: float, length: float, EA: Sequence[float], weight: float) -> dict[str, Any]:
    """Return a chain of equal links, of the stiffnesses EA in turn, that starts as a level line."""
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
        "supports": {"n0": "xy", f"n{links}": "xy"},
        "loads": {f"n{i}": [0.0, -weight / links] for i in range(1, links)},
    }


def _by_group(scene: Scene, change: Callable[[Group], Mapping[str, Any]]) -> Scene:
    return replace(scene, groups=tuple(replace(own, **change(own)) for own in scene.groups))


def _in_units(scene: Scene, units: tuple[float, float]) -> Scene:
    length, force = units
    stiffness = force / length if scene.law == "paper" else force
    loads, *cases = (
        {row: tuple(force * part for part in load) for row, load in own.items()}
        for own in (scene.loads, *scene.load_cases.values())
    )
    load_cases = dict(zip(scene.load_cases, cases, strict=True))
    scaled = replace(scene, coordinates=scene.coordinates * length, loads=loads, load_cases=load_cases)
    factors = {"EA": stiffness, "rest_length": length, "weight": force / length}
    return _by_group(
        scaled, lambda own: {name: _times(getattr(own, name), factors[name]) for name in factors}
    )


def _times(values: np.ndarray | None, factor: float) -> np.ndarray | None:
    return None if values is None else values * factor


def _random_start(scene: Scene, seed: int) -> Scene:
    """Return the scene with its free directions anywhere in a box of twice the longest rest length."""
    return _moved(scene, seed, max(float(own.rest_length.max()) for own in scene.groups), 0.0)


def _noisy(scene: Scene, given: tuple[int, float]) -> Scene:
    seed, share = given
    X, pairs = scene.coordinates, np.concatenate([own.pairs for own in scene.groups])
    l = np.linalg.norm(X[pairs[:, 0]] - X[pairs[:, 1]], axis=1)
    return _moved(scene, seed, share * float(l.mean()), 1.0)


def _moved(scene: Scene, seed: int, reach: float, kept: float) -> Scene:
    draw = random.Random(f"hard {seed}").uniform
    X = scene.coordinates
    moved = kept * X + np.array([draw(-reach, reach) for _ in range(X.size)]).reshape(X.shape)
    for row, axes in scene.supports.items():
        held = [AXES.index(axis) for axis in axes]
        moved[row, held] = X[row, held]
    return replace(scene, coordinates=moved)


def _stiffened(scene: Scene, factors: Mapping[str, float]) -> Scene:
    unknown = set(factors) - {own.name for own in scene.groups}
    if unknown:
        raise ValueError(f"the scene has no group {', '.join(sorted(unknown))}")
    return _by_group(scene, lambda own: {"EA": own.EA * factors.get(own.name, 1.0)})


def _every_other_stiffened(scene: Scene, factor: float) -> Scene:
    """Return the scene with every other element of each group stiffer."""
    return _by_group(scene, lambda own: {"EA": own.EA * np.where(np.arange(len(own.EA)) % 2, factor, 1.0)})


CHANGES: dict[str, Callable[[Scene, Any], Scene]] = {
    "flatten": lambda scene, factors: replace(scene, coordinates=scene.coordinates * np.array(factors)),
    "units": _in_units,
    "random_start": _random_start,
    "noise": _noisy,
    "stiffen": _stiffened,
    "stiffen_every_other": _every_other_stiffened,
    "case": lambda scene, name: scene.in_case(name),
    "offset": lambda scene, by: replace(scene, coordinates=scene.coordinates + np.array(by)),
}
"""Key of a case's scene -> what it does: (scene, value) -> scene."""
