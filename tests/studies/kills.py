"""Commands killed at random moments and resumed, beside one run left in peace: bytes that differ.

    python tests/studies/kills.py [--kills 50] [--seed 0] [--only solve]

A command is killed (SIGKILL: its first process, or it and its workers at once) and begun anew in the same
folder, at moments spread over the time a whole run takes, until it comes to its end; what is then in the
folder and on standard output is laid beside what the run in peace left, and the next begins in a new folder.
"""

import argparse
import os
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).parents[2]
STRUCTURES = ROOT / "structures"
CGFF = [sys.executable, "-m", "cgff_cli"]


class Command(NamedTuple):
    """arguments; ignored: files that only the program reads; times: what may differ, as a pattern."""

    arguments: list[str]
    ignored: frozenset[str] = frozenset()
    times: str = r"(?!)"


SCENES = [f"{number:03}.yaml" for number in range(150)]
SOLVE = ["solve", *SCENES, "--out-dir", "out", "--resume", "--summary", "rows.csv", "--format", "jsonl"]
RESULTS = Command(SOLVE, frozenset({"out/.cgff-rows.jsonl"}), r'"seconds": [^}]+|(?<=,)[-.e\d]+(?=\n)')

COMMANDS = {
    "solve": RESULTS,
    "solve --jobs 2": RESULTS._replace(arguments=[*SOLVE, "--jobs", "2"]),
}


def write_scenes(folder):
    """Write the structures shipped with other rest lengths; some do not converge, some are no scenes."""
    texts = [path.read_text() for path in sorted(STRUCTURES.glob("*.yaml"))]
    rng = random.Random(0)
    for number, name in enumerate(SCENES):
        text = texts[number % len(texts)]
        factor = rng.uniform(0.99, 1.01)
        text = re.sub(r"(?<=rest_length: )[\d.]+", lambda own, f=factor: repr(float(own[0]) * f), text)
        if number % 40 == 17:
            text = text.replace("law: paper", "law: none")
        if number % 40 == 23:
            text = f"{text}solver: {{max_iterations: 1}}\n"
        (folder / name).write_text(text)


def begin(command, folder):
    """Start a command in a folder, in a process group of its own."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
    for name in ("stdout", "stderr"):  # what outlived the last run may still write to its own
        (folder / name).unlink(missing_ok=True)
    with (folder / "stdout").open("wb") as out, (folder / "stderr").open("wb") as err:
        return subprocess.Popen(
            [*CGFF, *command.arguments],
            cwd=folder,
            stdout=out,
            stderr=err,
            env=environment,
            start_new_session=True,
        )


def left(command, folder):
    """Return all that a command left, by name, without times."""
    files = {str(path.relative_to(folder)): path for path in folder.rglob("*") if path.is_file()}
    times = re.compile(command.times.encode())
    return {
        name: times.sub(b"", path.read_bytes()) for name, path in files.items() if name not in command.ignored
    }


def differing(one, other):
    """Return how many bytes differ, those of files that only one has among them."""
    count = 0
    for name in one.keys() | other.keys():
        a, b = one.get(name, b""), other.get(name, b"")
        count += sum(x != y for x, y in zip(a, b, strict=False)) + abs(len(a) - len(b))
        count += (name in one) != (name in other)
    return count


def trial(command, folder, kills, seconds, rng):
    """Kill a command until it comes to its end, or so many times and then no more; return the kills."""
    for killed in range(kills):
        running = begin(command, folder)
        try:
            running.wait(timeout=rng.uniform(0.0, seconds))
            return killed
        except subprocess.TimeoutExpired:
            end = os.killpg if rng.random() < 0.5 else os.kill
            end(running.pid, signal.SIGKILL)
            running.wait()
    begin(command, folder).wait()
    return kills


def measured(name, kills, seed):
    """Kill one command so many times; return the runs that ended, bytes differing, bytes in all."""
    command, rng = COMMANDS[name], random.Random(seed)
    with tempfile.TemporaryDirectory() as top:
        peace = Path(top, "peace")
        peace.mkdir()
        write_scenes(peace)
        start = time.perf_counter()
        code = begin(command, peace).wait()
        seconds = time.perf_counter() - start
        right = left(command, peace)
        done = ended = wrong = 0
        while done < kills:
            folder = Path(top, f"trial-{ended}")
            folder.mkdir()
            write_scenes(folder)
            done += trial(command, folder, min(6, kills - done), seconds, rng)
            ended += 1
            wrong += differing(right, left(command, folder))
    size = sum(map(len, right.values()))
    print(
        f"{name:16} {seconds:6.2f} {code:5} {done:6} {ended:6} {len(right):6} {size:10} {wrong:10}",
        flush=True,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--kills", type=int, default=50)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", choices=COMMANDS)
    arguments = parser.parse_args()
    print("command         seconds  code  kills   runs  files      bytes  differing")
    for name in [arguments.only] if arguments.only else COMMANDS:
        measured(name, arguments.kills, arguments.seed)


if __name__ == "__main__":
    main()
