"""`cgff solve` of many small scene files in one call, against `cgff check` of the same files.

    python tests/studies/scene_files.py [--count 1000] [--repeat 3]

First what the parts take in one process, a scene after the other; then the commands as processes, in turn, so
that drift hits all alike: the least processor time of each, and the share of it that the system takes.
"""

import argparse
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from cgff_cli.analysis.equilibrium import analysed
from cgff_cli.options import DEFAULTS
from cgff_cli.scene.read import load
from cgff_cli.solvers.cgff import form_find
from cgff_cli.structure import from_scene

ROOT = Path(__file__).parents[2]
COMMANDS = {
    "check": ["check"],
    "solve --summary, no analysis": [
        "solve",
        "--summary",
        "s.csv",
        "--format",
        "table",
        "--analysis",
        "never",
    ],
    "solve --summary": ["solve", "--summary", "s.csv", "--format", "table"],
    "solve --format jsonl": ["solve", "--format", "jsonl"],
    "solve --out-dir": ["solve", "--out-dir", "out"],
    "the same, resumed": ["solve", "--out-dir", "out", "--resume"],
    "solve --out-dir --jobs 2": ["solve", "--out-dir", "out", "--jobs", "2"],
}


def write_scenes(folder, count):
    """Write the structures shipped, each with its own rest lengths, half a percent off; return the names."""
    texts = [path.read_text() for path in sorted((ROOT / "structures").glob("*.yaml"))]
    rng = random.Random(0)
    names = [f"{number:05}.yaml" for number in range(count)]
    for number, name in enumerate(names):
        factor = rng.uniform(0.995, 1.005)
        text = texts[number % len(texts)]
        text = re.sub(r"(?<=rest_length: )[\d.]+", lambda own, f=factor: repr(float(own[0]) * f), text)
        (folder / name).write_text(text)
    return names


def print_parts(paths):
    """Print what reading, solving and judging take, per scene and in units of reading."""
    spent = dict.fromkeys(("read", "solve", "analysis"), 0.0)
    for path in paths:
        marks = [time.perf_counter()]
        scene = load(str(path))
        marks.append(time.perf_counter())
        options = DEFAULTS.merged(scene.solver)
        solution = form_find(from_scene(scene), options, None)
        marks.append(time.perf_counter())
        analysed(scene, solution, options)
        marks.append(time.perf_counter())
        for part, begun, ended in zip(spent, marks, marks[1:], strict=False):
            spent[part] += ended - begun
    for part, seconds in spent.items():
        print(f"{part:30}{1e3 * seconds / len(paths):8.2f} ms{seconds / spent['read']:7.2f}")


def processor_time(command, folder):
    """Return the processor time of a command and of its workers, and what of it the system took."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
    before = os.times()
    with (folder / "told").open("wb") as told:
        subprocess.run(command, cwd=folder, stdout=told, env=environment, check=True)
    after = os.times()
    system = after.children_system - before.children_system
    return after.children_user - before.children_user + system, system


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--repeat", type=int, default=3)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as top:
        folder = Path(top)
        names = write_scenes(folder, arguments.count)
        print_parts([folder / name for name in names])
        spent = {name: [] for name in COMMANDS}
        for _ in range(arguments.repeat):
            for name, command in COMMANDS.items():
                if "resumed" not in name:
                    shutil.rmtree(folder / "out", ignore_errors=True)
                spent[name].append(
                    processor_time([sys.executable, "-m", "cgff_cli", *command, *names], folder)
                )
    base = min(spent["check"])[0]
    for name, times in spent.items():
        whole, system = min(times)
        each = 1e3 * whole / arguments.count
        print(f"{name:30}{each:8.2f} ms{whole / base:7.2f}{system / whole:7.0%} system")


if __name__ == "__main__":
    main()
