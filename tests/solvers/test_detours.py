"""Narrow valleys: a stiff element that has far to swing, and cables that hardly carry anything."""

import numpy as np
import pytest

import cgff_cli
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.cgff import form_find
from cgff_cli.solvers.continuation import mixed, stages
from cgff_cli.solvers.line_search import HUNDREDFOLD
from cgff_cli.solvers.preconditioners import tangent
from cgff_cli.solvers.run import Run
from cgff_cli.structure import from_scene
from tests.bodies import body


def pendulum(load):
    return body([[0, 0], [1, 0.1]], [(0, 1, "cable", 1.0, 1.0)], {0: "xy"}, {1: (0.0, -load)})


@pytest.mark.parametrize("load", [1e-3, 1e-6, 1e-8, 1e-10, 1e-12])
def test_a_pendulum_hangs_down_however_light_its_weight(load):
    found = form_find(pendulum(load), SolveOptions())
    assert found.verdict.converged
    assert found.iterations < 60
    assert found.coordinates[1] == pytest.approx([0.0, -1.0 - load], abs=1e-6)


def stiff_and_soft_links():
    points = [[0.5 * row, 0.0] for row in range(13)]
    bars = [(row, row + 1, "cable", 1e8 if row % 2 else 1.0, 0.55) for row in range(12)]
    return body(points, bars, {0: "xy", 12: "xy"}, dict.fromkeys(range(1, 12), (0.0, -0.1)))


def test_stiff_and_soft_links_in_turn_hang_in_balance():
    found = form_find(stiff_and_soft_links(), SolveOptions())
    assert found.verdict.converged
    assert found.iterations < 200
    stiff = np.array([row % 2 == 1 for row in range(12)])
    assert found.lengths[stiff] == pytest.approx(np.full(6, 0.55), abs=1e-6)


@pytest.mark.parametrize("structure", [pendulum(1e-8), stiff_and_soft_links()])
def test_detours_count_as_iterations_and_stand_in_the_history(structure):
    whole = form_find(structure, SolveOptions())
    for most in range(whole.iterations + 1):
        found = form_find(structure, SolveOptions(max_iterations=most))
        assert found.iterations == most
        assert found.verdict.converged <= (most == whole.iterations)
        assert found.history["iteration"] == list(range(most + 1))
        assert found.history["residual_max"][-1] == found.residual_max
        assert found.history["evaluations"][-1] <= found.evaluations
        assert np.all(np.diff(found.history["evaluations"]) >= 0)


def test_stages_go_from_soft_to_stiff_and_leave_soft_elements_alone():
    structure = body([[0, 0], [1, 0], [2, 0]], [(0, 1, "strut", 1.0, 1.0), (1, 2, "strut", 1e6, 1.0)])
    softer = [stage.stiffness for stage in stages(structure)]
    assert [float(k[1]) for k in softer] == pytest.approx([1.0, HUNDREDFOLD, HUNDREDFOLD**2], rel=0.02)
    assert softer[-1][0] == pytest.approx(1.0, rel=1e-3)


def test_a_structure_of_one_stiffness_and_no_load_needs_no_detour():
    square = body([[0, 0], [1, 0], [1, 1]], [(0, 1, "strut", 2.0, 1.0), (1, 2, "strut", 2.0, 1.0)])
    assert list(stages(square)) == []


def mixed_from_the_start(structure) -> tuple[Run, bool]:
    """Return a run after mixed steps from its start, and whether they end at a minimum."""
    mechanics = Mechanics(structure)
    run = Run(mechanics, SolveOptions(), mechanics.at(mechanics.start))
    way = mixed(run, tangent(mechanics, False, "superlu"))
    while True:
        try:
            next(way)
        except StopIteration as end:
            return run, end.value


@pytest.mark.parametrize("prestress", [10.0, 0.1, 1e-3, 1e-5])
def test_forces_as_unknowns_find_a_net_however_little_it_is_strained(prestress):
    net = from_scene(cgff_cli.new("net", side=12, prestress=prestress, jitter=0.01, seed=2))
    run, is_minimum = mixed_from_the_start(net)
    assert is_minimum
    assert run.evaluations < 45
    assert np.abs(run.state.g).max() <= 1e-5 * run.state.t.max()


def test_they_find_which_of_two_crossed_cables_is_slack():
    # A braced panel pushed sideways: one diagonal carries, the other is slack.
    points = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
    bars = [(0, 3, "strut", 50.0, 1.0), (1, 2, "strut", 50.0, 1.0), (3, 2, "strut", 50.0, 1.0)]
    bars += [(0, 2, "cable", 10.0, 2.0**0.5), (1, 3, "cable", 10.0, 2.0**0.5)]
    run, is_minimum = mixed_from_the_start(body(points, bars, {0: "xy", 1: "xy"}, {3: (1.0, 0.0)}))
    assert is_minimum
    assert run.state.slack.tolist() == [False] * 4 + [True]


def test_a_saddle_is_no_answer():
    upright = body([[0.0, 0.0], [0.0, 0.999]], [(0, 1, "strut", 100.0, 1.0)], {0: "xy"}, {1: (0.0, -0.1)})
    run, is_minimum = mixed_from_the_start(upright)
    assert run.state.X[1, 0] < 0.0 if is_minimum else run.state.X is run.mechanics.start
