"""Weight, pretension and load cases against hand calculations, separate scenes and sums by hand.

    python tests/studies/cases.py [--before PATH] [--repeat 1000]

--before also times the prism, whose scene has none of these keys, beside a program without them.
"""

import argparse
import importlib
import os
import subprocess
import sys
import time
import warnings
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.optimize import fsolve
from versions_in_one import ROOT, Version

sys.path.insert(0, str(ROOT))

import cgff_cli
from cgff_cli.scene.scene import LAWS, Group, Scene
from tests.bodies import forces_by_loop

STRUCTURES = ROOT / "structures"
TIGHT = {"tolerance": 1e-13}
EA, T, LENGTH, HEIGHT = 24000.0, 15.0, 15.0, 12.0
"""Ropes of the mast: axial stiffness, pretension, length; height of its tube."""


def of_guide(name: str) -> Scene:
    """Return a scene of structures/."""
    return cgff_cli.load(str(STRUCTURES / f"{name}.yaml"))


def mast() -> None:
    """Print how far wind moves the mast, against a hand calculation and a root finder on sums by loops.

    By hand: K = sum (EA + T)/l n n' + T/l (1 - n n') over the ropes, less the tube's thrust over its height.
    """
    scene = of_guide("mast")
    along = 1.5 * 0.6**2
    elastic = along * EA / LENGTH
    thrust = 3 * T * HEIGHT / LENGTH + (HEIGHT * 0.1246 + 3 * LENGTH * 0.0118) / 2
    whole = elastic + along * T / LENGTH + (3.0 - along) * T / LENGTH - thrust / HEIGHT
    print(f"mast: {elastic:.2f} per m by hand from EA alone, {whole:.2f} with tension and thrust")
    top = scene.row_of("top")
    dead = cgff_cli.solve(scene.in_case("dead"), **TIGHT)
    for factor in (0.01, 0.1, 1.0, 10.0):
        wind = {
            name: {row: tuple(factor * np.array(own)) for row, own in loads.items()}
            for name, loads in scene.load_cases.items()
        }
        (result,) = cgff_cli.solve_cases(replace(scene, load_cases=wind), ["wind"], **TIGHT)
        moved = float(result.coordinates[top, 0] - dead.coordinates[top, 0])
        gained = float(result.forces[1] - dead.forces[1])
        by_root = root_of(result) - dead.coordinates
        by_hand = 1.5 * factor / whole
        print(
            f"  wind x {factor:<5g} top moves by {1e3 * moved:.5f} mm, by hand {1e3 * by_hand:.5f},"
            f" off by {moved / by_hand - 1:+.1e}, from the root finder {abs(moved - by_root[top, 0]):.1e} m;"
            f" rope gains {gained:.5f}, by hand {(EA + T) / LENGTH * 0.6 * by_hand:.5f}"
        )


def root_of(result: "cgff_cli.Result") -> np.ndarray:
    """Return (n, d) where forces summed element by element vanish, from the start of the result's scene."""
    s = result.structure

    def left_over(x: np.ndarray) -> np.ndarray:
        X = s.coordinates.copy()
        X[s.free] = x
        return forces_by_loop(s, X)[s.free]

    X = s.coordinates.copy()
    with warnings.catch_warnings():  # it says that it can do no better
        warnings.simplefilter("ignore")
        X[s.free] = fsolve(left_over, s.coordinates[s.free], xtol=1e-15)
    return X


