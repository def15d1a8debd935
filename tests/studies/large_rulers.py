"""Large scenes beside fixed rulers and an older version: solves, iterations, factors, CPU seconds.

    git worktree add /tmp/before 814ae4d
    export OPENBLAS_NUM_THREADS=1
    python tests/studies/large_rulers.py taut --before /tmp/before
    python tests/studies/large_rulers.py towers --before /tmp/before
    python tests/studies/large_rulers.py slack --sides 100 --strains 1e-3,1e-4 --before /tmp/before
    python tests/studies/large_rulers.py snow --before /tmp/before
    python tests/studies/large_rulers.py chains --before /tmp/before
    python tests/studies/large_rulers.py million
    python tests/studies/large_rulers.py crossover

`unit` is `yardsticks.linear_solve` of the same scene, `newton` is `yardsticks.sparse_newton` on the same
factors; all by CPU time, in turn, the least of --repeat. A run is cut off at --limit seconds where it has
taken a step. `slack` counts cables that end slack, `wrong` lengths off by more than 1e-6 of the tower's own.
"""

import argparse
import resource
import time
from importlib import import_module

import numpy as np
from versions_in_one import ROOT, Version
from yardsticks import linear_solve, sparse_newton

BALANCED = "converged", "rounding_floor"
HEAD = (
    f"{'scene':34} {'factor':7} {'verdict':14} {'its':>5} {'factors':>7} {'slack':>6} {'residual':>8}"
    f" {'seconds':>8} {'units':>7} {'before':>7} {'newton':>7} {'GB':>5}"
)


def timed(call):
    """Return CPU seconds and what the call returned."""
    start = time.process_time()
    with np.errstate(all="ignore"):
        result = call()
    return time.process_time() - start, result


def solving(version, family, given, limit, **options):
    """Return a call that solves a scene with one version, made before the clock starts."""
    with version:
        structure = import_module("cgff_cli.structure").from_scene(
            import_module("cgff_cli").new(family, **given)
        )
        form_find = import_module("cgff_cli.solvers.cgff").form_find
        options = import_module("cgff_cli.options").SolveOptions(**options)

    def call():
        end = time.process_time() + limit

        def observer(row):
            if time.process_time() > end:
                raise KeyboardInterrupt

        return form_find(structure, options, observer)

    return call, structure


def arrays(structure):
    """Return what the yardsticks take."""
    names = "coordinates start end stiffness rest_lengths tension_only free loads"
    return tuple(getattr(structure, name) for name in names.split())


def cholmod(A):
    """Return a CHOLMOD factor for sparse_newton, the pattern analysed once a process and size."""
    from cvxopt import cholmod, matrix, spmatrix

    if cholmod_cache.get("size") != (A.shape, A.nnz):
        columns = np.repeat(np.arange(A.shape[0]), np.diff(A.indptr))
        lower = np.flatnonzero(A.indices >= columns)
        places = (matrix(part[lower].astype(np.int64)) for part in (A.indices, columns))
        own = spmatrix(1.0, *places, A.shape)
        cholmod_cache.update(size=(A.shape, A.nnz), lower=lower, own=own, factor=cholmod.symbolic(own))
    own, factor = cholmod_cache["own"], cholmod_cache["factor"]
    own.V = matrix(np.ascontiguousarray(A.data[cholmod_cache["lower"]]))
    try:
        cholmod.numeric(own, factor)
    except ArithmeticError:
        return None

    class Solved:
        def solve(self, b):
            x = matrix(b)
            cholmod.solve(factor, x)
            return np.array(x).ravel()

    return Solved()


cholmod_cache = {}


def by_newton(structure, kind):
    """Return a call that solves by sparse_newton; no more steps than a run of minutes has."""

    def call():
        cholmod_cache.clear()
        return sparse_newton(*arrays(structure), factor=cholmod if kind == "cholmod" else None)

    return call


def imbalance(structure, X):
    """Return the largest out-of-balance force over the largest force or load, at (n, d) coordinates."""
    V = X[structure.start] - X[structure.end]
    l = np.linalg.norm(V, axis=1)
    s = l - structure.rest_lengths
    t = structure.stiffness * np.where(structure.tension_only & (s < 0.0), 0.0, s)
    pull = (t / l)[:, None] * V
    g = -structure.loads.copy()
    np.add.at(g, structure.start, pull)
    np.add.at(g, structure.end, -pull)
    return np.abs(g[structure.free]).max() / max(np.abs(t).max(), np.abs(structure.loads).max())


def spans(structure, X):
    """Return the (b,) lengths at (n, d) coordinates."""
    return np.linalg.norm(X[structure.start] - X[structure.end], axis=1)


def exact(family, given, own):
    """Return the lengths that a family's closed form has, or None where the scene is another."""
    if family != "tower":
        return None
    plain = {name: value for name, value in given.items() if name not in ("noise", "seed")}
    _, structure = solving(own, family, plain, 0.0)
    return spans(structure, structure.coordinates)


def judged(found, structure, lengths):
    """Return the verdict, or `wrong` where lengths are known and others."""
    verdict = str(found.verdict)
    if verdict in BALANCED and lengths is not None:
        return (
            verdict if np.abs(spans(structure, found.coordinates) / lengths - 1.0).max() < 1e-6 else "wrong"
        )
    return verdict


