"""U, D and the residual: eq. (3), (4), (8), (9)."""

import numpy as np
import pytest

from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.equilibrium import equilibrium_matrix, force_density_matrix
from tests.bodies import forces_by_loop, random_body
from tests.states import by_node, state_of

SEEDS = range(6)


def rho_of(structure):
    return dense(structure.start, structure.end, len(structure.coordinates)).T


@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("seed", SEEDS)
def test_u_is_the_papers_axis_by_axis(seed, d):
    structure = random_body(seed, d)
    rho = rho_of(structure)
    papers = np.concatenate([rho.T @ np.diag(rho @ x) for x in structure.coordinates.T])  # eq. (3)
    assert equilibrium_matrix(rho.T, structure.coordinates.T @ rho.T) == pytest.approx(papers, abs=1e-15)


@pytest.mark.parametrize("seed", SEEDS)
def test_d_times_the_coordinates_is_u_times_the_force_densities(seed):
    structure = random_body(seed)
    state, rho, X = state_of(structure), rho_of(structure), structure.coordinates
    D, U = force_density_matrix(rho.T, state.q), equilibrium_matrix(rho.T, state.V)
    assert (U @ state.q).reshape(3, -1) == pytest.approx((D @ X).T, abs=1e-13)
    assert state.pull() == pytest.approx(D @ X, abs=1e-13)
    assert pytest.approx(D.T, abs=1e-15) == D
    assert D.sum(axis=1) == pytest.approx(np.zeros(len(D)), abs=1e-13)


@pytest.mark.parametrize("law", ["paper", "hooke"])
@pytest.mark.parametrize("d", [2, 3])
@pytest.mark.parametrize("seed", SEEDS)
def test_the_residual_is_that_of_a_loop_over_the_elements(seed, d, law):
    structure = random_body(seed, d, law=law)
    state = state_of(structure)
    assert state.slack.any()
    eta = forces_by_loop(structure, structure.coordinates)
    assert structure.loads - state.pull() == pytest.approx(eta, abs=1e-14)
    assert not structure.free.all()
    assert -by_node(state.mechanics, state.g) == pytest.approx(np.where(structure.free, eta, 0.0), abs=1e-14)
