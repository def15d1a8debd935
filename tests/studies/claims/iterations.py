"""Iterations until eps = 1e-1 ... 1e-8: Table I by its own test, CGFF by the forces; and what Table I leaves.

Table I runs from each structure's own start and from random ones, for every first step alpha and step
factor b of the grid, with cables that go slack and with cables that push. Residuals are the largest
out-of-balance force component over the largest element force.
"""

import statistics
from dataclasses import replace
from typing import Any

import numpy as np

from cgff_cli.options import SolveOptions
from cgff_cli.solvers import cgff
from cgff_cli.solvers.descent import iterates
from cgff_cli.solvers.rescues import onward
from cgff_cli.solvers.run import Iterate
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.solvers.table1 import TableOne
from cgff_cli.structure import Structure
from tests.studies.claims.cases import LAWS, NAMES, all_starts, relative_residual, structure_of

EPS = [float(f"1e-{k}") for k in range(1, 9)]
PAPER = {"x-module": 10, "hexagon": 10, "prism": 12}
GRID = [(alpha, b) for alpha in (1.0, 1e-1, 1e-2, 1e-3) for b in (0.1, 0.3, 0.5, 0.7, 0.9)]
BALANCED = 1e-6
LIMIT = 20_000


def measure(count: int) -> dict[str, Any]:
    """Return what Table I and CGFF do from `count` random starts and the scene's own."""
    return {
        "settings": len(GRID),
        "table1": {name: {law: many_runs(name, law, count) for law in LAWS} for name in NAMES},
        "table1_own_start": {name: false_stop(name) for name in NAMES},
        "cgff": {name: {kind: ours(name, kind, count) for kind in ("energy", "residual")} for name in NAMES},
    }


def many_runs(name: str, law: str, count: int) -> dict[str, Any]:
    """Return counts over all starts and settings."""
    structure = structure_of(name, law)
    runs = [
        one_run(replace(structure, coordinates=X), alpha, b)
        for X in all_starts(name, count)
        for alpha, b in GRID
    ]
    stopped = [run for run in runs if run["stopped"]]
    at_last = [run["by_eps"][-1][0] for run in stopped]
    like_the_paper = [run for run in stopped if abs(run["by_eps"][-1][0] - PAPER[name]) <= 2]
    return {
        "runs": len(runs),
        "stopped": len(stopped),
        "balanced": sum(run["left"] <= BALANCED for run in stopped),
        "uphill": sum(run["uphill"] for run in stopped),
        "median_residual": statistics.median(run["left"] for run in stopped),
        "least_residual": min(run["left"] for run in stopped),
        "iterations": [int(part) for part in np.percentile(at_last, [0, 25, 50, 75, 100])],
        "like_the_paper": len(like_the_paper),
        "like_the_paper_balanced": sum(run["left"] <= BALANCED for run in like_the_paper),
        "by_eps": [
            {
                "eps": eps,
                "stopped": sum(run["by_eps"][k] is not None for run in runs),
                "median_iterations": statistics.median(
                    run["by_eps"][k][0] for run in runs if run["by_eps"][k]
                ),
                "balanced": sum(run["by_eps"][k][1] <= BALANCED for run in runs if run["by_eps"][k]),
            }
            for k, eps in enumerate(EPS)
        ],
    }


def one_run(structure: Structure, alpha: float, b: float) -> dict[str, Any]:
    """Return how one run of Table I ended, and (iterations, residual) at which it would for each eps."""
    options = SolveOptions(method="table1", alpha=alpha, step_factor=b, eps=EPS[-1], max_iterations=LIMIT)
    run = TableOne(structure, options)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        path = list(run.iterates())
    stopped = run.ending is Verdict.STEP_VANISHED
    ends = [stop_at(eps, np.array([one.move.step_norm for one in path]), stopped) for eps in EPS]
    return {
        "stopped": stopped,
        "left": relative_residual(path[-1].state),
        "iterations": path[-1].number,
        "failed_trials": run.evaluations - path[-1].evaluations,
        "uphill": stopped and slope_at_the_end(path) >= 0.0,
        "by_eps": [None if k is None else (k, relative_residual(path[k].state)) for k in ends],
    }