def row(name, family, given, arguments, newton=False):
    """Print a row per factor for one scene."""
    lengths = exact(family, given, arguments.now)
    for kind in arguments.factors.split(","):
        options = {"factor": kind, "preconditioner": arguments.preconditioner}
        call, structure = solving(arguments.now, family, given, arguments.limit, **options)
        calls = {"now": (arguments.now, call)}
        if arguments.before:
            old, _ = solving(arguments.before, family, given, arguments.limit, factor=kind)
            calls["before"] = arguments.before, old
        if newton:
            calls["newton"] = arguments.now, by_newton(structure, kind)
        least, found = {name: float("inf") for name in (*calls, "unit")}, {}
        for _ in range(arguments.repeat):
            for what, (version, one) in calls.items():
                if least[what] < float("inf") and least[what] > 5.0:
                    continue  # long enough to be told by one run
                with version:
                    seconds, found[what] = timed(one)
                least[what] = min(least[what], seconds)
            least["unit"] = min(least["unit"], linear_solve(*arrays(structure), repeat=1))
        seconds, now = least["now"], found["now"]
        told = {"before": "", "newton": ""}
        if "before" in found:
            was = judged(found["before"], structure, lengths)
            word = "" if was in BALANCED else was[:3]
            told["before"] = f"{least['before'] / seconds:.2f}{word}"
        if newton:
            X, _ = found["newton"]
            close = imbalance(structure, X) < 1e-9
            if close and lengths is not None:
                close = np.abs(spans(structure, X) / lengths - 1.0).max() < 1e-6
            told["newton"] = f"{least['newton'] / seconds:.2f}{'' if close else 'bad'}"
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        print(
            f"{name:34} {kind:7} {judged(now, structure, lengths):14.14} {now.iterations:5}"
            f" {now.factorizations:7} {int(now.slack.sum()):6} {now.relative:8.0e} {seconds:8.3f}"
            f" {seconds / least['unit']:7.2f} {told['before']:>7} {told['newton']:>7} {peak:5.2f}",
            flush=True,
        )


def numbers(text, kind=float):
    """Return the numbers of a list with commas."""
    return [kind(part) for part in text.split(",")]


def taut(arguments):
    """Nets strained by 9 %, rest lengths 5 % off."""
    for side in numbers(arguments.sides or "30,100,300", int):
        row(f"net {side}", "net", {"side": side, "prestress": 100.0, "jitter": 0.05, "seed": 1}, arguments)


def million(arguments):
    """One net of 10^6 elements; peak memory is the process's."""
    for side in numbers(arguments.sides or "708", int):
        row(f"net {side}", "net", {"side": side, "prestress": 100.0, "jitter": 0.01, "seed": 1}, arguments)


def crossover(arguments):
    """Nets on other seeds, strains and errors than those of the targets."""
    for side in numbers(arguments.sides or "40,60,90,130,200", int):
        for prestress, jitter in ((300.0, 0.02), (30.0, 0.02), (60.0, 0.1)):
            given = {"side": side, "prestress": prestress, "jitter": jitter, "seed": 7}
            row(f"net {side} prestress {prestress:g} jitter {jitter:g}", "net", given, arguments)


def towers(arguments):
    """Towers 5 % off, the second kind strained so little that cables go slack on the way."""
    for stages in numbers(arguments.sides or "10,100,1000", int):
        for prestress, noise in ((100.0, 0.05), (10.0, 0.05), (1.0, 0.05), (10.0, 0.2)):
            given = {"stages": stages, "prestress": prestress, "noise": noise, "seed": 1}
            row(f"tower {stages} prestress {prestress:g} noise {noise:g}", "tower", given, arguments, True)


def slack(arguments):
    """Nets of little strain: prestress over EA, which is 1000; rest lengths 1 % and 5 % off."""
    for side in numbers(arguments.sides or "100,150", int):
        for strain in numbers(arguments.strains):
            for jitter in numbers(arguments.jitters):
                given = {"side": side, "prestress": 1e3 * strain, "jitter": jitter, "seed": 1}
                row(f"net {side} strain {strain:g} jitter {jitter:g}", "net", given, arguments)


def snow(arguments):
    """Nets under snow, rest lengths 1 % off: prestress, snow; all but the first leave cables slack."""
    for side in numbers(arguments.sides or "60,100,150", int):
        for prestress, load in (numbers(pair) for pair in arguments.loads.split()):
            given = {"side": side, "prestress": prestress, "jitter": 0.01, "snow": load, "seed": 1}
            row(f"net {side} prestress {prestress:g} snow {load:g}", "net", given, arguments)


def chains(arguments):
    """Catenaries of 1000 links; EA from 1e4 to 1e9."""
    for links in numbers(arguments.sides or "1000", int):
        for EA in numbers(arguments.EA):
            row(f"catenary {links} EA {EA:g}", "catenary", {"links": links, "EA": EA}, arguments)


PARTS = {own.__name__: own for own in (taut, million, crossover, towers, slack, snow, chains)}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("part", choices=PARTS)
    parser.add_argument("--before", type=Version)
    parser.add_argument("--sides", default="", help="nodes a side, stages or links, with commas")
    parser.add_argument("--strains", default="1e-3,1e-4,1e-5,1e-6")
    parser.add_argument("--jitters", default="0.01,0.05")
    parser.add_argument("--loads", default="10,0.05 1,0.5 0.01,0.01")
    parser.add_argument("--EA", default="1e4,1e5,1e6,1e7,1e8,1e9")
    parser.add_argument("--factors", default="superlu,cholmod")
    parser.add_argument("--preconditioner", default="auto")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--limit", type=float, default=20.0)
    arguments = parser.parse_args()
    arguments.now = Version(ROOT)
    for version in (arguments.now, arguments.before):  # imports, outside the clock
        for kind in arguments.factors.split(",") if version else ():
            call, _ = solving(version, "net", {"side": 20, "jitter": 0.05}, arguments.limit, factor=kind)
            with version:
                call()
    print(HEAD)
    PARTS[arguments.part](arguments)


if __name__ == "__main__":
    main()
