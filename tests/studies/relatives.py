"""Every method of `cgff compare` on the same scenes: work to three tolerances, what was found, from where.

    python tests/studies/relatives.py [--quick] [--starts 100] [--time-limit 3] [--patience 300] [--noise]

A method runs once from the scene's start, to 1e-12 and for up to six time limits, and once more from every
one of --starts random starts, to 1e-6 and for up to one. It arrives where it comes to an equilibrium, stable
or not; `least` are those of the least energy that any method found from any start, and `higher` is a stable
one of more. Where a method has taken --patience seconds its other starts are not run, and the cell says of
how many. Cells of work are iterations and milliseconds until the relative residual was within the tolerance.
Methods that take no start, or are told the answer, have no random ones. Times are of this machine.

With --noise instead how `znn` bears a constant force on every free coordinate, in units of the frame, with
its integral and without: the relative residual it came to, after how many time steps.
"""

import argparse
import os
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from itertools import chain
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[2]))

import numpy as np

import cgff_cli
from cgff_cli.rivals.registry import REGISTRY, Entry
from cgff_cli.rivals.znn import LAMBDA, znn
from cgff_cli.scene.scene import Scene
from cgff_cli.structure import from_scene
from cgff_cli.study.record import Method
from cgff_cli.study.starts import random_start

STRUCTURES = Path(__file__).parents[2] / "structures"
SHIPPED = ("prism", "x-module", "hexagon", "octahedron", "bracket", "cable-net")
LARGER = {
    "tower": {"stages": 10, "noise": 0.05, "seed": 1},
    "geiger": {"noise": 0.02, "seed": 1},
    "net": {"side": 20, "noise": 0.05, "seed": 1},
}
"""Family -> parameters: a start off the answer, as the shipped ones have theirs."""

AT = (1e-4, 1e-8, 1e-12)
ARRIVED = 1e-6
LONGER = 6.0
Ends = dict[str, list[Method]]
NOISES = (0.0, 1e-3, 1e-2)
EQUILIBRIA = ("converged", "rounding_floor")
SAME_ENERGY = 1e-6
SEED = 1


def scenes(only: list[str]) -> Iterator[tuple[str, Scene]]:
    """Yield names and scenes, those asked for or all."""
    for name in only or (*SHIPPED, *LARGER):
        yield (
            name,
            cgff_cli.new(name, **LARGER[name])
            if name in LARGER
            else cgff_cli.load(STRUCTURES / f"{name}.yaml"),
        )


def takes_a_start(name: str) -> bool:
    """Return whether where a method begins has to do with where it ends."""
    return name != "schek" and not REGISTRY[name].is_affine


def work(method: Method) -> Iterator[str]:
    """Yield a cell for each tolerance."""
    reached = {point.tolerance: point for point in method.curve}
    for tolerance in AT:
        point = reached.get(tolerance)
        if point is None or point.seconds is None:
            yield "-"
        else:
            yield f"{point.iterations}, {1e3 * point.seconds:.3g}"


def found(method: Method, least: float) -> str:
    """Return what a method found; least: the least energy of a stable equilibrium."""
    if method.verdict not in EQUILIBRIA or method.energy is None:
        return method.verdict.replace("_", " ")
    if not method.stable:
        return "unstable" if method.stable is False else "not judged"
    return "higher" if method.energy > least + SAME_ENERGY * abs(least) else "stable"


def from_random_starts(scene: Scene, names: list[str], count: int, limit: float, patience: float) -> Ends:
    """Return where each method came to from every start that it was given."""
    structure = from_scene(scene)
    ends: Ends = {name: [] for name in names}
    for number in range(1, count + 1):
        start = replace(scene, coordinates=random_start(structure, SEED, number))
        asked = [name for name, rows in ends.items() if sum(row.seconds or 0.0 for row in rows) < patience]
        for method in cgff_cli.compare(start, asked, repeat=1, time_limit=limit, tolerance=ARRIVED).methods:
            ends[method.name].append(method)
    return ends


def told(rows: list[Method], least: float, count: int) -> str:
    """Return how many runs arrived, how many stably, how many at the least energy; of how many if not all."""
    arrived = [method for method in rows if method.verdict in EQUILIBRIA]
    numbers = [len(arrived), sum(method.stable is True for method in arrived)]
    numbers += [sum(found(method, least) == "stable" for method in arrived)]
    return ", ".join(map(str, numbers)) + ("" if len(rows) == count else f" of {len(rows)}")


def study(name: str, scene: Scene, count: int, limit: float, patience: float) -> None:
    """Print the rows of a scene."""
    cgff_cli.compare(scene, ["all"], repeat=1, time_limit=0.1)  # what is imported once is not timed
    methods = cgff_cli.compare(scene, ["all"], repeat=1, time_limit=LONGER * limit).methods
    names = [method.name for method in methods if takes_a_start(method.name)]
    ends = from_random_starts(scene, names, count, limit, patience)
    every = [*methods, *chain.from_iterable(ends.values())]
    least = min((m.energy for m in every if m.stable and m.energy is not None), default=-np.inf)
    for method in methods:
        own = method.name
        starts = told(ends[own], least, count) if own in ends else "-"
        print(
            "|", " | ".join([name, f"`{own}`", *work(method), found(method, least), starts]), "|", flush=True
        )


def noises(name: str, scene: Scene, limit: float) -> Iterator[str]:
    """Yield a row for each noise."""
    for noise in NOISES:
        cells = []
        for gain in (LAMBDA, 0.0):
            REGISTRY["znn"] = Entry(partial(znn, gain=gain, noise=noise))
            method = cgff_cli.compare(scene, ["znn"], repeat=1, time_limit=limit).methods[1]
            cells.append(f"{method.residual_relative:.1e}, {method.iterations}")
        yield f"| {name} | {noise:g} | {' | '.join(cells)} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=100)
    parser.add_argument("--time-limit", type=float, default=3.0)
    parser.add_argument("--patience", type=float, default=300.0)
    parser.add_argument("--quick", action="store_true", help="five starts, a fifth of a second each")
    parser.add_argument("--only", default="")
    parser.add_argument("--noise", action="store_true", help="how znn bears noise, and nothing else")
    arguments = parser.parse_args()
    count, limit = (5, 0.2) if arguments.quick else (arguments.starts, arguments.time_limit)
    chosen = scenes([name for name in arguments.only.split(",") if name])
    if arguments.noise:
        print("| scene | noise | with the integral | without |\n|---|--:|--:|--:|")
        for name, scene in chosen:
            print(*noises(name, scene, LONGER * limit), sep="\n", flush=True)
        return
    print(
        "| scene | method | to 1e-4: iterations, ms | to 1e-8 | to 1e-12 | found | arrived, stably, least |"
    )
    print("|---|---|--:|--:|--:|---|--:|")
    for name, scene in chosen:
        study(name, scene, count, limit, arguments.patience)


if __name__ == "__main__":
    main()
