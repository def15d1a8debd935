"""Lengths, forces, force densities and energy of single elements, by numbers worked out by hand."""

import numpy as np
import pytest

from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import State
from tests.bodies import body
from tests.states import by_node, state_of, tangent


def one(kind: str, rest_length: float, law: str = "paper", end: tuple[float, ...] = (3.0, 4.0)) -> State:
    """Return the state of one element of EA 10 from the origin to `end`, which is 5 away."""
    origin = [0.0] * len(end)
    structure = body([origin, end], [(0, 1, kind, 10.0, rest_length)], law=law)
    return state_of(structure)


@pytest.mark.parametrize("kind", ["cable", "strut"])
@pytest.mark.parametrize(
    ("law", "force", "density", "energy"), [("paper", 10.0, 2.0, 5.0), ("hooke", 2.5, 0.5, 1.25)]
)
def test_a_stretched_element_pulls(law, force, density, energy, kind):
    state = one(kind, 4.0, law)
    assert (state.l[0], state.t[0], state.q[0], state.energy) == (5.0, force, density, energy)
    assert not state.slack[0]


@pytest.mark.parametrize(
    ("law", "force", "density", "energy"), [("paper", -30.0, -6.0, 45.0), ("hooke", -3.75, -0.75, 5.625)]
)
def test_a_shortened_strut_pushes(law, force, density, energy):
    state = one("strut", 8.0, law)
    assert (state.t[0], state.q[0], state.energy) == (force, density, energy)
    assert not state.slack[0]


@pytest.mark.parametrize("law", ["paper", "hooke"])
def test_a_shortened_cable_is_slack_and_has_no_force_energy_or_stiffness(law):
    state = one("cable", 8.0, law)
    assert state.slack[0]
    assert (state.t[0], state.q[0], state.energy) == (0.0, 0.0, 0.0)
    assert not state.g.any()
    assert not state.dense_tangent().any()


def test_a_cable_exactly_at_rest_is_taut_and_has_all_its_stiffness():
    state = one("cable", 5.0)
    assert not state.slack[0]
    assert (state.t[0], state.energy) == (0.0, 0.0)
    assert np.linalg.eigvalsh(state.dense_tangent())[-1] == pytest.approx(20.0)  # k at either end


def test_forces_pull_the_ends_of_a_stretched_element_together():
    state = one("cable", 4.0)
    assert -by_node(state.mechanics, state.g) == pytest.approx(np.array([(6.0, 8.0), (-6.0, -8.0)]))


def test_the_length_in_space():
    assert one("strut", 1.0, end=(2.0, 3.0, 6.0)).l[0] == 7.0


def test_without_rest_length_the_force_density_is_the_stiffness_at_any_length():
    for end in [(3.0, 4.0), (3e-90, 4e-90), (0.0, 0.0)]:
        state = one("cable", 0.0, end=end)
        assert state.q[0] == 10.0
        assert not state.slack[0]
        assert -state.g[:, 0] == pytest.approx(10.0 * np.array(end), rel=1e-15)
        assert tangent(state) == pytest.approx(np.kron([[10, -10], [-10, 10]], np.eye(2)))


@pytest.mark.parametrize("kind", ["cable", "strut"])
def test_at_zero_length_everything_is_finite_and_pushes_nowhere(kind):
    state = one(kind, 2.0, end=(0.0, 0.0))
    assert state.t[0] == (-20.0 if kind == "strut" else 0.0)
    assert state.energy == (20.0 if kind == "strut" else 0.0)
    assert np.isfinite(state.q).all()
    assert np.isfinite(state.dense_tangent()).all()
    assert np.isfinite(state.tangent_times(np.ones((2, 2)))).all()
    assert not state.g.any()


def test_the_two_laws_agree_where_the_rest_length_is_one():
    assert one("strut", 1.0, "paper").t[0] == one("strut", 1.0, "hooke").t[0]


def test_the_energy_includes_the_work_of_the_loads():
    structure = body([(0.0, 0.0), (3.0, 4.0)], [(0, 1, "strut", 10.0, 4.0)], {0: "xy"}, {1: (2.0, -1.0)})
    assert state_of(structure).energy == 5.0 - (2.0 * 3.0 - 1.0 * 4.0)


def test_the_norm_is_euclidean_also_for_matrices():
    assert norm(np.array([3.0, -4.0])) == 5.0
    assert norm(np.array([[1.0, 2.0], [4.0, 2.0]])) == 5.0
