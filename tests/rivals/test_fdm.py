"""Form-finding from connectivity and signs: Estrada, Bungartz and Mohrdieck (2006)."""

from dataclasses import replace
from math import pi, sin, sqrt

import numpy as np
import pytest

import cgff_cli
from cgff_cli.rivals.forms import Form, fault_of, prototype, spectrum, unit_coordinates
from cgff_cli.rivals.symmetry import member_classes
from cgff_cli.scene.scene import Group, Scene
from cgff_cli.structure import from_scene
from cgff_cli.study.record import Method
from tests.shapes import STRUCTURES

RIGHT = 1e-8


def found(scene: Scene) -> Method:
    return cgff_cli.compare(scene, ["fdm"], repeat=1).methods[1]


def densities(scene: Scene, method: Method) -> dict[str, np.ndarray]:
    """Return force densities by group, scaled to -1 in the first strut."""
    assert method.force_densities is not None, method.message
    q = np.array(method.force_densities)
    q /= abs(q[[group.kind == "strut" for group in scene.groups for _ in group.EA]][0])
    cuts = np.cumsum([len(group.EA) for group in scene.groups])[:-1]
    return dict(zip([group.name for group in scene.groups], np.split(q, cuts), strict=True))


def in_two_groups(scene: Scene) -> Scene:
    """Return the scene with one group of all cables and one of all struts."""
    groups = [
        Group(
            kind,
            kind,
            *(np.concatenate([getattr(g, a) for g in own]) for a in ("pairs", "EA", "rest_length")),
        )
        for kind in ("cable", "strut")
        if (own := [g for g in scene.groups if g.kind == kind])
    ]
    return replace(scene, groups=tuple(groups))


@pytest.mark.parametrize("sides", range(3, 13))
def test_an_n_prism_has_its_closed_form(sides: int):
    scene = cgff_cli.new("prism", sides=sides, noise=0.1, seed=1)
    method = found(scene)
    q = densities(scene, method)
    assert np.abs(q["sides"] - 0.5 / sin(pi / sides)).max() < RIGHT
    assert np.abs(q["verticals"] - 1.0).max() < RIGHT
    assert np.abs(q["struts"] + 1.0).max() < RIGHT
    assert method.alignment == "affine"
    assert method.max_node_difference < RIGHT


@pytest.mark.parametrize("sides", range(3, 13))
def test_signs_alone_tell_sides_from_verticals(sides: int):
    scene = in_two_groups(cgff_cli.new("prism", sides=sides, noise=0.1, seed=1))
    q = densities(scene, found(scene))
    side, vertical = 0.5 / sin(pi / sides), 1.0
    expected = np.repeat([side, vertical], [2 * sides, sides])
    assert np.abs(q["cable"] - expected).max() < RIGHT


def test_the_prism_of_table_4():
    scene = cgff_cli.load(STRUCTURES / "prism.yaml")
    method = found(scene)
    q = densities(scene, method)
    assert np.abs(q["triangles"] - 1.0 / sqrt(3.0)).max() < RIGHT
    assert np.abs(q["verticals"] - 1.0).max() < RIGHT
    assert method.converged
    assert method.stable
    assert method.distance_matrix_difference < 1e-12


def test_the_x_module_has_cables_of_1_and_struts_of_minus_1():
    scene = cgff_cli.load(STRUCTURES / "x-module.yaml")
    q = densities(scene, found(scene))
    assert np.abs(q["cables"] - 1.0).max() < RIGHT
    assert np.abs(q["struts"] + 1.0).max() < RIGHT


def test_the_expanded_octahedron_has_struts_of_minus_three_halves_of_its_cables():
    scene = cgff_cli.load(STRUCTURES / "octahedron.yaml")
    method = found(scene)
    q = densities(scene, method)
    assert np.abs(q["struts"] / -1.5 - q["cables"][0]).max() < RIGHT
    assert np.abs(q["cables"] - q["cables"][0]).max() < RIGHT
    assert method.max_node_difference < RIGHT