def separate() -> Iterator[tuple[str, str, bool, float]]:
    """Yield scene, case, whether a scene of its own gives the same bytes, and how far loads are off sums.

    The scene of its own has forces at nodes alone, no weight, no cases: all of it is summed here.
    """
    for name in ("mast", "roof", "spine", "dome"):
        scene = of_guide(name)
        dead = cgff_cli.solve(scene)
        for result in cgff_cli.solve_cases(scene, scene.cases):
            case = result.source.case
            by_hand = hand_sum(scene, case)
            names = scene.node_names
            bare = replace(
                scene.with_coordinates(dead.coordinates),
                groups=tuple(replace(own, weight=None, pretension=None) for own in scene.groups),
                load_cases={},
                combinations={},
            )
            as_solved = {
                names[row]: own for row, own in enumerate(result.structure.loads.tolist()) if any(own)
            }
            alone = cgff_cli.solve(bare.with_loads(as_solved))
            same = alone.coordinates.tobytes() == result.coordinates.tobytes()
            off = np.abs(result.structure.loads - by_hand).max() / np.abs(by_hand).max()
            yield name, case, same, float(off)


def hand_sum(scene: Scene, case: str) -> np.ndarray:
    """Return (n, d) forces of a case: factors times cases, loads, and half of each weight at either end."""
    factors = {"dead": 1.0, case: 1.0} if case in scene.load_cases else scene.combinations[case]
    total = np.zeros_like(scene.coordinates)
    for part, factor in factors.items():
        for row, force in (scene.loads if part == "dead" else scene.load_cases[part]).items():
            for axis, own in enumerate(force):
                total[row, axis] += factor * own
    for group in scene.groups:
        for (a, b), rest, weight in zip(
            group.pairs.tolist(),
            group.rest_length.tolist(),
            (group.weight if group.weight is not None else np.zeros_like(group.EA)).tolist(),
            strict=True,
        ):
            for end in (a, b):
                total[end, -1] -= factors.get("dead", 0.0) * weight * rest / 2
    return total


def pretension(count: int = 500) -> None:
    """Print how far forces at the start are from those asked for, of random structures under both laws.

    EA over nine decades, forces up to a third of EA, or of EA l under law paper; written, read, judged.
    """
    for law in LAWS:
        off, off_by_law, rest = 0.0, 0.0, 0
        for seed in range(count):
            scene, asked, lengths = random_pretension(law, seed)
            read = cgff_cli.loads(cgff_cli.to_yaml(scene))
            found = cgff_cli.solve(read, max_iterations=0, analysis="never").forces
            l0 = np.concatenate([group.rest_length for group in read.groups])
            stiff = read.axial_stiffness / (l0 if law == "hooke" else 1.0)
            # what rounding of a length alone makes of a force
            grain = np.finfo(float).eps * stiff * lengths + np.finfo(float).tiny
            off = max(off, float(np.abs((found - asked) / grain).max()))
            off_by_law = max(off_by_law, float(np.abs((stiff * (lengths - l0) - asked) / grain).max()))
            again = cgff_cli.loads(cgff_cli.to_yaml(read))
            rest += sum(
                own.rest_length.tobytes() == other.rest_length.tobytes()
                for own, other in zip(read.groups, again.groups, strict=True)
            ) == len(read.groups)
        print(
            f"pretension, law {law}: {count} structures, forces off those asked for by at most {off:.1f}"
            f" roundings of a length, by the law alone {off_by_law:.1f};"
            f" rest lengths of {rest} the same to the bit when written and read again"
        )


def random_pretension(law: str, seed: int) -> tuple[Scene, np.ndarray, np.ndarray]:
    """Return a scene of 12 random elements with pretensions, these (b,), and lengths (b,)."""
    rng = np.random.default_rng(seed)
    X = rng.uniform(-1.0, 1.0, (7, 3)) * 10.0 ** rng.uniform(-2, 2)
    others = [(i, j) for i in range(7) for j in range(i + 2, 7)]
    chosen = rng.permutation(len(others))[:6]
    pairs = np.array([*((i, i + 1) for i in range(6)), *(others[row] for row in chosen)])
    pairs = pairs[rng.permutation(12)]
    lengths = np.linalg.norm(X[pairs[:, 0]] - X[pairs[:, 1]], axis=1)
    stiffness = 10.0 ** rng.uniform(-3, 6, 12)
    share = 10.0 ** rng.uniform(-6, np.log10(1 / 3), 12)
    kinds = np.where(np.arange(12) < 6, "cable", "strut")
    asked = np.where(kinds == "cable", 1.0, -1.0) * share * stiffness * (1.0 if law == "hooke" else lengths)
    rest = lengths / (1.0 + asked / stiffness) if law == "hooke" else lengths - asked / stiffness
    groups = tuple(
        Group(kind, kind, pairs[kinds == kind], *(own[kinds == kind] for own in (stiffness, rest, asked)))
        for kind in ("cable", "strut")
    )
    return Scene("random", law, tuple(f"n{row}" for row in range(7)), X, groups), asked, lengths