def stop_at(eps: float, steps: np.ndarray, stopped: bool) -> int | None:
    """Return the iterations after which |alpha d| <= eps ends the run.

    Trials before a step are longer than the step, so the first step that short would not have been taken.
    """
    short = np.flatnonzero(steps[1:] <= eps)
    if len(short):
        return int(short[0])
    return len(steps) - 1 if stopped else None


def slope_at_the_end(path: list[Iterate]) -> float:
    """Return grad f . d for the last direction d = -grad f + beta d, followed from the start."""
    d = np.zeros_like(path[0].state.g)
    for iterate in path:
        d = iterate.move.cg_beta * d - iterate.state.residual_gradient
    return float(np.vdot(path[-1].state.residual_gradient, d))


def false_stop(name: str) -> dict[str, Any]:
    """Return how Table I with alpha = 1, b = 0.5 ends from the scene's own start."""
    run = one_run(structure_of(name), 1.0, 0.5)
    return {key: run[key] for key in ("iterations", "failed_trials", "left", "uphill")}


def ours(name: str, objective: str, count: int) -> dict[str, Any]:
    """Return iterations of CGFF to each residual: from the own start, and median and most of all starts."""
    structure = structure_of(name)
    options = SolveOptions(objective=objective, tolerance=1e-10)
    rows = []
    for X in all_starts(name, count):
        run, _ = cgff.run_of(replace(structure, coordinates=X), options)
        left = np.array([relative_residual(iterate.state) for iterate in iterates(run, onward)])
        rows.append([int(np.argmax(left <= eps)) if (left <= eps).any() else None for eps in EPS])
    reached = [[row[k] for row in rows if row[k] is not None] for k in range(len(EPS))]
    return {
        "own_start": rows[0],
        "runs": len(rows),
        "reached": [len(column) for column in reached],
        "median": [statistics.median(column) for column in reached],
        "most": [max(column) for column in reached],
    }


def show(found: dict[str, Any]) -> None:
    """Print Table I's ends, then iterations by eps."""
    print(
        f"{'Table I':16}{'runs':>6}{'stopped':>8}{'balanced':>9}{'uphill':>7}{'like the paper':>15}"
        f"{'balanced':>9}{'residual median':>16}{'least':>9}  iterations, least to most"
    )
    for name, laws in found["table1"].items():
        for law, one in laws.items():
            print(
                f"{NAMES[name] + ', ' + law:16}{one['runs']:6}{one['stopped']:8}{one['balanced']:9}"
                f"{one['uphill']:7}{one['like_the_paper']:15}{one['like_the_paper_balanced']:9}"
                f"{one['median_residual']:16.1e}{one['least_residual']:9.1e}  {one['iterations']}"
            )
    for name, one in found["table1_own_start"].items():
        print(f"{NAMES[name]}, own start, alpha 1, b 0.5: {one}")
    print(f"\n{'iterations to eps':30}" + "".join(f"{eps:>8.0e}" for eps in EPS))
    for name in NAMES:
        for law, one in found["table1"][name].items():
            _row(f"{NAMES[name]} Table I, {law}, median", [row["median_iterations"] for row in one["by_eps"]])
            _row(f"{NAMES[name]} Table I, {law}, balanced", [row["balanced"] for row in one["by_eps"]])
        for kind, one in found["cgff"][name].items():
            _row(f"{NAMES[name]} {kind}, own start", one["own_start"])
            _row(f"{NAMES[name]} {kind}, median", one["median"])
            _row(f"{NAMES[name]} {kind}, most", one["most"])


def _row(label: str, numbers: list[Any]) -> None:
    print(f"{label:30}" + "".join(f"{'-' if number is None else number:>8}" for number in numbers))
