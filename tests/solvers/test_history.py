"""The history: its columns agree with each other, with the counts, and with what an observer saw."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

import cgff_cli
from tests.shapes import STRUCTURES
from tests.solvers.scenes import SHIPPED, shipped

CONFIGURATIONS = [
    {},
    {"objective": "residual"},
    {"preconditioner": "none"},
    {"preconditioner": "none", "objective": "residual", "cg_beta": "PR+"},
    {"method": "table1"},
]
ids = [" ".join(map(str, options.values())) or "default" for options in CONFIGURATIONS]
every_way = pytest.mark.parametrize("options", CONFIGURATIONS, ids=ids)


@every_way
@pytest.mark.parametrize("name", SHIPPED)
def test_columns_agree_with_the_counts_and_the_result(name, options):
    result = cgff_cli.solve(shipped(name), **options)
    history, counts = result.history, result.counts
    assert history["iteration"] == list(range(counts["iterations"] + 1))
    assert {len(column) for column in history.values()} == {counts["iterations"] + 1}
    assert history["evaluations"][-1] <= counts["evaluations"]
    assert result.converged is False or history["evaluations"][-1] == counts["evaluations"]
    assert sum(history["restarted"]) == counts["restarts"]
    floor = 4.0 * result.residual["rounding_floor"]
    assert history["residual_max"][-1] == pytest.approx(result.residual["max"], abs=floor)


@every_way
def test_row_zero_is_the_start_and_every_other_row_a_step(options):
    history = cgff_cli.solve(shipped("prism"), **options).history
    zeros = {name: history[name][0] for name in ("step_norm", "alpha", "beta", "restarted")}
    assert zeros == {"step_norm": 0.0, "alpha": 0.0, "beta": 0.0, "restarted": False}
    assert history["evaluations"][0] == 1
    assert min(history["alpha"][1:]) > 0.0
    assert min(history["step_norm"][1:]) > 0.0
    assert (np.diff(history["evaluations"]) >= 1).all()
    assert all(
        beta == 0.0 for beta, again in zip(history["beta"], history["restarted"], strict=True) if again
    )


@every_way
def test_the_objective_falls_from_row_to_row(options):
    result = cgff_cli.solve(shipped("prism"), **options)
    objective = np.array(result.history["objective"])
    assert (np.diff(objective) <= 1e-14 * objective[0]).all()


def test_the_first_and_last_rows_hold_the_energy_of_the_shapes_at_either_end():
    result = cgff_cli.solve(shipped("prism"))
    start = cgff_cli.solve(shipped("prism"), max_iterations=0)
    assert result.history["objective"][0] == pytest.approx(start.energy, rel=1e-13)
    assert result.history["objective"][-1] == pytest.approx(result.energy, rel=1e-10)


@pytest.mark.parametrize("away", [0.0, 1000.0])
def test_loads_do_work_from_the_origin_in_the_history_as_in_the_energy(away: float):
    scene = shipped("bracket")
    result = cgff_cli.solve(scene.with_coordinates(scene.coordinates + away))
    assert result.source.loads
    assert result.history["objective"][-1] == pytest.approx(result.energy, rel=1e-12)


def test_under_the_squared_residual_the_objective_is_half_the_squared_norm():
    result = cgff_cli.solve(shipped("prism"), objective="residual", max_iterations=4)
    assert result.history["objective"][-1] == pytest.approx(result.residual["norm"] ** 2 / 2.0, rel=1e-12)


def test_under_the_energy_the_gradient_is_the_residual():
    result = cgff_cli.solve(shipped("prism"), max_iterations=4)
    assert result.history["gradient_norm"][-1] == pytest.approx(result.residual["norm"], rel=1e-12)


@every_way
def test_an_observer_sees_the_rows_of_the_history(options):
    rows: list[dict] = []
    result = cgff_cli.solve(shipped("prism"), observer=rows.append, **options)
    assert {name: [row[name] for row in rows] for name in result.history} == result.history


@every_way
def test_an_observer_changes_nothing(options):
    watched = cgff_cli.solve(shipped("hexagon"), observer=lambda row: row.clear(), **options)
    assert watched.history == cgff_cli.solve(shipped("hexagon"), **options).history


@every_way
def test_two_runs_agree_to_the_last_bit(options):
    one, other = (cgff_cli.solve(shipped("octahedron"), **options) for _ in range(2))
    assert np.array_equal(one.coordinates, other.coordinates)
    assert one.history == other.history
    assert one.counts == other.counts


def test_two_processes_agree_to_the_last_bit():
    code = (
        "import cgff_cli, json; r = cgff_cli.solve(cgff_cli.load('octahedron.yaml')); "
        "print(json.dumps([r.nodes, r.history, r.analysis]))"
    )
    outputs = []
    for hashes in ("1", "2"):
        environment = {**os.environ, "PYTHONHASHSEED": hashes}
        environment["PYTHONPATH"] = os.pathsep.join(sys.path)
        run = subprocess.run(
            [sys.executable, "-c", code], cwd=STRUCTURES, env=environment, capture_output=True, check=True
        )
        outputs.append(json.loads(run.stdout))
    assert outputs[0] == outputs[1]


def test_a_solve_does_not_touch_its_scene():
    scene = shipped("prism")
    before = scene.coordinates.copy(), [group.rest_length.copy() for group in scene.groups]
    cgff_cli.solve(scene)
    assert np.array_equal(scene.coordinates, before[0])
    for group, rest_length in zip(scene.groups, before[1], strict=True):
        assert np.array_equal(group.rest_length, rest_length)
