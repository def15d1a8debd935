"""What a sweep costs and whether it is right, what kills leave of it, and which falls a path finds.

    OPENBLAS_NUM_THREADS=1 python tests/studies/sweep.py rows [--rows 10000] [--million]
    OPENBLAS_NUM_THREADS=1 python tests/studies/sweep.py kills [--count 50] [--seed 1]
    OPENBLAS_NUM_THREADS=1 python tests/studies/sweep.py falls [--count 300] [--first 0]

rows: random rest lengths and EA of the prism; microseconds of CPU time a row, and how many times longer loops
of `solve` and of fsolve take on the first rows, and how well all answers balance; every row against a
solve of its own: energy, all distances, stability. With --million the command too, 10^5 and 10^6 rows into
a file: wall and CPU seconds, and peak memory.
kills: the process, its group or one worker killed, or asked to end, at random moments; resumed each time.
falls: random frames between supports under a growing load, in 6 steps and in 60, and where these disagree in
600: values at which an equilibrium is lost, to 1e-6, and the energy at the end.
"""

import argparse
import os
import random
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from itertools import combinations
from pathlib import Path

import numpy as np
from many import by_fsolve, clocked
from versions_in_one import ROOT

import cgff_cli
from cgff_cli.structure import from_scene
from cgff_cli.study.path import Path as Walk
from cgff_cli.study.path import followed
from cgff_cli.study.sweep import planned

PRISM = ROOT / "structures" / "prism.yaml"
CGFF = (sys.executable, "-m", "cgff_cli", "sweep")
ENVIRONMENT = os.environ | {"PYTHONPATH": str(ROOT), "OPENBLAS_NUM_THREADS": "1"}
SCALED = {
    "struts.rest_length": "1:1.05",
    "verticals.rest_length": "0.95:1",
    "triangles.rest_length": "0.95:1",
}
SET = {"struts.EA": "log:300:3000", "verticals.EA": "log:30:300", "triangles.EA": "log:30:300"}
FEW = 200

TRUSS = """\
law: hooke
nodes: {a: [-1, 0], b: [0, 0.5], c: [1, 0]}
elements: {bars: {kind: strut, EA: 100, rest_length: 1.118, pairs: [[a, b], [c, b]]}}
supports: {a: xy, c: xy}
"""
MANY = (str(PRISM), "--set", "struts.EA=log:10:1e4:100", "--set", "verticals.rest_length=2.5:3.5:400")
CASES = {
    "csv": (*MANY, "-o", "rows.csv"),
    "jsonl": (*MANY, "-o", "rows.jsonl", "--out", "node:n1"),
    "csv, 2 jobs": (*MANY, "-o", "rows.csv", "--jobs", "2"),
    "second of 3 shards": (*MANY, "-o", "rows.csv", "--shard", "2/3", "--no-header"),
    "path": ("truss.yaml", "--set", "loads.b.y=0:-6:1001", "--follow", "-o", "rows.csv"),
}
WAYS = ("process", "group", "worker", "asked")


def off_balance(scene, X):
    """Return the relative residual of a scene at a shape (n, d)."""
    return cgff_cli.analyse(scene.with_coordinates(X), modes=0).result.residual["relative"]


def told_of(name, residuals):
    """Print how well answers balance."""
    left = np.array(list(residuals))
    beyond = f"{(left > 1e-10).sum()} of {len(left)} above 1e-10"
    print(f"  {name}: relative residual {np.median(left):.1e}, at most {left.max():.1e}, {beyond}")


