"""Sparse matrices over the nodes hold exactly what the dense ones do."""

import numpy as np
import pytest
from scipy.sparse import csc_array

from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.equilibrium import force_density_matrix
from cgff_cli.mechanics.pattern import GraphPattern, TangentPattern
from tests.bodies import body, random_body
from tests.states import state_of, tangent


def matrix(pattern, data):
    return csc_array((data, pattern.indices, pattern.indptr)).toarray()


def with_parallel_elements():
    points = [[0, 0, 0], [1, 0, 0.2], [0.3, 0.9, 0], [0.2, 0.1, 1]]
    pairs = [(0, 1), (1, 0), (1, 2), (2, 3), (3, 0), (1, 3), (1, 3)]
    bars = [(i, j, "strut", 3.0 + row, 0.9) for row, (i, j) in enumerate(pairs)]
    return body(points, bars, {0: "xyz"})


@pytest.mark.parametrize("structure", [random_body(1), random_body(2, held=False), with_parallel_elements()])
def test_a_graph_pattern_filled_with_force_densities_is_d_over_its_nodes(structure):
    moves = structure.free.all(axis=1)
    rows = np.where(moves, np.cumsum(moves) - 1, -1)
    pattern = GraphPattern(structure.start, structure.end, rows)
    q = np.random.default_rng(0).normal(size=len(structure.start))
    D = force_density_matrix(dense(structure.start, structure.end, len(moves)), q)
    assert matrix(pattern, pattern.fill(q, q, -q)) == pytest.approx(D[np.ix_(moves, moves)], abs=1e-14)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("held", [True, False])
def test_a_tangent_pattern_filled_at_a_state_is_the_dense_tangent(d, held):
    structure = random_body(3, d, held=held)
    state = state_of(structure)
    pattern = TangentPattern(state.mechanics)
    K = matrix(pattern, pattern.fill(*state.parts()[1:], held=7.0))
    free = structure.free[structure.free.any(axis=1)].reshape(-1)
    assert K[np.ix_(free, free)] == pytest.approx(tangent(state), abs=1e-12)
    assert K[~free][:, free] == pytest.approx(np.zeros((int((~free).sum()), int(free.sum()))))
    assert np.diag(K)[~free] == pytest.approx(np.full(int((~free).sum()), 7.0))


def test_parallel_elements_share_a_place_in_the_tangent_too():
    structure = with_parallel_elements()
    state = state_of(structure)
    pattern = TangentPattern(state.mechanics)
    K = matrix(pattern, pattern.fill(*state.parts()[1:]))
    assert tangent(state) == pytest.approx(K, abs=1e-12)
