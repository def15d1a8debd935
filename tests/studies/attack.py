"""Scenes of a hostile user through the solver, each answer judged by code that shares nothing with it.

    python tests/studies/attack.py --count 20000 --jobs 2 [--first 0]

Seventeen kinds of scenes (attack_scenes.py), any tolerance, Table I and eq. (10) on a share; warnings of
numpy are errors. A find is told as one line: what is wrong, seed, and the scene as JSON that `cgff solve -`
reads. At the end a table per kind and how often what was found.
"""

import argparse
import json
import math
import signal
import warnings
from collections import Counter
from multiprocessing import Pool
from time import process_time

import numpy as np
from attack_judge import CLEAR, Body
from attack_scenes import attack

import cgff_cli

LIMIT, SLOW = 20.0, 2.0
"""Seconds of processor time, whatever else the machine does, at which a solve is cut off, and slow."""

LONG = 500
"""Iterations that no scene of eight nodes should need."""


class Endless(BaseException):
    """A solve that outlasts the limit; no library code catches it."""


def judged(seed: int) -> tuple[int, str, str, list[tuple[str, str]]]:
    """Return seed, kind, how it ended and what is wrong as (class, detail)."""
    kind, scene = attack(seed)
    warnings.simplefilter("error")
    signal.signal(signal.SIGPROF, stop)
    signal.setitimer(signal.ITIMER_PROF, LIMIT)
    try:
        start = process_time()
        result = cgff_cli.solve(cgff_cli.from_dict(scene))
        seconds = process_time() - start
        signal.setitimer(signal.ITIMER_PROF, 3 * LIMIT)
        found = [("slow", f"{seconds:.1f} s")] if seconds > SLOW else []
        if seed % 5 == 0 and result.converged:
            found += hanging_on_tolerance(scene)
    except cgff_cli.CgffError as refusal:
        return seed, kind, "refused", [] if "balance" in str(refusal) else [("refused", str(refusal))]
    except Endless:
        return seed, kind, "endless", [("endless", f"more than {LIMIT:.0f} s")]
    except Exception as error:
        at = error.__traceback__
        while at.tb_next:
            at = at.tb_next
        place = f"{at.tb_frame.f_code.co_filename.rsplit('/', 1)[-1]}:{at.tb_lineno}"
        return seed, kind, "crashed", [(f"crash at {place}", f"{type(error).__name__}: {error}")]
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
    way = next((v for a, v in scene.get("solver", {}).items() if a != "tolerance"), "default")
    return seed, kind, f"{result.verdict} ({way})", [*found, *complaints(scene, result)]


def stop(*_: object) -> None:
    raise Endless


def complaints(scene, result):
    """Yield what is wrong with a result."""
    body, X = Body(scene), result.coordinates
    yield from (("not finite", where) for where in infinite(result.to_dict()))
    if not np.array_equal(X[~body.free], body.X[~body.free]):
        yield "held moved", f"by {np.abs(X - body.X)[~body.free].max():.1e}"
    analysis = result.analysis
    yield from (("negative count", f"{a}: {v}") for a, v in analysis.items() if type(v) is int and v < 0)
    if not np.isfinite(X).all():
        return
    plain = not {"method", "preconditioner"} & scene.get("solver", {}).keys()
    if plain and result.options["objective"] == "energy" and analysis["stability"] == "unstable":
        yield "left unstable", f"stiffness {analysis['smallest_stiffness']}"
    with np.errstate(all="ignore"):
        if plain and result.counts["iterations"] >= LONG:
            yield "long", f"{result.counts['iterations']} iterations, {result.verdict}"
        if plain and not result.converged:
            yield from ending(body, X, result)
        if result.converged:
            yield from (*balance(body, X, result), *standing(body, X, analysis))


def infinite(value, where=""):
    """Yield the place of every number that is none."""
    if isinstance(value, dict):
        for name, item in value.items():
            yield from infinite(item, f"{where}.{name}")
    elif isinstance(value, (list, tuple)):
        for item in value:
            yield from infinite(item, where)
    elif isinstance(value, float) and not math.isfinite(value):
        yield where