def prism(before: Path, repeat: int) -> None:
    """Print the processor time of reading and solving the prism, now over before, in turn in one process."""

    versions = [Version(before), Version(ROOT)]
    parts: dict[str, list[list[float]]] = {"read": [[], []], "solve": [[], []]}
    calls = []
    for version in versions:
        with version:
            own = importlib.import_module("cgff_cli")
            calls.append((own.load, own.solve))
            own.solve(own.load(str(STRUCTURES / "prism.yaml")))
    for turn in range(repeat):
        for which in (0, 1) if turn % 2 else (1, 0):
            load, solve = calls[which]
            with versions[which]:
                begin = time.process_time()
                scene = load(str(STRUCTURES / "prism.yaml"))
                middle = time.process_time()
                solve(scene)
                end = time.process_time()
            parts["read"][which].append(middle - begin)
            parts["solve"][which].append(end - middle)
    both = [np.add(parts["read"][which], parts["solve"][which]) for which in (0, 1)]
    for name, (old, new) in {**parts, "both": both}.items():
        ratios = np.array(new) / np.array(old)
        least = [1e3 * np.quantile(own, 0.1) for own in (old, new)]
        print(
            f"prism, {name}: {least[0]:.3f} ms before, {least[1]:.3f} ms now (first decile),"
            f" ratio {least[1] / least[0]:.3f}, median of ratios {np.median(ratios):.3f}"
        )


def command(before: Path, repeat: int) -> None:
    """Print the processor time of `cgff solve prism.yaml` as a whole, now over before, in turn."""
    took: list[list[float]] = [[], []]
    line = [sys.executable, "-m", "cgff_cli", "solve", str(STRUCTURES / "prism.yaml")]
    for turn in range(repeat):
        for which in (0, 1) if turn % 2 else (1, 0):
            environment = {**os.environ, "PYTHONPATH": str((before.resolve(), ROOT)[which])}
            begin = os.times()
            subprocess.run(line, env=environment, cwd="/", stdout=subprocess.DEVNULL, check=True)
            end = os.times()
            took[which].append(
                end.children_user + end.children_system - begin.children_user - begin.children_system
            )
    ratios = np.array(took[1]) / np.array(took[0])
    medians = [1e3 * np.median(own) for own in took]
    print(
        f"prism, whole command: {medians[0]:.0f} ms before, {medians[1]:.0f} ms now,"
        f" median of ratios {np.median(ratios):.3f}, {np.mean(took[1]) / np.mean(took[0]):.3f} of means"
    )


def main() -> None:
    """Run all, the prism where there is a program to compare with."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--before", type=Path, help="root of a checkout without weight and cases")
    parser.add_argument("--repeat", type=int, default=1000)
    asked = parser.parse_args()
    mast()
    for name, case, same, off in separate():
        word = "the same bytes as" if same else "NOT the same bytes as"
        print(
            f"{name}, {case}: {word} a scene of its own; loads off sums by hand by {off:.1e} of the largest"
        )
    pretension()
    if asked.before:
        prism(asked.before, asked.repeat)
        command(asked.before, asked.repeat // 10)


if __name__ == "__main__":
    main()
