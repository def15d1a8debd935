"""Every --cg-beta on the scenes of relatives.py: both objectives, with the preconditioner and without.

    python tests/studies/beta_rules.py [--starts 100] [--only prism,net]

First iterations to 1e-10 from the scene's own start, with a * where the answer is not stable and a - where
there is none after 5000. Then, without preconditioner, where beta matters most: how many of --starts random
starts came to a balance of 1e-6 within 2000 iterations, how many stably, and the median of their iterations.
"""

import argparse
import os
import statistics
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[2]))

import cgff_cli
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.directions import RULES
from cgff_cli.structure import from_scene
from cgff_cli.study.starts import random_start
from tests.studies.relatives import ARRIVED, SEED, scenes

OBJECTIVES = ("energy", "residual")
MOST = {"own": 5000, "random": 2000}


def own_start(scene: Scene, rule: str, objective: str, preconditioner: str) -> str:
    """Return the iterations to 1e-10, with a * where the answer is not stable, or why there is none."""
    options = {"objective": objective, "preconditioner": preconditioner, "max_iterations": MOST["own"]}
    result = cgff_cli.solve(scene, cg_beta=rule, tolerance=1e-10, **options)
    if not result.converged:
        return "-"
    return f"{result.counts['iterations']}{'' if result.analysis['stable'] else '*'}"


def random_starts(scene: Scene, rule: str, objective: str, count: int) -> str:
    """Return how many starts arrived, how many stably, and the median of the iterations of these runs."""
    structure = from_scene(scene)
    options = {"objective": objective, "preconditioner": "none", "max_iterations": MOST["random"]}
    ends = [
        cgff_cli.solve(
            replace(scene, coordinates=random_start(structure, SEED, number)),
            cg_beta=rule,
            tolerance=ARRIVED,
            **options,
        )
        for number in range(1, count + 1)
    ]
    arrived = [end for end in ends if end.converged]
    stably = sum(end.analysis["stable"] is True for end in arrived)
    most = f"; {statistics.median(end.counts['iterations'] for end in arrived):g}" if arrived else ""
    return f"{len(arrived)}, {stably}{most}"


def rows(chosen: list[tuple[str, Scene]], count: int) -> Iterator[str]:
    """Yield the lines of both tables."""
    rules = f"{' | '.join(RULES)} |\n|---|---|---|{'--:|' * len(RULES)}"
    yield f"| objective | preconditioner | scene | {rules}"
    for objective in OBJECTIVES:
        for preconditioner in ("none", "tangent"):
            for name, scene in chosen:
                cells = [own_start(scene, rule, objective, preconditioner) for rule in RULES]
                yield f"| {objective} | {preconditioner} | {name} | {' | '.join(cells)} |"
    yield f"\n| objective | starts | scene | {rules}"
    for objective in OBJECTIVES:
        for name, scene in chosen:
            cells = [random_starts(scene, rule, objective, count) for rule in RULES]
            yield f"| {objective} | {count} | {name} | {' | '.join(cells)} |"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=100)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    for line in rows(list(scenes([name for name in arguments.only.split(",") if name])), arguments.starts):
        print(line, flush=True)


if __name__ == "__main__":
    main()
