"""The connectivity matrix, eq. (1), and what an element's direction may change."""

import numpy as np
import pytest

from cgff_cli.mechanics import connectivity as module
from cgff_cli.mechanics.connectivity import DenseConnectivity, SparseConnectivity, dense
from cgff_cli.mechanics.equilibrium import equilibrium_matrix, force_density_matrix
from tests.bodies import body, random_body
from tests.states import mechanics_of, state_of

START, END = np.array([0, 2, 1]), np.array([1, 1, 3])
X = np.array([[0.0, 0.0], [3.0, 4.0], [1.0, 1.0], [3.0, 6.0]]).T
either = pytest.mark.parametrize("kind", [DenseConnectivity, SparseConnectivity])


def test_rho_is_plus_one_at_the_begin_node_and_minus_one_at_the_end_node():
    assert dense(START, END, 4).T.tolist() == [[1, -1, 0, 0], [0, -1, 1, 0], [0, 1, 0, -1]]


@either
def test_element_vectors_run_from_end_to_begin(kind):
    assert kind(START, END, X, None).differences(X).T.tolist() == [[-3, -4], [-2, -3], [0, -2]]


@either
def test_gathering_adds_at_begin_and_subtracts_at_end(kind):
    vectors = np.array([[1.0, 2.0], [10.0, 20.0], [100.0, 200.0]]).T
    gathered = kind(START, END, X, None).gather(vectors)
    assert gathered.T.tolist() == [[1, 2], [89, 178], [10, 20], [-100, -200]]


@either
def test_parallel_elements_are_gathered_each(kind):
    twice = kind(np.array([0, 0]), np.array([1, 1]), X[:, :2], None)
    assert twice.gather(np.array([[1.0, 0.0], [2.0, 0.0]]).T).T.tolist() == [[3, 0], [-3, 0]]


@either
def test_what_nodes_add_that_do_not_move_stands_apart(kind):
    moves = np.array([True, False, True, False])
    part, whole = kind(START, END, X, moves), kind(START, END, X, None)
    assert part.differences(X[:, moves]) + part.fixed == pytest.approx(whole.differences(X))
    V = np.random.default_rng(0).normal(size=(2, 3))
    assert part.gather(V) == pytest.approx(whole.gather(V)[:, moves])


@pytest.mark.parametrize("seed", range(5))
def test_u_and_d_do_not_change_with_an_elements_direction_but_element_vectors_do(seed):
    structure = random_body(seed)
    flip = np.random.default_rng(seed).random(len(structure.start)) < 0.5
    assert flip.any()
    here = dense(structure.start, structure.end, 6)
    turned = np.where(flip, -here, here)
    q = np.random.default_rng(seed + 1).normal(size=len(flip))
    V, W = structure.coordinates.T @ here, structure.coordinates.T @ turned
    assert np.array_equal(W, np.where(flip, -V, V))
    assert np.array_equal(equilibrium_matrix(turned, W), equilibrium_matrix(here, V))
    assert np.array_equal(force_density_matrix(turned, q), force_density_matrix(here, q))


def test_forces_energy_and_tangent_do_not_change_with_an_elements_direction():
    bars = [(0, 1, "cable", 10.0, 4.0), (1, 2, "strut", 7.0, 3.5), (2, 0, "cable", 3.0, 9.0)]
    points = [(0.0, 0.0), (3.0, 4.0), (6.0, 1.0)]
    one = state_of(body(points, bars))
    other = state_of(body(points, [(j, i, *rest) for i, j, *rest in bars]))
    assert np.array_equal(other.g, one.g)
    assert np.array_equal(other.t, one.t)
    assert other.energy == one.energy
    assert np.array_equal(other.dense_tangent(), one.dense_tangent())


@pytest.mark.parametrize("d", [2, 3])
def test_the_sparse_path_of_large_structures_agrees_with_the_dense_one(monkeypatch, d):
    structure = random_body(3, d, nodes=40, bars=120)
    results = []
    for entries in (10**9, 0):
        monkeypatch.setattr(module, "DENSE_ENTRIES", entries)
        mechanics = mechanics_of(structure)
        assert mechanics.is_small == (entries > 0)
        state = mechanics.at(mechanics.start)
        Y = np.random.default_rng(1).normal(size=state.X.shape)
        results.append((state.V, state.g, state.energy, state.tangent_times(Y)))
    for small, large in zip(*results, strict=True):
        assert large == pytest.approx(small, rel=1e-13, abs=1e-13)
