"""Small random scenes through every way of solving them, answers checked without our matrices.

    python tests/studies/random_scenes.py --count 300 [--first 0]

Two to eight nodes, some flat, collinear or coincident; cables and struts over five decades of EA, some
without rest length, some parallel; supports and loads at random. Warnings of numpy are errors here. Printed
are crashes, answers that are not numbers, converged answers whose forces do not balance in a loop, answers
whose second derivatives by complex steps contradict the stability claimed, and every scene that the
default options do not bring to balance; then how many runs ended how.
"""

import argparse
import warnings
from collections import Counter

import numpy as np
from by_loop import nodal_forces

import cgff_cli
from cgff_cli.scene.scene import Group, Scene

WAYS = {
    "default": {},
    "residual": {"objective": "residual"},
    "no preconditioner": {"preconditioner": "none"},
}
UNBALANCED = 1e-9
SIGNLESS = 1e-7
"""Eigenvalues within this share of the largest are not held against a claim."""


def random_scene(seed: int) -> Scene:
    """Return the scene of a seed."""
    rng = np.random.default_rng(seed)
    d, n = int(rng.integers(2, 4)), int(rng.integers(2, 9))
    X = shaped(rng, rng.uniform(-1.0, 1.0, (n, d)))
    pairs = [(i, i + 1) for i in range(n - 1)]
    pairs += [tuple(rng.choice(n, 2, replace=False)) for _ in range(int(rng.integers(0, 2 * n)))]
    groups = tuple(random_element(rng, row, pair) for row, pair in enumerate(pairs))
    every = "xyz"[:d]
    supports = {0: every}
    for row in range(1, n):
        if rng.random() < 0.25:
            supports[row] = str(rng.choice([*every, every]))
    loads = {
        row: tuple((rng.normal(size=d) * 10.0 ** rng.uniform(-3.0, 3.0)).tolist())
        for row in range(1, n)
        if rng.random() < 0.4
    }
    names = tuple(f"n{row}" for row in range(n))
    return Scene(f"random {seed}", "paper", names, X, groups, supports, loads)


def shaped(rng: np.random.Generator, X: np.ndarray) -> np.ndarray:
    """Return points flat, with coincident ones, on a line, or (three times in six) as they are."""
    n, d = X.shape
    kind = rng.integers(6)
    if kind == 0:
        X[:, -1] = 0.0
    if kind == 1:
        X = np.round(X)
    if kind == 2:
        X[1:] = np.outer(rng.uniform(-1.0, 1.0, n - 1), rng.normal(size=d))
    return X


def random_element(rng: np.random.Generator, row: int, pair: tuple[int, int]) -> Group:
    """Return a group of one element."""
    kind, EA = str(rng.choice(["cable", "strut"])), 10.0 ** rng.uniform(-2.0, 3.0)
    rest = float(rng.choice([0.0, rng.uniform(0.2, 2.0), 1.0]))
    return Group(f"e{row}", kind, np.array([pair]), np.array([EA]), np.array([rest]))


def second_derivatives(structure, X):
    """Return the second derivatives of the energy over the free directions, by complex steps."""
    dofs = np.flatnonzero(structure.free)
    columns = []
    for dof in dofs:
        step = np.zeros(X.size, dtype=complex)
        step[dof] = 1e-200j
        columns.append(-nodal_forces(structure, X + step.reshape(X.shape)).reshape(-1)[dofs].imag / 1e-200)
    return np.array(columns)


def complaints(result) -> list[str]:
    """Return what is wrong with a result."""
    if not np.isfinite(result.coordinates).all():
        return ["not a number"]
    structure, X = result.structure, result.coordinates
    if not result.converged or not (result.lengths > 1e-6).all():
        return []
    found = []
    unbalanced = np.abs(np.where(structure.free, nodal_forces(structure, X), 0.0)).max()
    if unbalanced > UNBALANCED * result.residual["reference_force"]:
        found.append(f"unbalanced by {unbalanced:.1e}")
    values = np.linalg.eigvalsh(second_derivatives(structure, X)) if structure.free.any() else np.zeros(0)
    signless = SIGNLESS * np.abs(values).max(initial=0.0)
    kind = result.analysis["stability"]
    if kind != "unstable" and (values < -signless).any():
        found.append(f"called {kind}, softest {values[0]:.3e} of {values[-1]:.3e}")
    if kind == "unstable" and not (values < -signless).any():
        found.append(f"called unstable, softest {values[0]:.3e} of {values[-1]:.3e}")
    return found


def run(seed: int, name: str, tally: Counter) -> None:
    """Solve one scene one way, print complaints, count how it ended."""
    try:
        result = cgff_cli.solve(random_scene(seed), max_iterations=3000, **WAYS[name])
        found = complaints(result)
    except Exception as error:
        tally[name, "crashed", ""] += 1
        print(f"scene {seed}, {name}: {type(error).__name__}: {error}")
        return
    tally[name, result.verdict, result.analysis["stability"] or ""] += 1
    if name == "default" and not result.converged:
        found.append(result.message)
    for text in found:
        print(f"scene {seed}, {name}: {text}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--first", type=int, default=0)
    arguments = parser.parse_args()
    warnings.simplefilter("error")
    tally: Counter = Counter()
    for seed in range(arguments.first, arguments.first + arguments.count):
        for name in WAYS:
            run(seed, name, tally)
    print(f"\n{'':20}{'verdict':28}{'stability':12}{'runs':>5}")
    for (name, verdict, stability), runs in sorted(tally.items()):
        print(f"{name:20}{verdict:28}{stability:12}{runs:5}")


if __name__ == "__main__":
    main()
