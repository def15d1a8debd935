"""The gradient of the energy is -eta and its second derivative K: by Taylor slopes, loops, complex steps."""

import numpy as np
import pytest

from tests.bodies import (
    Structure,
    energy_by_loop,
    exact,
    random_body,
    tangent_by_complex_steps,
)
from tests.states import by_node, state_of, tangent

CASES = [
    pytest.param({"d": d, "kinds": kinds, "held": held, "law": law}, id=f"{d}-D, {law}, {what}, {where}")
    for d in (2, 3)
    for law in ("paper", "hooke")
    for kinds, what in ((("strut",), "struts"), (("cable", "strut"), "with slack"))
    for held, where in ((False, "free"), (True, "held"))
]
STEPS = [2.0**-n for n in range(7, 11)]


def free_direction(structure: Structure, seed: int) -> np.ndarray:
    d = np.random.default_rng(seed).uniform(-1.0, 1.0, structure.coordinates.shape)
    return np.where(structure.free, d, 0.0)[structure.free.any(axis=1)].T


def slopes(remainders: list[float]) -> np.ndarray:
    """Return by how many powers of two each remainder falls when the step is halved."""
    return -np.diff(np.log2(np.abs(remainders)))


@pytest.mark.parametrize("case", CASES)
def test_energy_remainders_fall_with_slope_two_after_the_gradient_and_three_after_the_tangent(case):
    structure = random_body(11, **case)
    state, d = state_of(structure), free_direction(structure, 2)
    assert state.slack.any() == ("cable" in case["kinds"])
    first = np.vdot(state.g, d)
    second = np.vdot(d, state.tangent_times(d))
    changes = [state.mechanics.at(state.X + h * d).energy - state.energy for h in STEPS]
    after_gradient = [c - h * first for c, h in zip(changes, STEPS, strict=True)]
    after_tangent = [r - h * h * second / 2 for r, h in zip(after_gradient, STEPS, strict=True)]
    assert slopes(after_gradient) == pytest.approx(2.0, abs=0.1)
    assert slopes(after_tangent) == pytest.approx(3.0, abs=0.2)


@pytest.mark.parametrize("case", CASES)
def test_force_remainders_fall_with_slope_two_after_the_tangent(case):
    structure = random_body(12, **case)
    state, d = state_of(structure), free_direction(structure, 3)
    Kd = state.tangent_times(d)
    remainders = [np.linalg.norm(state.mechanics.at(state.X + h * d).g - state.g - h * Kd) for h in STEPS]
    assert slopes(remainders) == pytest.approx(2.0, abs=0.1)


@pytest.mark.parametrize("case", CASES)
def test_the_energy_is_that_of_a_loop_in_forty_digits(case):
    structure = random_body(13, **case)
    state = state_of(structure)
    assert state.energy == pytest.approx(
        float(energy_by_loop(structure, exact(structure.coordinates))), rel=1e-13
    )


@pytest.mark.parametrize("case", CASES)
def test_the_dense_tangent_is_that_of_complex_steps_through_a_loop(case):
    structure = random_body(14, **case)
    expected = tangent_by_complex_steps(structure, structure.coordinates)
    K = tangent(state_of(structure))
    assert K.shape == (structure.free.sum(),) * 2
    assert pytest.approx(expected, abs=1e-13 * np.abs(expected).max()) == K


@pytest.mark.parametrize("case", CASES)
def test_the_tangent_is_symmetric_and_times_a_vector_is_the_dense_one_times_it(case):
    structure = random_body(15, **case)
    state, W = state_of(structure), free_direction(structure, 4)
    K = tangent(state)
    assert pytest.approx(K.T, abs=1e-14 * np.abs(K).max()) == K
    product, W = by_node(state.mechanics, state.tangent_times(W)), by_node(state.mechanics, W)
    assert not product[~structure.free].any()
    assert product[structure.free] == pytest.approx(K @ W[structure.free], abs=1e-13 * np.abs(K).max())


def test_slack_cables_and_stress_both_count_in_the_tangent():
    structure = random_body(16)
    state = state_of(structure)
    none, all_of_it = tangent(state, q=np.zeros(len(state.q))), tangent(state)
    assert np.abs(none - all_of_it).max() > 0.1
    assert np.linalg.eigvalsh(none)[0] > -1e-12  # elastic stiffness alone pushes nothing away


def test_a_dense_tangent_is_a_fresh_matrix_each_time():
    state = state_of(random_body(17))
    K = state.dense_tangent()
    K[:] = 0.0
    assert state.dense_tangent().any()
