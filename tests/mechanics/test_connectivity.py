"""The connectivity matrix, eq. (1), and what an element's direction may change."""

import numpy as np
import pytest

from cgff_cli.mechanics import connectivity as module
from cgff_cli.mechanics.connectivity import Connectivity
from cgff_cli.mechanics.equilibrium import equilibrium_matrix, force_density_matrix
from cgff_cli.mechanics.state import Mechanics
from tests.bodies import body, random_body

START, END = np.array([0, 2, 1]), np.array([1, 1, 3])
X = np.array([[0.0, 0.0], [3.0, 4.0], [1.0, 1.0], [3.0, 6.0]])


def test_rho_is_plus_one_at_the_begin_node_and_minus_one_at_the_end_node():
    assert Connectivity(START, END, 4).dense.tolist() == [[1, -1, 0, 0], [0, -1, 1, 0], [0, 1, 0, -1]]


def test_element_vectors_run_from_end_to_begin():
    assert Connectivity(START, END, 4).differences(X).tolist() == [[-3, -4], [-2, -3], [0, -2]]


def test_gathering_adds_at_begin_and_subtracts_at_end():
    vectors = np.array([[1.0, 2.0], [10.0, 20.0], [100.0, 200.0]])
    assert Connectivity(START, END, 4).gather(vectors).tolist() == [
        [1, 2],
        [89, 178],
        [10, 20],
        [-100, -200],
    ]


def test_parallel_elements_are_gathered_each():
    twice = Connectivity(np.array([0, 0]), np.array([1, 1]), 2)
    assert twice.gather(np.array([[1.0, 0.0], [2.0, 0.0]])).tolist() == [[3, 0], [-3, 0]]


@pytest.mark.parametrize("seed", range(5))
def test_u_and_d_do_not_change_with_an_elements_direction_but_element_vectors_do(seed):
    structure = random_body(seed)
    flip = np.random.default_rng(seed).random(len(structure.start)) < 0.5
    assert flip.any()
    here = Connectivity(structure.start, structure.end, 6)
    turned = Connectivity(
        np.where(flip, structure.end, structure.start), np.where(flip, structure.start, structure.end), 6
    )
    q = np.random.default_rng(seed + 1).normal(size=len(flip))
    V, W = here.differences(structure.coordinates), turned.differences(structure.coordinates)
    assert np.array_equal(W, np.where(flip[:, None], -V, V))
    assert np.array_equal(equilibrium_matrix(turned.dense, W), equilibrium_matrix(here.dense, V))
    assert np.array_equal(force_density_matrix(turned.dense, q), force_density_matrix(here.dense, q))


def test_forces_energy_and_tangent_do_not_change_with_an_elements_direction():
    bars = [(0, 1, "cable", 10.0, 4.0), (1, 2, "strut", 7.0, 3.5), (2, 0, "cable", 3.0, 9.0)]
    points = [(0.0, 0.0), (3.0, 4.0), (6.0, 1.0)]
    here = Mechanics(body(points, bars))
    turned = Mechanics(body(points, [(j, i, *rest) for i, j, *rest in bars]))
    one, other = here.at(here.structure.coordinates), turned.at(turned.structure.coordinates)
    assert np.array_equal(other.eta, one.eta)
    assert np.array_equal(other.t, one.t)
    assert other.energy == one.energy
    assert np.array_equal(other.dense_tangent(), one.dense_tangent())


@pytest.mark.parametrize("d", [2, 3])
def test_the_indexed_path_of_large_structures_agrees_with_the_dense_one(monkeypatch, d):
    structure = random_body(3, d, nodes=40, bars=120)
    results = []
    for entries in (10**9, 0):
        monkeypatch.setattr(module, "DENSE_ENTRIES", entries)
        mechanics = Mechanics(structure)
        assert mechanics.connectivity.is_small == (entries > 0)
        state = mechanics.at(structure.coordinates)
        W = np.random.default_rng(1).normal(size=structure.coordinates.shape)
        results.append((state.V, state.eta, state.energy, state.tangent_times(W)))
    for small, large in zip(*results, strict=True):
        assert large == pytest.approx(small, rel=1e-13, abs=1e-13)