def test_neither_start_nor_stiffness_nor_rest_lengths_matter():
    one = cgff_cli.new("octahedron", noise=0.1, seed=1)
    other = cgff_cli.new("octahedron", noise=0.3, seed=2, EA=7.0, jitter=0.02)
    here, there = (densities(scene, found(scene)) for scene in (one, other))
    for name in here:
        assert np.abs(here[name] - there[name]).max() < RIGHT


def test_a_form_that_the_scene_does_not_hold_is_called_another_equilibrium():
    method = found(cgff_cli.load(STRUCTURES / "hexagon.yaml"))
    assert (method.verdict, method.converged, method.stable) == ("other_equilibrium", False, None)
    assert method.residual_relative > 1e-3
    assert "EA and rest lengths do not hold" in method.message


def test_a_scene_that_carries_no_self_stress_is_a_row_that_says_so():
    square = cgff_cli.from_dict(
        {
            "law": "hooke",
            "nodes": {"a": [0, 0], "b": [1, 0], "c": [1, 1], "d": [0, 1]},
            "elements": {
                "sides": {
                    "kind": "cable",
                    "EA": 1,
                    "rest_length": 1,
                    "pairs": [["a", "b"], ["b", "c"], ["c", "d"], ["d", "a"]],
                }
            },
        }
    )
    method = found(square)
    assert (method.verdict, method.converged, method.nodes) == ("failed", False, None)
    assert "with one force density per member" in method.message


def test_classes_tell_apart_what_no_symmetry_exchanges():
    scene = in_two_groups(cgff_cli.new("prism", sides=5))
    pairs = np.concatenate([group.pairs for group in scene.groups])
    signs = np.repeat([1.0, -1.0], [15, 5])
    classes = member_classes(pairs[:, 0], pairs[:, 1], signs, 10)
    assert [len(set(classes[rows])) for rows in (slice(0, 10), slice(10, 15), slice(15, 20))] == [1, 1, 1]
    assert len(set(classes)) == 3


def test_a_cable_beside_a_strut_is_of_another_class():
    classes = member_classes(np.array([0, 0]), np.array([1, 1]), np.array([1.0, -1.0]), 2)
    assert classes[0] != classes[1]


def test_a_form_with_a_pulling_strut_is_none():
    pairs = {"strut": [["a", "b"], ["b", "c"]], "cable": [["c", "d"], ["d", "a"], ["a", "c"], ["b", "d"]]}
    scene = cgff_cli.from_dict(
        {
            "law": "hooke",
            "nodes": {"a": [0, 0], "b": [1, 0], "c": [1, 1.2], "d": [0, 1]},
            "elements": {
                kind: {"kind": kind, "EA": 10, "rest_length": 0.9, "pairs": own}
                for kind, own in pairs.items()
            },
        }
    )
    method = found(scene)
    assert method.verdict == "failed"
    assert "some member has the wrong sign" in method.message


def test_a_force_density_whose_sign_rounding_decides_is_none():
    structure = from_scene(cgff_cli.load(STRUCTURES / "x-module.yaml"))
    square, q = np.array([[0, 0], [1, 0], [1, 1], [0, 1]]), prototype(structure)
    for share, words in (
        (1e-15, "some member carries no force"),
        (-1e-15, "some member carries no force"),
        (-0.1, "some member has the wrong sign"),
    ):
        q[0] = share
        assert fault_of(structure, Form(square, q, 0.0), np.arange(6)) == words


def test_eigenvectors_that_tie_are_taken_together_as_no_rule_could_pick_among_them():
    X, left = unit_coordinates(
        spectrum(0.3 * (7.0 * np.eye(7) - 1.0)), 2
    )  # seven nodes, every two joined: a simplex
    distances = np.linalg.norm(X[:, None] - X[None], axis=-1)[np.triu_indices(7, 1)]
    assert X.shape == (7, 6)
    assert np.ptp(distances) < 1e-12
    assert left > 0.1
