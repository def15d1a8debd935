"""Adaptive force densities against closed forms, and its step against the definition."""

from math import pi, sin, sqrt

import numpy as np
import pytest

import cgff_cli
from cgff_cli.rivals.afdm import placed, shortfall
from cgff_cli.rivals.forms import spectrum
from cgff_cli.scene.read import from_dict
from tests.closed_forms.references import LAWS, crossed_square, expanded_octahedron, prism
from tests.rivals.test_fdm import densities
from tests.shapes import STRUCTURES

RIGHT = 1e-9


def found(scene):
    return cgff_cli.compare(scene, ["afdm"], repeat=1).methods[1]


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("reference", [prism(3), prism(7), crossed_square(), expanded_octahedron()])
def test_it_comes_to_the_closed_form(reference, law):
    scene = from_dict(reference.scene(law, 0.1, 1))
    method = found(scene)
    assert (method.converged, method.stable, method.alignment) == (True, True, "affine")
    assert method.lengths == pytest.approx(reference.lengths, rel=RIGHT)
    forces = np.array(method.force_densities) * method.lengths
    assert forces == pytest.approx(reference.forces, rel=RIGHT)


@pytest.mark.parametrize("sides", [3, 5, 8])
def test_an_n_prism_has_the_force_densities_of_its_closed_form(sides):
    scene = cgff_cli.new("prism", sides=sides, noise=0.1, seed=1)
    q = densities(scene, found(scene))
    assert np.abs(q["sides"] - 0.5 / sin(pi / sides)).max() < RIGHT
    assert np.abs(q["verticals"] - 1.0).max() < RIGHT


def test_the_shipped_prism_and_x_module_and_octahedron():
    expected = {
        "prism": {"triangles": 1.0 / sqrt(3.0), "verticals": 1.0},
        "x-module": {"cables": 1.0},
        "octahedron": {"cables": 2.0 / 3.0},
    }
    for name, groups in expected.items():
        scene = cgff_cli.load(STRUCTURES / f"{name}.yaml")
        q = densities(scene, found(scene))
        for group, value in groups.items():
            assert np.abs(q[group] - value).max() < RIGHT, name


def test_a_form_that_the_scene_does_not_hold_is_called_another_equilibrium():
    method = found(cgff_cli.load(STRUCTURES / "x-module.yaml"))
    assert (method.verdict, method.converged, method.stable) == ("other_equilibrium", False, None)
    assert "EA and rest lengths do not hold" in method.message


def test_supports_are_refused_as_is_what_carries_no_self_stress():
    held = found(cgff_cli.load(STRUCTURES / "cable-net.yaml"))
    assert (held.verdict, held.nodes) == ("failed", None)
    assert held.message == "it knows no supports: its forms are free bodies"
    nodes = {"a": [0, 0], "b": [1, 0], "c": [0, 1]}
    group = {"kind": "cable", "EA": 1, "rest_length": 1, "pairs": [["a", "b"], ["b", "c"], ["c", "a"]]}
    slack = found(from_dict({"law": "hooke", "nodes": nodes, "elements": {"sides": group}}))
    assert (slack.verdict, slack.nodes) == ("failed", None)


def test_what_is_set_to_zero_leaves_the_nearest_matrix_that_is_semidefinite_and_lacks_its_rank():
    rho_t = np.array([[-1, 0, 0, 1, 1, 0], [1, -1, 0, 0, 0, 1], [0, 1, -1, 0, -1, 0], [0, 0, 1, -1, 0, -1]])
    D = rho_t * np.array([1.0, 1.2, 0.9, 1.1, -1.0, -0.7]) @ rho_t.T
    values, vectors = np.linalg.eigh(D)
    values[np.abs(vectors.sum(axis=0)) > 1.0] = np.inf
    low = np.argsort(values)[:2]
    T = D - (vectors[:, low] * values[low]) @ vectors[:, low].T
    expected = np.einsum("ib,ij,jb->b", rho_t, T - D, rho_t)
    assert shortfall(spectrum(D), 2, rho_t) == pytest.approx(expected, abs=1e-14)
    assert np.linalg.eigvalsh(T)[:3] == pytest.approx(np.zeros(3), abs=1e-14)


def test_few_nodes_are_placed_and_the_shape_follows_by_an_affine_map():
    X = np.random.default_rng(3).normal(size=(9, 3))
    laid = placed(X)
    corners = [np.zeros(3), *np.eye(3)]
    assert all((np.linalg.norm(laid - corner, axis=1) < 1e-12).sum() == 1 for corner in corners)
    before, after = (np.column_stack([np.ones(9), Y]) for Y in (X, laid))
    assert before @ np.linalg.lstsq(before, after, rcond=None)[0] == pytest.approx(after, abs=1e-12)