def measured(m):
    """Print what rows cost, and how they differ from solves of their own."""
    scene = cgff_cli.load(str(PRISM))
    pairs = list(combinations(range(6), 2))
    words = [f"length:n{i + 1},n{j + 1}" for i, j in pairs]
    bare = planned(scene, set=SET, scale=SCALED, random=m, seed=1)
    clocked(lambda: bare.solved(next(bare.chunks(range(100)))))
    seconds, _ = clocked(lambda: [bare.solved(chunk) for chunk in bare.chunks(range(m))])
    few = [bare.scene_at(values) for values in bare.values(0, min(m, FEW))]
    structures = [from_scene(one) for one in few]
    rivals = {
        "solve": lambda: [cgff_cli.solve(one).coordinates for one in few],
        "solve without analysis": lambda: [cgff_cli.solve(one, analysis="never").coordinates for one in few],
        "fsolve": lambda: [by_fsolve(s, s.coordinates, False) for s in structures],
        "fsolve, exact Jacobian": lambda: [by_fsolve(s, s.coordinates, True) for s in structures],
    }
    print(f"{m} rows: {1e6 * seconds / m:.0f} us a row, {m / seconds:.0f} a second")
    told_of("the sweep", bare.solved(bare.span(0, len(few))).columns["residual_relative"])
    for name, call in rivals.items():
        spent, found = clocked(call)
        told_of(f"{name}, {spent / len(few) * m / seconds:.1f} times as long", map(off_balance, few, found))
    told = planned(scene, set=SET, scale=SCALED, random=m, seed=1, out=words)
    counts, energies, distances = Counter(), [], []
    for chunk in told.chunks(range(m)):
        columns = told.solved(chunk).columns
        for row, values in enumerate(told.values(chunk.first, chunk.last)):
            alone = cgff_cli.solve(told.scene_at(values))
            counts[columns["stability"][row]] += 1
            counts["other stability"] += columns["stability"][row] != alone.analysis["stability"]
            energies.append(abs(columns["energy"][row] / alone.energy - 1.0))
            own = [np.linalg.norm(alone.coordinates[i] - alone.coordinates[j]) for i, j in pairs]
            distances.append(np.abs(np.array([columns[word][row] for word in words]) / own - 1.0).max())
    print(f"  {dict(counts)}; against a solve each: energy {max(energies):.1e}, ", end="")
    print(
        f"distances {max(distances):.1e} off at most, relative; {np.sum(np.array(distances) > 1e-6)} > 1e-6"
    )


def by_command(m, folder):
    """Return wall and CPU seconds, peak memory in MB and bytes of m rows written into a file."""
    flags = [f"--set={key}={values}" for key, values in SET.items()]
    flags += [f"--scale={key}={values}" for key, values in SCALED.items()]
    start = time.perf_counter()
    command = [*CGFF, str(PRISM), *flags, "--random", str(m), "--seed", "1", "-o", "rows.csv"]
    running = subprocess.Popen(command, env=ENVIRONMENT, cwd=folder)
    _, status, used = os.wait4(running.pid, 0)
    assert status == 0
    seconds = time.perf_counter() - start, used.ru_utime + used.ru_stime
    return *seconds, used.ru_maxrss / 1024, (Path(folder) / "rows.csv").stat().st_size


def workers_of(pid):
    """Return the processes that a process has begun, none where it has gone."""
    try:
        return list(map(int, Path(f"/proc/{pid}/task/{pid}/children").read_text().split()))
    except OSError:
        return []


def is_alive(pid):
    """Return whether a process does, or waits for, anything."""
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def kill(running, way):
    """Kill a run in one of the ways, and return what of it lives on after two seconds."""
    own = workers_of(running.pid)
    if way == "worker" and own:
        os.kill(own[-1], signal.SIGKILL)
    elif way == "group":
        os.killpg(running.pid, signal.SIGKILL)
    else:
        running.send_signal(signal.SIGTERM if way == "asked" else signal.SIGKILL)
    running.wait()
    until = time.monotonic() + 2.0
    while own and time.monotonic() < until:
        own = [pid for pid in own if is_alive(pid)]
        time.sleep(0.05)
    return len(own)


