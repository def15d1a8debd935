"""What all claims are measured on: the paper's three structures, with slack and without, and many starts."""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

import cgff_cli
from cgff_cli.mechanics.state import State
from cgff_cli.options import SolveOptions
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers import cgff
from cgff_cli.solvers.solution import Solution
from cgff_cli.structure import Structure, from_scene

STRUCTURES = Path(__file__).parents[3] / "structures"
NAMES = {"x-module": "II", "hexagon": "III", "prism": "IV"}
"""Shipped scene -> the paper's table."""

LAWS = {"slack": "cables go slack", "push": "cables push too, as in the paper"}


@cache
def scene_of(name: str, law: str = "slack") -> Scene:
    """Return a shipped scene; under the law `push` its cables are struts."""
    scene = cgff_cli.load(STRUCTURES / f"{name}.yaml")
    if law == "slack":
        return scene
    return replace(scene, groups=tuple(replace(group, kind="strut") for group in scene.groups))


def structure_of(name: str, law: str = "slack") -> Structure:
    """Return the arrays of a shipped scene."""
    return from_scene(scene_of(name, law))


@cache
def answer_of(name: str) -> Solution:
    """Return the equilibrium found from the scene's own start."""
    return cgff.form_find(structure_of(name), SolveOptions(tolerance=1e-12))


def relative_residual(state: State) -> float:
    """Return the largest out-of-balance force component over the largest element force."""
    return float(np.abs(state.g).max() / np.abs(state.t).max())


def random_starts(name: str, count: int) -> Iterator[np.ndarray]:
    """Yield shapes (n, d) with every coordinate within a mean element length of 0, seeds 0, 1, ..."""
    answer = answer_of(name)
    reach = float(answer.lengths.mean())
    for seed in range(count):
        yield np.random.default_rng(seed).uniform(-reach, reach, answer.shape.shape)


def all_starts(name: str, count: int) -> Iterator[np.ndarray]:
    """Yield the scene's own start, then random ones."""
    yield structure_of(name).coordinates
    yield from random_starts(name, count)
