"""Where form-finding ends from perturbed and from fully random starts, checked without our matrices.

    python tests/studies/random_starts.py --count 100 [--scene prism] [--seed 0]

Every answer is put in one row: stable at the closed form, stable elsewhere (energies with counts), not
stable, not converged. "unbalanced" counts converged answers whose nodal forces, added up in a loop,
exceed 1e-9 of the largest force; "not a minimum" counts answers called stable whose second derivatives
of the energy, by complex steps through that loop, have a negative eigenvalue or more zero ones than
there are rigid motions. With --scene only that scene; the last table takes the prism with its cables
able to push.
"""

import argparse
import statistics
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
from by_loop import nodal_forces

import cgff_cli

STRUCTURES = Path(__file__).parents[2] / "structures"
SHIFTS = {"5 % off": 0.05, "20 % off": 0.2, "50 % off": 0.5, "random": None}
CASES = {
    "prism": list(SHIFTS),
    "x-module": ["random"],
    "hexagon": ["random"],
    "octahedron": ["random"],
}
CLOSED_FORMS = {
    "prism": ([3.0] * 6 + [6.213509085] * 3 + [7.0] * 3, [1.732050808] * 6 + [6.213509085] * 3 + [-7.0] * 3),
    "octahedron": ([6.0**0.5] * 24 + [4.0] * 6, [6.0**0.5] * 24 + [-6.0] * 6),
}


def is_balanced(result):
    """Return whether the forces of the loop balance to 1e-9 of the largest."""
    unbalanced = nodal_forces(result.structure, result.coordinates)[result.structure.free]
    largest = np.abs(result.forces).max() or (result.structure.stiffness * result.lengths).max()
    return np.abs(unbalanced).max() <= 1e-9 * largest


def is_minimum(result):
    """Return whether the second derivatives are positive but for the rigid motions."""
    structure, X = result.structure, result.coordinates
    dofs = np.flatnonzero(structure.free)
    columns = []
    for dof in dofs:
        step = np.zeros(X.size, dtype=complex)
        step[dof] = 1e-200j
        moved = nodal_forces(structure, X + step.reshape(X.shape))
        columns.append(-moved.reshape(-1)[dofs].imag / 1e-200)
    values = np.linalg.eigvalsh(np.array(columns))
    rigid = 3 if X.shape[1] == 2 else 6
    zero = 1e-9 * values[-1]
    return values[0] >= -zero and (values <= zero).sum() == rigid


def at_closed_form(name, result, reference) -> bool:
    """Return whether lengths and forces are those of the closed form (of the shipped answer) to 1e-9."""
    lengths, forces = CLOSED_FORMS.get(name, (reference.lengths, reference.forces))
    # The closed forms are printed to nine decimals; rest lengths to twelve or thirteen digits.
    off = max(np.abs(result.lengths - lengths).max(), np.abs(result.forces - forces).max())
    return off <= 1.5e-9


def started(scene, kind: str, seed: int):
    """Return the scene from another start: the shipped answer perturbed, or points in a box."""
    rng = np.random.default_rng(seed)
    reference = cgff_cli.solve(scene, tolerance=1e-12)
    X, share, mean = reference.coordinates, SHIFTS[kind], reference.lengths.mean()
    reach = mean if share is None else share * mean
    noise = rng.uniform(-reach, reach, X.shape)
    return replace(scene, coordinates=noise if share is None else X + noise)


def study(name: str, scene, kinds: list[str], count: int, seed: int, counted_as: Callable) -> None:
    """Print one block per kind of start."""
    reference = cgff_cli.solve(scene, tolerance=1e-12)
    for kind in kinds:
        results = [cgff_cli.solve(started(scene, kind, seed + run), tolerance=1e-11) for run in range(count)]
        found = [result for result in results if result.converged]
        good = [r for r in found if r.analysis["stable"] and counted_as(name, r, reference)]
        elsewhere = Counter(
            (f"{r.energy:.6g}", r.analysis["stability"]) for r in found if not any(r is g for g in good)
        )
        iterations = sorted(r.counts["iterations"] for r in results)
        evaluations = sorted(r.counts["evaluations"] for r in results)
        unbalanced = sum(not is_balanced(r) for r in found)
        wrong = sum(not is_minimum(r) for r in found if r.analysis["stable"])
        missed = Counter(r.verdict for r in results if not r.converged)
        print(
            f"{name:22}{kind:10}{len(good):6}{len(found) - len(good):10}{len(results) - len(found):9}"
            f"{statistics.median(iterations):9g}{iterations[-1]:6}{statistics.median(evaluations):9g}"
            f"{evaluations[-1]:6}{unbalanced:12}{wrong:15}"
        )
        for (energy, stability), times in sorted(elsewhere.items(), key=lambda item: float(item[0][0])):
            print(f"{'':24}elsewhere: energy {energy:>12}  {stability:9} {times:5} times")
        for verdict, times in missed.items():
            print(f"{'':24}not converged: {verdict} {times} times")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--scene", choices=list(CASES))
    arguments = parser.parse_args()
    print(
        f"{'scene':22}{'start':10}{'closed':>6}{'elsewhere':>10}{'missed':>9}{'median':>9}{'most':>6}"
        f"{'median':>9}{'most':>6}{'unbalanced':>12}{'not a minimum':>15}"
    )
    print(f"{'':22}{'':10}{'form':>6}{'':19}{'iterations':>15}{'evaluations':>15}")
    for name in [arguments.scene] if arguments.scene else CASES:
        scene = cgff_cli.load(STRUCTURES / f"{name}.yaml")
        study(name, scene, CASES[name], arguments.count, arguments.seed, at_closed_form)
    if arguments.scene in (None, "prism"):
        scene = cgff_cli.load(STRUCTURES / "prism.yaml")
        pushing = replace(scene, groups=tuple(replace(group, kind="strut") for group in scene.groups))
        study("prism, all may push", pushing, ["random"], arguments.count, arguments.seed, at_closed_form)


if __name__ == "__main__":
    main()