def balance(body, X, result):
    """Yield where forces, reactions and energy of a converged result are not what they are said to be."""
    left, reference, floor = body.residual(X), body.reference(X), body.floor(X)
    if left > result.options["tolerance"] * reference * (1.0 + 1e-6) + 8.0 * floor:
        yield "unbalanced", f"{left / reference:.1e} of the forces, {left / floor:.1e} floors"
    total = np.abs(body.loads.sum(axis=0) + sum(np.array(r) for r in result.reactions.values()))
    if not body.free.all() and total.max() > body.n * (left + 8.0 * floor):
        yield "reactions", f"off by {total.max():.1e}"
    own, size = body.energy(X)
    if abs(own - result.energy) > 1e-9 * size + 8.0 * floor * np.abs(X).max():
        yield "energy", f"{result.energy!r}, by the loop {own!r}"


def ending(body, X, result):
    """Yield where a run that gave up was a few Newton steps from a balanced minimum."""
    there = body.refined(X)
    away = np.abs(there - X).max()
    level = result.options["tolerance"] * body.reference(there) + body.floor(there - there.mean(axis=0))
    if body.residual(there) > level or away > 0.1 * body.size(X) or body.has_points(there, idle=False):
        return
    softest = body.softest(there)
    if softest is not None and softest[0] > -1e-9:
        yield f"gave up: {result.verdict}", f"softest {softest[0]:.1e}, {away:.1e} away"


def standing(body, X, analysis):
    """Yield where counts are not the ranks, or stability not the tangent's of the refined shape."""
    if analysis["rank_tolerance"] <= 1e-8 and not body.has_points(X):
        for name, own in body.counts(X).items():
            if analysis[name] != own:
                yield name, f"{analysis[name]}, by singular values {own}"
    X = body.refined(X)
    if body.residual(X) > 8.0 * body.floor(X) or body.has_points(X, idle=False):
        return
    kind, softest = analysis["stability"], body.softest(X)
    if softest is None:
        return
    slack, taut = softest
    clearly = "stable" if slack > CLEAR else "unstable" if taut < -CLEAR else kind
    if kind != clearly or (kind == "unstable" and slack > -1e-14) or (kind == "stable" and taut < 1e-15):
        yield f"called {kind}", f"softest {slack:.1e} to {taut:.1e} of the stiffest"


def hanging_on_tolerance(scene):
    """Yield where answers that a few Newton steps bring to one shape differ in stability by the tolerance."""
    options, body = {a: v for a, v in scene.get("solver", {}).items() if a == "objective"}, Body(scene)
    ends = [cgff_cli.solve(cgff_cli.from_dict(scene), **options, tolerance=t) for t in (1e-6, 1e-8, 1e-10)]
    with np.errstate(all="ignore"):
        shapes = [body.refined(end.coordinates) for end in ends]
        near = 1e-3 * min(float(length) or np.inf for length, *_ in body.pulls(shapes[-1]))
    kinds = [str(end.analysis["stability"]) for end in ends]
    one = all(np.abs(shape - shapes[-1]).max() <= near for shape in shapes)
    if one and all(end.converged for end in ends) and len(set(kinds)) > 1:
        yield "hangs on tolerance", ", ".join(kinds)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--jobs", type=int, default=1)
    arguments = parser.parse_args()
    seeds = range(arguments.first, arguments.first + arguments.count)
    runs, bad, ends, classes = Counter(), Counter(), Counter(), Counter()
    with Pool(arguments.jobs) as pool:
        for seed, kind, end, found in pool.imap(judged, seeds, chunksize=8):
            runs[kind] += 1
            bad[kind] += bool(found)
            ends[end] += 1
            for name, detail in found:
                classes[name] += 1
                print(f"{name}; {detail}; seed {seed}, {kind}; {json.dumps(attack(seed)[1])}", flush=True)
    print(f"\n{'kind':14}{'scenes':>8}{'as it should be':>18}{'with finds':>12}")
    for kind, count in runs.items():
        print(f"{kind:14}{count:8}{count - bad[kind]:18}{bad[kind]:12}")
    for title, tally in (("ended", ends), ("finds", classes)):
        print(f"\n{title}: " + ", ".join(f"{count} {name}" for name, count in tally.most_common()))


if __name__ == "__main__":
    main()
