"""Prestress where rounding hides the answer: the rest lengths that a shape comes with, if they hold it."""

from dataclasses import replace

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.scene import Scene


@pytest.fixture
def light() -> Scene:
    """A nearly flat net that bears its light ropes alone, at the shape that a solve came to."""
    scene = cgff_cli.new("net", side=7, weight=1e-4)
    return scene.with_coordinates(cgff_cli.solve(scene).coordinates)


def lengths_of(scene: Scene) -> np.ndarray:
    return np.concatenate([group.rest_length for group in scene.groups])


def test_the_scenes_own_rest_lengths_are_told_with_a_word(light: Scene):
    found = cgff_cli.prestress(light)
    assert found.rest_lengths == pytest.approx(lengths_of(light), rel=1e-14)
    assert any(said.startswith("the rest lengths are the scene's own") for said in found.warnings)
    again = cgff_cli.solve(found.scene)
    assert (again.verdict, again.counts["iterations"]) == ("converged", 0)
    assert again.forces == pytest.approx(found.forces, rel=1e-9)


def test_those_that_do_not_hold_it_and_a_geometry_are_no_answer(light: Scene):
    none = (replace(group, rest_length=np.full(len(group.EA), np.nan)) for group in light.groups)
    for other in (light.with_rest_lengths(0.9 * lengths_of(light)), replace(light, groups=tuple(none))):
        assert cgff_cli.prestress(other).feasible is None


def test_nor_are_they_where_more_is_asked_than_a_shape(light: Scene):
    for asked in ({"force": {light.groups[0].name: 3.0}}, {"by_group": True}):
        assert cgff_cli.prestress(light, **asked).feasible is not True
