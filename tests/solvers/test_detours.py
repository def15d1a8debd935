"""Narrow valleys: a stiff element that has far to swing under a small load."""

import numpy as np
import pytest

from cgff_cli.options import SolveOptions
from cgff_cli.solvers.cgff import form_find
from cgff_cli.solvers.softening import GROWTH, softened
from tests.bodies import body


def pendulum(load):
    return body([[0, 0], [1, 0.1]], [(0, 1, "cable", 1.0, 1.0)], {0: "xy"}, {1: (0.0, -load)})


@pytest.mark.parametrize("load", [1e-3, 1e-6, 1e-8, 1e-10, 1e-12])
def test_a_pendulum_hangs_down_however_light_its_weight(load):
    found = form_find(pendulum(load), SolveOptions())
    assert found.verdict.converged
    assert found.iterations < 60
    assert found.coordinates[1] == pytest.approx([0.0, -1.0 - load], abs=1e-6)


def test_stiff_and_soft_links_in_turn_hang_in_balance():
    points = [[0.5 * row, 0.0] for row in range(13)]
    bars = [(row, row + 1, "cable", 1e8 if row % 2 else 1.0, 0.55) for row in range(12)]
    loads = dict.fromkeys(range(1, 12), (0.0, -0.1))
    found = form_find(body(points, bars, {0: "xy", 12: "xy"}, loads), SolveOptions())
    assert found.verdict.converged
    assert found.iterations < 200
    stiff = np.array([row % 2 == 1 for row in range(12)])
    assert found.state.l[stiff] == pytest.approx(np.full(6, 0.55), abs=1e-6)


def test_stages_go_from_soft_to_stiff_and_leave_soft_elements_alone():
    structure = body([[0, 0], [1, 0], [2, 0]], [(0, 1, "strut", 1.0, 1.0), (1, 2, "strut", 1e6, 1.0)])
    stages = [stage.stiffness for stage in softened(structure)]
    assert [float(k[1]) for k in stages] == pytest.approx([1.0, GROWTH, GROWTH**2], rel=0.02)
    assert stages[-1][0] == pytest.approx(1.0, rel=1e-3)


def test_a_structure_of_one_stiffness_and_no_load_needs_no_detour():
    square = body([[0, 0], [1, 0], [1, 1]], [(0, 1, "strut", 2.0, 1.0), (1, 2, "strut", 2.0, 1.0)])
    assert list(softened(square)) == []
