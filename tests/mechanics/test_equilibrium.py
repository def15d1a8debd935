"""U, D and the residual: eq. (3), (4), (8), (9)."""

import numpy as np
import pytest

from cgff_cli.mechanics.equilibrium import equilibrium_matrix, force_density_matrix
from cgff_cli.mechanics.state import Mechanics, State
from tests.bodies import Structure, forces_by_loop, random_body

SEEDS = range(6)


def state_of(structure: Structure) -> State:
    return Mechanics(structure).at(structure.coordinates)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("seed", SEEDS)
def test_the_residual_is_the_load_less_u_q(seed, d):
    state = state_of(random_body(seed, d))
    loads = state.mechanics.structure.loads
    U = equilibrium_matrix(state.mechanics.connectivity.dense, state.V)
    assert state.eta.reshape(-1) == pytest.approx(loads.reshape(-1) - U @ state.q, abs=1e-14)


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("seed", SEEDS)
def test_u_is_the_papers_axis_by_axis_with_its_rows_node_by_node(seed, d):
    state = state_of(random_body(seed, d))
    rho = state.mechanics.connectivity.dense
    papers = np.concatenate([rho.T @ np.diag(rho @ x) for x in state.X.T])  # eq. (3)
    n, b = len(state.X), len(state.q)
    ours = equilibrium_matrix(rho, state.V)
    assert ours.reshape(n, d, b).transpose(1, 0, 2).reshape(n * d, b) == pytest.approx(papers, abs=1e-15)


@pytest.mark.parametrize("seed", SEEDS)
def test_d_times_the_coordinates_is_u_times_the_force_densities(seed):
    state = state_of(random_body(seed))
    rho = state.mechanics.connectivity.dense
    D = force_density_matrix(rho, state.q)
    U = equilibrium_matrix(rho, state.V)
    carried = (U @ state.q).reshape(state.X.shape)
    assert carried == pytest.approx(D @ state.X, abs=1e-13)
    assert np.array_equal(D, D.T)
    assert D.sum(axis=1) == pytest.approx(np.zeros(len(D)), abs=1e-13)


@pytest.mark.parametrize("law", ["paper", "hooke"])
@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("seed", SEEDS)
def test_the_residual_is_that_of_a_loop_over_the_elements(seed, d, law):
    structure = random_body(seed, d, law=law)
    state = state_of(structure)
    assert state.slack.any()
    assert state.eta == pytest.approx(forces_by_loop(structure, structure.coordinates), abs=1e-14)


def test_the_free_residual_leaves_out_what_supports_hold():
    structure = random_body(1)
    state = state_of(structure)
    assert not structure.free.all()
    assert not state.free_eta[~structure.free].any()
    assert np.array_equal(state.free_eta[structure.free], state.eta[structure.free])
    assert state.eta[~structure.free].any()
