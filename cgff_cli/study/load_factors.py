"""Load factors of a sweep: so much of load cases and combinations, beside a scene's own loads or for them."""

from dataclasses import replace

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.scene.laws import rules
from cgff_cli.scene.nodes import ANY_SIZE
from cgff_cli.scene.scene import Scene
from cgff_cli.structure import loads_of
from cgff_cli.values import DEAD, Rule


def factored_names(scene: Scene) -> tuple[str, ...]:
    """Return the names that have a factor: load cases, combinations, and "dead" for loads and weight."""
    return (*scene.cases, DEAD)


def check_factored(scene: Scene, names: list[str]) -> None:
    """Raise OptionError for a name that the scene has not, and for names that have no meaning together.

    A load case is added to loads and weight; a combination stands in their place.
    """
    for name in names:
        scene.in_case(name)
    whole = [name for name in names if name not in scene.load_cases]
    if len(whole) > 1:
        raise OptionError(
            f"case.{whole[0]} and case.{whole[1]} each stand in the place of loads and weight; sweep one"
        )
    for name in whole or names:
        if scene.case and (whole or name == scene.case):
            raise OptionError(f"case.{name} and --case {scene.case} are both given; leave out --case")


def in_factored(scene: Scene, name: str) -> list[tuple[str, np.ndarray, Rule]]:
    """Return what a factor multiplies, each with what it is called and may be; see `with_factors`."""
    is_whole, there = name not in scene.load_cases, scene.in_case(name)
    loads = there if is_whole else replace(scene, loads=scene.load_cases[name])
    found = [("loads", loads_of(loads), ANY_SIZE)]
    if is_whole and there.weights is not None:
        found.append(("weight", there.weights, rules(scene.law)["weight"]))
    return found


def with_factors(
    scene: Scene, factors: np.ndarray, loads: np.ndarray, weights: np.ndarray
) -> dict[str, np.ndarray]:
    """Return the arrays that factors (m, c) on the names above change; NaN: not swept.

    loads, weights : (m, n, d) and (m, b), or one row for all m
    """
    named = zip(factored_names(scene), factors.T, strict=True)
    amounts = {name: factor for name, factor in named if not np.isnan(factor).any()}
    found = {}
    for whole in [name for name in amounts if name not in scene.load_cases]:  # one at most
        factor, parts = amounts.pop(whole), scene.combinations.get(whole, {DEAD: 1.0})
        dead = factor * parts.get(DEAD, 0.0)
        loads = dead[:, None, None] * loads
        if weights.any():
            found["weights"] = dead[:, None] * weights
        for name in parts.keys() - {DEAD}:
            amounts[name] = amounts.get(name, 0.0) + factor * parts[name]
    for name, amount in sorted(amounts.items()):
        loads = loads + amount[:, None, None] * loads_of(replace(scene, loads=scene.load_cases[name]))
    return found | {"loads": loads}
