"""Feed damaged scenes to the reader and to the solver, and fail on anything but an orderly refusal.

    python tests/studies/mutate_scenes.py --count 100000 --seed 0 [--solve]

A read may return a Scene or raise SceneError within five seconds; a solve may end with any verdict
but not with NaN; a sample goes through the command line, which may exit with 0, 3 or 4. Every failure
is printed with the number of its mutation, which --only repeats.
"""

import argparse
import copy
import json
import math
import random
import re
import signal
import sys
import time
import traceback
import warnings
from collections import Counter
from pathlib import Path

import numpy as np
import yaml
from click.testing import CliRunner

import cgff_cli
from cgff_cli.cli import main as cli
from cgff_cli.scene.fields import HUGE
from cgff_cli.scene.read import from_dict, loads

READ_SECONDS = 5
SOLVE_SECONDS = 20
SOLVED_SHARE = 0.2
CLI_SHARE = 0.01
EXITS = (0, 3, 4)

BUILT_IN = [
    "law: paper\nnodes: {a: [0, 0], b: [1, 0], c: [1, 1], d: [0, 1]}\nelements:\n"
    "  side: {kind: cable, EA: [1, 2, 3, 4], rest_length: 0.9, pairs: [[a, b], [b, c], [c, d], [d, a]]}\n"
    "  cross: {kind: strut, EA: 1e2, rest_length: 1.5, pairs: [[a, c], [b, d]]}\n",
    "law: hooke\nnodes:\n  top: &top [0, 0, 1e0]\n  left: [-1, 0, 0]\n  right: [+1., .0, 0]\nelements:\n"
    "  rope:\n    kind: cable\n    EA: 1e3\n    rest_length: &l 1.2\n    pairs:\n      - [left, top]\n"
    "      - [top, right]\nsupports: {left: xyz, right: zyx, top: y}\nloads: {top: [0, 0, -1]}\n"
    "solver: {tolerance: 1e-8, method: table1}\n",
    json.dumps(
        {
            "law": "hooke",
            "nodes": {"1": [0, 0], "2": [3, 0], "3": [1, -1]},
            "elements": {"r": {"kind": "cable", "EA": 10, "rest_length": [1, 2], "pairs": [[1, 3], [3, 2]]}},
            "supports": {"1": "xy", "2": "xy"},
            "loads": {"3": [0, -1.5]},
        },
        indent=1,
    ),
]

# fmt: off
NUMBERS = ["nan", ".nan", "inf", "-.inf", "1e400", "1e308", "1e30", "1e31", "1e-30", "1e-31", "5e-324", "0",
           "-0", "-1", "1_0", "0x1", "1:30", "1,5", "true", "null", "~", "'1'"]
SNIPPETS = ["!!python/object:os.system", "!!float", "&a", "*a", "<<:", "{}", "[]", "[[", "]]", "}}", ":", "-",
            "?", "|", ">", "'", '"', "#", "%", "@", "`", ",", "---", "...", "\t", "\r\n", "\0", "\x85",
            "\u2028", "\ufeff", "é", "🎪", "supports", "loads", "solver", "nodes.csv", "law:", "strut"]
# fmt: on
VALUES = [
    None,
    True,
    0,
    -1,
    1e300,
    10**400,
    float("nan"),
    float("inf"),
    "",
    "b",
    "xyz",
    [],
    {},
    [[]],
    "n.csv",
]


class Late(Exception):  # noqa: N818
    """Raised by the alarm."""


def text_mutation(text: str, rng: random.Random) -> str:
    """Return a text with one place changed."""
    kind = rng.randrange(9)
    at = rng.randrange(len(text) + 1)
    lines = text.split("\n")
    row = rng.randrange(len(lines))
    if kind == 0:
        return text[:at] + chr(rng.choice([rng.randrange(256), rng.randrange(0xD800)])) + text[at + 1 :]
    if kind == 1:
        return text[:at] + rng.choice(SNIPPETS) + text[at + rng.randrange(3) :]
    if kind == 2:
        del lines[row]
    elif kind == 3:
        lines.insert(rng.randrange(len(lines)), lines[row])
    elif kind == 4:
        lines[row] = " " * rng.randrange(6) + lines[row].lstrip()
    elif kind == 5:
        return swapped(text, r"[-+.\w]*\d[-+.\w]*", lambda: rng.choice(NUMBERS), rng)
    elif kind == 6:
        words = re.findall(r"\w+", text)
        return swapped(text, r"\w+", lambda: rng.choice(words), rng)
    elif kind == 7:
        return swapped(
            text, r"\w+(?=:)", lambda: "x" * rng.randrange(3) + rng.choice(("a", "EA", "law", "'")), rng
        )
    else:
        return text[:at]
    return "\n".join(lines)


def swapped(text, pattern, make, rng):
    """Return a text with one match of a pattern replaced."""
    found = list(re.finditer(pattern, text))
    if not found:
        return text
    match = rng.choice(found)
    return text[: match.start()] + make() + text[match.end() :]


def value_mutation(values, rng: random.Random):
    """Return plain values with one member replaced, removed, doubled or renamed."""
    values = copy.deepcopy(values)
    owner, key = rng.choice(list(members(values)))
    kind = rng.randrange(5)
    if kind == 0:
        owner[key] = copy.deepcopy(rng.choice(VALUES))
    elif kind == 1:
        del owner[key]
    elif kind == 2 and isinstance(owner, list):
        owner.append(copy.deepcopy(owner[key]))
    elif kind == 2:
        owner[str(key) + "2"] = copy.deepcopy(owner[key])
    elif kind == 3 and isinstance(owner[key], (int, float)):
        owner[key] = _as_float(owner[key]) * rng.choice([0, -1, 1e-12, 1e12, 1e-28, 1e28])
    else:
        other, from_key = rng.choice(list(members(values)))
        if owner[key] is not other:
            owner[key] = copy.deepcopy(other[from_key])
    return values


