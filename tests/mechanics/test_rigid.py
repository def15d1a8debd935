"""Rigid motions: how many there are, and that they deform nothing."""

import numpy as np
import pytest

from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.rigid import RigidMotions
from tests.bodies import random_body
from tests.states import state_of

PLANE = np.random.default_rng(1).uniform(-1.0, 1.0, (5, 2))
SPACE = np.random.default_rng(2).uniform(-1.0, 1.0, (5, 3))
LINE_2 = np.outer(np.arange(4.0), (3.0, 4.0)) + 7.0
LINE_3 = np.outer(np.arange(4.0), (1.0, -2.0, 2.0)) + 7.0
FLAT_3 = np.column_stack([PLANE, np.zeros(5)])
POINT = np.ones((3, 3))


def motions(X: np.ndarray, supports: dict[int, str] | None = None) -> tuple[np.ndarray, np.ndarray]:
    free = np.ones(X.shape, dtype=bool)
    for row, axes in (supports or {}).items():
        free[row, ["xyz".index(axis) for axis in axes]] = False
    return RigidMotions(X.T, free.T).basis, free.T


@pytest.mark.parametrize(
    ("X", "supports", "count"),
    [
        pytest.param(PLANE, {}, 3, id="plane"),
        pytest.param(SPACE, {}, 6, id="space"),
        pytest.param(FLAT_3, {}, 6, id="flat in space"),
        pytest.param(LINE_2, {}, 3, id="line in the plane"),
        pytest.param(LINE_3, {}, 5, id="line in space"),
        pytest.param(POINT, {}, 3, id="one point in space"),
        pytest.param(PLANE, {0: "x"}, 2, id="plane, one direction held"),
        pytest.param(PLANE, {0: "xy"}, 1, id="plane, pinned"),
        pytest.param(PLANE, {0: "xy", 1: "y"}, 0, id="plane, pinned and on a roller"),
        pytest.param(SPACE, {0: "xyz"}, 3, id="space, pinned"),
        pytest.param(SPACE, {0: "xyz", 1: "xyz"}, 1, id="space, hinged"),
        pytest.param(SPACE, {0: "xyz", 1: "yz", 2: "z"}, 0, id="space, just held"),
        pytest.param(SPACE, {0: "z", 1: "z", 2: "z"}, 3, id="space, on a table"),
        pytest.param(LINE_3, {0: "xyz"}, 2, id="line in space, pinned"),
        pytest.param(LINE_2, {0: "xy", 3: "xy"}, 0, id="line in the plane, both ends pinned"),
        pytest.param(PLANE, dict.fromkeys(range(5), "xy"), 0, id="everything held"),
    ],
)
def test_how_many_rigid_motions_there_are(X, supports, count):
    R, free = motions(X, supports)
    assert R.shape == (free.sum(), count)
    gram = R.T @ R
    assert gram == pytest.approx(np.eye(count), abs=1e-12)


@pytest.mark.parametrize("factor", [1e-12, 1.0, 1e12])
def test_size_and_place_do_not_change_the_count(factor):
    assert motions(SPACE * factor + 3.0 * factor)[0].shape[1] == 6
    assert motions(LINE_3 * factor)[0].shape[1] == 5


@pytest.mark.parametrize(
    ("d", "supports"), [(2, {}), (3, {}), (2, {1: "xy"}), (3, {1: "xyz"}), (3, {0: "x"})]
)
def test_to_first_order_rigid_motions_change_no_length(d, supports):
    structure = random_body(5, d, held=False, loaded=False)
    R, free = motions(structure.coordinates, supports)
    assert R.shape[1] > 0
    rho_t = dense(structure.start, structure.end, len(structure.coordinates))
    V = structure.coordinates.T @ rho_t
    for column in R.T:
        velocity = np.zeros(free.shape)
        velocity[free] = column
        rates = (V * (velocity @ rho_t)).sum(axis=0)
        assert rates == pytest.approx(np.zeros(len(rates)), abs=1e-14)


def test_without_loads_a_free_body_in_balance_or_not_feels_no_force_along_a_rigid_motion():
    structure = random_body(6, 3, held=False, loaded=False)
    R, _ = motions(structure.coordinates)
    eta = -state_of(structure).g.reshape(-1)
    assert np.abs(eta).max() > 0.1
    assert R.T @ eta == pytest.approx(np.zeros(6), abs=1e-14)


@pytest.mark.parametrize(
    ("supports", "load", "idle"),
    [
        ({}, (0.0, 0.0, 0.0), 6),  # without loads every rigid motion
        ({0: "xyz"}, (0.0, 0.0, 0.0), 3),
        ({0: "xyz"}, (0.0, 0.0, 1e-20), 1),  # but what turns a load, however small: all but about its axis
        ({0: "xyz", 1: "xyz"}, (0.0, 0.0, 1.0), 0),
    ],
)
def test_a_rigid_motion_is_idle_where_it_turns_no_force(supports, load, idle):
    free = np.ones(SPACE.shape, dtype=bool)
    for row, axes in supports.items():
        free[row, ["xyz".index(axis) for axis in axes]] = False
    F = np.zeros(SPACE.shape)
    F[2] = load
    assert RigidMotions(SPACE.T, free.T).idle(F.T, 0.0).shape[1] == idle