def killed(name, flags, count, moments):
    """Kill a sweep so many times; return kills, runs that came to their end, bytes other, orphans."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "truss.yaml").write_text(TRUSS)
        path = Path(folder) / flags[flags.index("-o") + 1]
        how = {"env": ENVIRONMENT, "cwd": folder, "stderr": subprocess.DEVNULL}
        start = time.perf_counter()
        subprocess.run([*CGFF, *flags], check=True, **how)
        whole, seconds = path.read_bytes(), time.perf_counter() - start
        kills, ends, other, orphans = 0, 0, 0, 0
        path.unlink()
        Path(f"{path}.sweep.json").unlink()
        while kills < count or not path.exists():
            running = subprocess.Popen([*CGFF, *flags, "--resume"], start_new_session=True, **how)
            try:
                running.wait(moments.uniform(0.1, 0.6) * seconds if kills < count else None)
            except subprocess.TimeoutExpired:
                kills += 1
                orphans += kill(running, moments.choice(WAYS))
            if path.exists():
                ends += 1
                found = path.read_bytes()
                other += abs(len(found) - len(whole)) + sum(
                    a != b for a, b in zip(found, whole, strict=False)
                )
                if kills < count:
                    path.unlink()
                    Path(f"{path}.sweep.json").unlink()
        print(f"{name:20}{kills:4} kills, {ends:3} ends, {other} bytes other, {orphans} processes left over")


def frame(rng):
    """Return a random frame of struts and some cables between supports, and the load's key and end."""
    d, k = int(rng.integers(2, 4)), int(rng.integers(1, 4))
    m = int(rng.integers(d + 1, 2 * d + 3))
    free, held = rng.uniform(-0.6, 0.6, (k, d)), rng.normal(size=(m, d))
    free[:, -1] = rng.uniform(0.1, 0.7, k)
    held *= 1.5 / np.linalg.norm(held, axis=1)[:, None]
    held[:, -1] *= 0.3
    X = np.concatenate([free, held])
    pairs = {(i, int(j)) for i in range(k) for j in k + rng.choice(m, min(m, d + 1), replace=False)}
    pairs |= {(j, i) for i in range(k) for j in range(i) if rng.random() < 0.7}
    elements = {
        f"e{row}": {
            "kind": str(rng.choice(["strut", "strut", "strut", "cable"])),
            "EA": float(10.0 ** rng.uniform(1.0, 2.5)),
            "rest_length": float(np.linalg.norm(X[i] - X[j]) * rng.uniform(0.97, 1.03)),
            "pairs": [[f"n{i}", f"n{j}"]],
        }
        for row, (i, j) in enumerate(sorted(pairs))
    }
    nodes = {f"n{row}": x for row, x in enumerate(X.tolist())}
    supports = {f"n{row}": "xyz"[:d] for row in range(k, k + m)}
    scene = {"law": "hooke", "nodes": nodes, "elements": elements, "supports": supports}
    return scene, f"loads.n0.{'xyz'[d - 1]}", -float(10.0 ** rng.uniform(0.0, 2.5))


def fallen(first, count):
    """Print how many falls are found in few, and in many steps, and where these disagree."""
    import yaml

    counts, solves = Counter(), []
    at = Walk._at
    Walk._at = lambda self, *given: solves.append(1) or at(self, *given)
    for seed in range(first, first + count):
        scene, key, end = frame(np.random.default_rng(seed))
        read = cgff_cli.loads(yaml.safe_dump(scene))

        def walked(steps, read=read, key=key, end=end):
            before = len(solves)
            stops = list(followed(planned(read, set={key: np.linspace(0.0, end, steps + 1)})).stops())
            counts[f"solves, {steps} steps"] += len(solves) - before
            counts["rows that did not converge"] += sum(not stop.row["converged"] for stop in stops)
            return [value for stop in stops for value in stop.lost], stops

        (few, stops), (many, others) = walked(6), walked(60)
        counts[f"start {stops[0].row['stability']}"] += 1
        counts["falls, 6 steps"] += len(few)
        counts["falls, 60 steps"] += len(many)
        ends = [found[-1].row["energy"] for found in (stops, others)]
        counts["same end"] += bool(np.isclose(*ends, rtol=1e-6))
        same = len(few) == len(many) and np.allclose(few, many, rtol=1e-6)
        counts["same falls"] += same
        if not same:
            print(seed, key, end, few, many, walked(600)[0], flush=True)
    print(dict(counts))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("rows", "kills", "falls"))
    parser.add_argument("--rows", type=int, default=10000)
    parser.add_argument("--million", action="store_true")
    parser.add_argument("--count", type=int)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--first", type=int, default=0)
    arguments = parser.parse_args()
    if arguments.what == "rows":
        for m in (10**5, 10**6) if arguments.million else ():  # first: memory counts from the fork on
            with tempfile.TemporaryDirectory() as folder:
                print(
                    "{:8} rows by the command: {:.0f} s ({:.0f} of CPU), {:.0f} MB, {} bytes".format(
                        m, *by_command(m, folder)
                    )
                )
        measured(arguments.rows)
    elif arguments.what == "kills":
        moments, each = random.Random(arguments.seed), -(-(arguments.count or 50) // len(CASES))
        for name, flags in CASES.items():
            killed(name, flags, each, moments)
    else:
        fallen(arguments.first, arguments.count or 300)


if __name__ == "__main__":
    main()
