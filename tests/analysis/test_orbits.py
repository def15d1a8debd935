"""Which members symmetries exchange: those of graph, coordinates, kinds, supports and loads together."""

from dataclasses import replace

import numpy as np
import pytest

from cgff_cli.analysis.orbits import orbits
from cgff_cli.structure import from_scene
from tests.geometries import dome, geometry, moved, net, prism, solid, stack, wheel, x_module


def counts(scene):
    """Return how many members each class has, in order of first members."""
    pairs = np.concatenate([group.pairs for group in scene.groups])
    l = np.linalg.norm(np.diff(scene.coordinates[pairs], axis=1)[:, 0], axis=1)
    return np.bincount(orbits(from_scene(scene.with_rest_lengths(l)))).tolist()


@pytest.mark.parametrize(
    ("scene", "wanted"),
    [
        (prism(7), [14, 7, 7]),
        (prism(7, top=0.6), [7, 7, 7, 7]),
        (solid("dodecahedron"), [30, 10]),
        (solid("icosahedron"), [30, 6]),
        (wheel(5), [10, 5]),
        (x_module(), [4, 2]),
        (x_module(((0, 0), (2, 0), (2, 1), (0, 1))), [2, 2, 2]),
        (dome(6, 1, levy=False), [6, 6, 6, 6, 6]),
        (dome(6, 1, levy=True), [12, 12, 6, 6, 6]),
        (net(4, 0.4), [8, 4]),
        (stack(3, 2), [6, 3, 6, 6]),
    ],
)
def test_classes_are_those_of_the_symmetry_group(scene, wanted):
    assert sorted(counts(scene)) == sorted(wanted)


def test_nothing_is_alike_in_a_shape_without_symmetry():
    assert counts(moved(prism(4), 0.1, 3)) == [1] * 16


def test_kinds_supports_and_loads_tell_members_apart():
    square = x_module()
    ring = {"one": ("cable", [(0, 1), (2, 3)]), "other": ("strut", [(1, 2), (3, 0)])}
    assert counts(geometry(square.coordinates, ring)) == [2, 2]
    assert counts(square) == [4, 2]
    assert counts(replace(square, supports={0: "xy"})) == [2, 2, 1, 1]
    assert counts(replace(square, supports={0: "x", 2: "x"})) == [2, 2, 1, 1]
    assert counts(replace(square, supports={0: "y", 1: "y"})) == [1, 2, 1, 2]
    assert counts(replace(square, loads={0: (1.0, 1.0)})) == [2, 2, 1, 1]
    assert counts(replace(square, loads={0: (1.0, 0.0)})) == [1] * 6


def test_a_flat_shape_in_space_has_the_symmetries_of_its_plane():
    flat = wheel(3)
    X = np.column_stack((flat.coordinates, np.zeros(6)))
    tilted = X @ np.linalg.qr(np.random.default_rng(4).normal(size=(3, 3)))[0]
    assert counts(replace(flat, coordinates=tilted)) == [6, 3]
