"""What the paper stands among: other conjugate gradient rules, a neural network, random moves.

Rules without preconditioner, to 1e-10, from the scenes' own starts. `znn` and `mc`, to 1e-6, from random ones
too; no clock ends them, but their limit of time steps and of evaluations.
"""

import statistics
from dataclasses import replace
from typing import Any

import cgff_cli
from cgff_cli.solvers.directions import RULES
from tests.studies.claims.cases import NAMES, all_starts, scene_of

METHODS = ("znn", "mc")
TOLERANCE, ARRIVED, MOST = 1e-10, 1e-6, 5000
EQUILIBRIA = ("converged", "rounding_floor")


def measure(count: int) -> dict[str, Any]:
    """Return iterations of every rule, and what the methods come to from --count random starts each."""
    return {"rules": {name: rules(name) for name in NAMES}, **{own: methods(own, count) for own in METHODS}}


def rules(name: str) -> dict[str, dict[str, int | None]]:
    """Return objective -> rule -> iterations; None where it did not get there."""
    found: dict[str, dict[str, int | None]] = {}
    for objective in ("energy", "residual"):
        options = {"objective": objective, "preconditioner": "none", "max_iterations": MOST}
        ends = {
            rule: cgff_cli.solve(scene_of(name), cg_beta=rule, tolerance=TOLERANCE, **options)
            for rule in RULES
        }
        found[objective] = {
            rule: end.counts["iterations"] if end.converged else None for rule, end in ends.items()
        }
    return found


def methods(method: str, count: int) -> dict[str, dict[str, Any]]:
    """Return structure -> the own start's end, and how many random starts arrived, and stably."""
    found = {}
    for name in NAMES:
        own, *others = (run(method, name, start) for start in all_starts(name, count))
        arrived = [end for end in others if end.verdict in EQUILIBRIA]
        found[name] = {
            "verdict": own.verdict,
            "stable": own.stable,
            "iterations": own.iterations,
            "random_starts": count,
            "reached": len(arrived),
            "stably": sum(end.stable is True for end in arrived),
            "median_iterations": statistics.median(end.iterations for end in arrived) if arrived else None,
        }
    return found


def run(method: str, name: str, start: Any) -> Any:
    """Return a method's row of a comparison from a start."""
    scene = replace(scene_of(name), coordinates=start)
    return cgff_cli.compare(scene, [method], repeat=1, time_limit=600.0, tolerance=ARRIVED).methods[1]


def show(found: dict[str, Any]) -> None:
    """Print a line per structure and objective, and per method and structure."""
    for name, table in NAMES.items():
        for objective, counts in found["rules"][name].items():
            print(f"{table:5}{objective:10}", "  ".join(f"{rule} {own}" for rule, own in counts.items()))
    for method in METHODS:
        for name, table in NAMES.items():
            row = found[method][name]
            print(
                f"{table:5}{method:5}{row['verdict']:16}{row['iterations']:8}  random starts: "
                f"{row['reached']} of {row['random_starts']}, {row['stably']} stably, "
                f"median {row['median_iterations']}"
            )
