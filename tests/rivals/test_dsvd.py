"""Double singular value decomposition against closed forms, and its second stage where there is a choice."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest

import cgff_cli
from cgff_cli.mechanics.equilibrium import force_density_matrix
from cgff_cli.rivals.dsvd import integral_state, null_space
from cgff_cli.rivals.forms import Form, prototype
from cgff_cli.scene.read import from_dict
from cgff_cli.structure import from_scene
from tests.closed_forms.references import LAWS, crossed_square, expanded_octahedron, prism
from tests.rivals.test_fdm import densities
from tests.shapes import STRUCTURES

RIGHT = 1e-9
GOLDEN = (1.0 + sqrt(5.0)) / 2.0


def found(scene):
    return cgff_cli.compare(scene, ["dsvd"], repeat=1).methods[1]


def pentagon(noise=0.0):
    """Return five cables around a regular pentagon and its five diagonals as struts: 10 members, 3 states."""
    turn = np.random.default_rng(1).normal(size=(5, 2)) * noise
    groups = {}
    for kind, step, rest_length in (("cable", 1, 1.0), ("strut", 2, 2.0)):
        pairs = [[f"n{i}", f"n{(i + step) % 5}"] for i in range(5)]
        groups[f"{kind}s"] = {"kind": kind, "EA": 10, "rest_length": rest_length, "pairs": pairs}
    corners = [(cos(2 * pi * i / 5), sin(2 * pi * i / 5)) for i in range(5)]
    nodes = {f"n{i}": (np.array(corner) + turn[i]).tolist() for i, corner in enumerate(corners)}
    return from_dict({"law": "hooke", "nodes": nodes, "elements": groups})


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("reference", [prism(3), prism(7), crossed_square(), expanded_octahedron()])
def test_it_comes_to_the_closed_form(reference, law):
    method = found(from_dict(reference.scene(law, 0.1, 1)))
    assert (method.converged, method.stable, method.alignment) == (True, True, "affine")
    assert method.lengths == pytest.approx(reference.lengths, rel=RIGHT)
    forces = np.array(method.force_densities) * method.lengths
    assert forces == pytest.approx(reference.forces, rel=RIGHT)


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


def test_of_a_pentagons_three_states_it_takes_the_one_that_all_sides_and_all_diagonals_share():
    q = densities(pentagon(), found(pentagon(noise=0.1)))
    assert np.abs(q["cables"] - GOLDEN**2).max() < RIGHT
    assert np.abs(q["struts"] + 1.0).max() < RIGHT


def test_the_second_stage_finds_the_integral_state_whatever_state_the_first_came_to():
    structure = from_scene(pentagon())
    form = Form(structure.coordinates, np.random.default_rng(2).normal(size=10), 0.0)
    alike = integral_state(structure, form, np.repeat([0, 1], 5))
    assert alike is not None
    assert alike.q / alike.q[-1] == pytest.approx(np.repeat([-(GOLDEN**2), 1.0], 5), abs=1e-12)
    assert alike.left == 0.0
    assert integral_state(structure, form, np.zeros(10, dtype=int)) is None


def test_with_every_member_on_its_own_it_is_the_state_nearest_the_prototype():
    structure = from_scene(pentagon())
    X, wanted = structure.coordinates, prototype(structure)
    own = integral_state(structure, Form(X, wanted, 0.0), np.arange(10))
    assert own is not None
    rho_t = np.zeros((5, 10))
    rho_t[structure.start, np.arange(10)], rho_t[structure.end, np.arange(10)] = -1.0, 1.0
    assert np.abs(force_density_matrix(rho_t, own.q) @ X).max() < 1e-12
    U = np.vstack([rho_t * (axis @ rho_t) for axis in X.T])
    nearest = wanted - np.linalg.pinv(U) @ (U @ wanted)
    assert own.q / np.linalg.norm(own.q) == pytest.approx(nearest / np.linalg.norm(nearest), abs=1e-12)


def test_a_null_space_of_a_wide_matrix_has_all_its_vectors():
    basis = null_space(np.array([[1.0, 1.0, 0.0, 0.0], [2.0, 2.0, 0.0, 0.0]]))
    assert basis.shape == (4, 3)
    assert basis.T @ basis == pytest.approx(np.eye(3), abs=1e-14)
    assert np.abs(basis[0] + basis[1]).max() < 1e-14


def test_where_the_first_stage_comes_to_nothing_it_says_so():
    nodes = {"a": [0, 0], "b": [1, 0], "c": [0, 1]}
    group = {"kind": "cable", "EA": 1, "rest_length": 1, "pairs": [["a", "b"], ["b", "c"], ["c", "a"]]}
    slack = found(from_dict({"law": "hooke", "nodes": nodes, "elements": {"sides": group}}))
    assert (slack.verdict, slack.nodes) == ("failed", None)
    assert "of the rank of D left after" in slack.message
    held = found(cgff_cli.load(STRUCTURES / "cable-net.yaml"))
    assert held.message == "it knows no supports: its forms are free bodies"