def _as_float(number) -> float:
    return float(max(-(10**300), min(10**300, number))) if isinstance(number, int) else number


def members(values):
    """Yield every (owner, key) inside nested values."""
    for key in list(values) if isinstance(values, dict) else range(len(values)):
        yield values, key
        if isinstance(values[key], (dict, list)):
            yield from members(values[key])


def numeric(values):
    """Return values of a YAML BaseLoader with its numbers as numbers."""
    if isinstance(values, dict):
        return {key: numeric(value) for key, value in values.items()}
    if isinstance(values, list):
        return [numeric(value) for value in values]
    try:
        return float(values)
    except ValueError:
        return values


def within(seconds, function):
    """Return function(), or raise Late."""
    signal.alarm(seconds)
    try:
        return function()
    finally:
        signal.alarm(0)


def on_alarm(number, frame):
    raise Late


def one(index: int, seed: int, scenes, solve: bool, tally: Counter, show: bool) -> None:
    """Make, read and perhaps solve one mutation; raises where something is wrong."""
    rng = random.Random(f"{seed}/{index}")
    text, values = rng.choice(scenes)
    if rng.random() < 0.3:
        for _ in range(rng.choice([1, 1, 2, 4])):
            values = value_mutation(values, rng) or values
        read = lambda: from_dict(values)  # noqa: E731
        text = None
    else:
        for _ in range(rng.choice([1, 1, 1, 2, 5])):
            text = text_mutation(text, rng) or "\n"
        path = rng.choice(["scene.yaml", "scene.json"]) if text.lstrip()[:1] == "{" else "scene.yaml"
        read = lambda: loads(text, path)  # noqa: E731
    if show:
        print(text if text is not None else values)
    try:
        scene = within(READ_SECONDS, read)
    except cgff_cli.SceneError as error:
        check_problems(error)
        tally["refused"] += 1
        scene = None
    else:
        tally["read"] += 1
        check_scene(scene)
    if scene is not None and solve and not scene.is_geometry and rng.random() < SOLVED_SHARE:
        solve_one(scene, tally)
    if text is not None and rng.random() < CLI_SHARE:
        through_the_command_line(text, tally)


def check_problems(error) -> None:
    """Raise where there is no problem, or one in a text has no place or spreads over lines."""
    if not error.problems:
        raise AssertionError("refused without a reason")
    for problem in error.problems:
        placed = problem.path == "<python>" or (problem.line >= 1 and problem.column >= 1)
        if not placed or not str(problem).isprintable():
            raise AssertionError(f"a problem that is no line: {problem!r}")


def check_scene(scene) -> None:
    """Raise where a scene holds a number it may not."""
    arrays = [scene.coordinates, *(g.EA for g in scene.groups)]
    arrays += [] if scene.is_geometry else [g.rest_length for g in scene.groups]
    if not all(np.all(np.abs(array) <= HUGE) for array in arrays):
        raise AssertionError("a number out of range was read")


def solve_one(scene, tally: Counter) -> None:
    """Solve a scene and look for NaN; warnings of numpy count as failures."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        result = within(SOLVE_SECONDS, lambda: cgff_cli.solve(scene, max_iterations=30))
    record = json.dumps(result.to_dict(), default=lambda value: value.tolist())
    if re.search(r"\bNaN\b", record) or not all(math.isfinite(x) for x in result.coordinates.flat):
        raise AssertionError(f"NaN in a result, verdict {result.verdict}")
    tally[f"solved: {result.verdict}"] += 1


def through_the_command_line(text: str, tally: Counter) -> None:
    """Check the exit code for a scene on standard input."""
    data = text.encode("utf-8", "surrogatepass")
    result = CliRunner().invoke(cli, ["solve", "-", "--max-iterations", "5", "--format", "json"], input=data)
    if result.exit_code not in EXITS:
        raise AssertionError(f"exit code {result.exit_code}: {result.stderr[-500:]}")
    tally[f"exit code {result.exit_code}"] += 1


def sources():
    """Return (text, values) of every scene to start from."""
    texts = [path.read_text() for path in sorted((Path(__file__).parents[2] / "structures").glob("*.yaml"))]
    return [(text, numeric(yaml.load(text, Loader=yaml.BaseLoader))) for text in [*texts, *BUILT_IN]]


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--solve", action="store_true", help="also solve a share of what reads well")
    parser.add_argument("--only", type=int, help="repeat one mutation and show it")
    options = parser.parse_args()
    signal.signal(signal.SIGALRM, on_alarm)
    scenes, tally, failures, start = sources(), Counter(), 0, time.perf_counter()
    indices = range(options.count) if options.only is None else [options.only]
    for index in indices:
        try:
            one(index, options.seed, scenes, options.solve, tally, show=options.only is not None)
        except Exception as error:
            failures += 1
            last = traceback.extract_tb(error.__traceback__)[-1]
            place = f"{Path(last.filename).name}:{last.lineno}"
            tally[f"FAILED {type(error).__name__} at {place}"] += 1
            print(f"mutation {index}: {type(error).__name__} at {place}: {str(error)[:300]}")
            if options.only is not None:
                traceback.print_exc()
    for what, count in sorted(tally.items()):
        print(f"{count:9d}  {what}")
    print(f"{len(indices)} mutations, {failures} failures, {time.perf_counter() - start:.1f} s")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
