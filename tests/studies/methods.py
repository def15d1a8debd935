"""The paper's three structures by CGFF on the energy, CGFF on eq. (10), and Table I to the letter.

    python tests/studies/methods.py --count 100 [--off 0.2] [--seed 0]

First each method once from the shipped start. Then from --count starts, the answer with every coordinate
off by up to --off mean lengths: how many runs reached an equilibrium, how many of those are stable,
medians of the work, and the worst and median of what was left. "own test" is what Table I's stopping test,
|alpha d| <= eps, claimed: it ends a run as converged unless the iteration limit does. "true" is whether
the forces of a loop over the elements balance to 1e-9 of the largest.
"""

import argparse
import statistics
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

import cgff_cli

STRUCTURES = Path(__file__).parents[2] / "structures"
SCENES = {"x-module": "Table II", "hexagon": "Table III", "prism": "Table IV"}
METHODS = {
    "cgff, energy": {},
    "cgff, residual": {"objective": "residual"},
    "table1": {"method": "table1", "max_iterations": 20_000},
}
ENDED_BY_LIMIT = ("max_iterations", "diverged", "interrupted")


def claim(result):
    """Return what the method's own stopping test says of the run."""
    if result.options["method"] != "table1":
        return "-"
    return "no" if result.verdict in ENDED_BY_LIMIT else "converged"


def is_balanced(result):
    """Return whether forces added up element by element leave at most 1e-9 of the largest."""
    total = np.zeros(result.coordinates.shape)
    rows = dict(zip(result.source.node_names, range(len(total)), strict=True))
    for element in result.elements:
        i, j = rows[element["start"]], rows[element["end"]]
        V = result.coordinates[j] - result.coordinates[i]
        length = np.linalg.norm(V)
        stretch = length - element["rest_length"]
        if element["kind"] == "cable" and stretch < 0.0:
            continue
        stiffness = element["EA"] / (element["rest_length"] if result.scene["law"] == "hooke" else 1.0)
        total[i] += stiffness * stretch * V / length
        total[j] -= stiffness * stretch * V / length
    return np.abs(total).max() <= 1e-9 * np.abs(result.forces).max()


def print_single_runs() -> None:
    """Print one row per scene and method, from the shipped start."""
    print(
        f"{'scene':20}{'method':16}{'iterations':>11}{'evaluations':>12}  {'verdict':15}"
        f"{'relative residual':>18}  {'stability':10}{'own test':10}{'true':>5}"
    )
    for name, table in SCENES.items():
        for method, options in METHODS.items():
            result = cgff_cli.solve(cgff_cli.load(STRUCTURES / f"{name}.yaml"), **options)
            print(
                f"{name + ', ' + table:20}{method:16}{result.counts['iterations']:11}"
                f"{result.counts['evaluations']:12}  {result.verdict:15}{result.residual['relative']:18.1e}"
                f"  {result.analysis['stability'] or '-':10}{claim(result):10}"
                f"{'yes' if is_balanced(result) else 'no':>5}"
            )


def print_many_runs(count: int, off: float, seed: int) -> None:
    """Print one row per scene and method, over perturbed starts."""
    print(f"\n{count} starts, every coordinate off by up to {off:g} mean lengths")
    print(
        f"{'scene':20}{'method':16}{'converged':>10}{'true':>6}{'stable':>7}{'own test':>9}"
        f"{'iterations':>11}{'evaluations':>12}{'residual':>10}{'worst':>9}  other verdicts"
    )
    for name, table in SCENES.items():
        scene = cgff_cli.load(STRUCTURES / f"{name}.yaml")
        answer = cgff_cli.solve(scene, tolerance=1e-12)
        reach = off * answer.lengths.mean()
        for method, options in METHODS.items():
            results = []
            for run in range(count):
                noise = np.random.default_rng(seed + run).uniform(-reach, reach, answer.coordinates.shape)
                start = replace(scene, coordinates=answer.coordinates + noise)
                results.append(cgff_cli.solve(start, **options))
            print_row(f"{name}, {table}", method, results)


def print_row(label: str, method: str, results: list) -> None:
    """Print how many of the runs did what, and medians."""
    residuals = [result.residual["relative"] for result in results]
    others = Counter(result.verdict for result in results if not result.converged)
    print(
        f"{label:20}{method:16}{sum(result.converged for result in results):10}"
        f"{sum(map(bool, map(is_balanced, results))):6}"
        f"{sum(result.analysis['stable'] is True for result in results):7}"
        f"{sum(claim(result) == 'converged' for result in results) if method == 'table1' else '-':>9}"
        f"{statistics.median(result.counts['iterations'] for result in results):11g}"
        f"{statistics.median(result.counts['evaluations'] for result in results):12g}"
        f"{statistics.median(residuals):10.1e}{max(residuals):9.1e}"
        f"  {', '.join(f'{verdict} {times}' for verdict, times in others.items()) or '-'}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--off", type=float, default=0.2)
    parser.add_argument("--seed", type=int, default=0)
    arguments = parser.parse_args()
    print_single_runs()
    print_many_runs(arguments.count, arguments.off, arguments.seed)


if __name__ == "__main__":
    main()
