"""How many structures a second `solve_many` solves, beside a loop of fsolve and of `solve`.

    OPENBLAS_NUM_THREADS=1 python tests/studies/many.py [--rows 10000] [--repeat 5] [--only prism] [--at-once 512]

Rest lengths of every element scatter by 5 % about the scene's, or starts by 20 % of its size. Microseconds
of CPU time a row, medians of rounds in which all take their turn, rivals on the round's first rows. Every row
of `solve_many` is checked: forces from its coordinates alone, by sums over nodes, against the tolerance or
what rounding explains; `off` counts those that fail, `alone` those that the scalar solver had to solve.
fsolve gets a residual as one would write it, without and with its exact Jacobian; `fails` is how often its
answer balances no better than 1e-8 of the largest force, or of the largest k l where there is none.
"""

import argparse
import statistics
import time
from dataclasses import replace

import numpy as np
from scipy.optimize import fsolve
from versions_in_one import ROOT

import cgff_cli
from cgff_cli.solvers import many
from cgff_cli.structure import from_scene

SPREAD, SCATTER = 0.05, 0.2
SAMPLE = 40


def scenes():
    """Return name -> scene: shipped ones, families, supported and loaded ones."""
    shipped = {name: cgff_cli.load(str(ROOT / "structures" / f"{name}.yaml")) for name in NAMES}
    prism = shipped["prism"]
    return shipped | {
        "net 8": cgff_cli.new("net", side=8),
        "tower 3": cgff_cli.new("tower", stages=3),
        "catenary 6": cgff_cli.new("catenary", links=6),
        "prism held": replace(prism, supports={0: "xyz", 1: "yz", 2: "z"}),
        "prism loaded": replace(prism, supports=dict.fromkeys(range(3), "xyz"), loads={3: (0.3, 0.0, -1.0)}),
    }


NAMES = ("prism", "octahedron", "x-module", "hexagon", "bracket", "cable-net")


def rows(scene, m, seed):
    """Return m rows of rest lengths, and of starts."""
    rng, s = np.random.default_rng(seed), from_scene(scene)
    size = np.ptp(s.coordinates, axis=0).max()
    return {
        "rest_lengths": s.rest_lengths * (1.0 + SPREAD * rng.uniform(-1.0, 1.0, (m, len(s.start)))),
        "coordinates": s.coordinates + SCATTER * size * rng.uniform(-1.0, 1.0, (m, *s.coordinates.shape)),
    }


def balance(s, X, l0):
    """Return (m,) out-of-balance forces over the tolerance's reference, of (m, n, d) and (m, b)."""
    V = X[:, s.start] - X[:, s.end]
    l = np.linalg.norm(V, axis=2)
    t = s.stiffness * (l - l0)
    t[(t < 0.0) & s.tension_only] = 0.0
    pull = V * (t / l)[..., None]
    eta = np.broadcast_to(s.loads, X.shape).copy()
    for e in range(len(s.start)):
        eta[:, s.start[e]] -= pull[:, e]
        eta[:, s.end[e]] += pull[:, e]
    force = np.maximum(np.abs(t).max(1), np.abs(s.loads).max())
    reference = np.where(force > 1e-12 * (s.stiffness * l).max(1), force, (s.stiffness * l).max(1))
    rounding = 64.0 * np.finfo(float).eps * (s.stiffness * l).max(1)
    return np.maximum(np.abs(eta * s.free).max((1, 2)) - rounding, 0.0) / reference


def by_fsolve(s, X, l0, exact):
    """Return fsolve's (n, d) answer from X (n, d)."""
    b, free = np.arange(len(s.start)), s.free.ravel()
    C = np.zeros((len(b), len(X)))
    C[b, s.start], C[b, s.end] = 1.0, -1.0
    full, d = X.copy(), X.shape[1]

    def parts(x):
        full[s.free] = x
        V = C @ full
        l = np.sqrt((V * V).sum(axis=1))
        t = s.stiffness * (l - l0)
        t[(t < 0.0) & s.tension_only] = 0.0
        return V, l, t

    def residual(x):
        V, l, t = parts(x)
        return (C.T @ (V * (t / l)[:, None]) - s.loads).ravel()[free]

    def jacobian(x):
        V, l, t = parts(x)
        q = t / l
        A = (C[:, :, None] * V[:, None, :]).reshape(len(b), -1)
        stiff = np.where((t == 0.0) & s.tension_only, 0.0, s.stiffness - q) / (l * l)
        K = A.T @ (stiff[:, None] * A) + np.kron(C.T @ (q[:, None] * C), np.eye(d))
        return K[np.ix_(free, free)]

    full[s.free] = fsolve(residual, X[s.free], fprime=jacobian if exact else None, xtol=1e-12)
    return full


def by_solve(scene, values, name):
    """Return a call that solves one row with `solve`, its scene made outside the clock."""
    firsts = np.cumsum([0, *(len(group.EA) for group in scene.groups)])

    def changed(row):
        if name == "coordinates":
            return replace(scene, coordinates=values[row])
        pieces = zip(scene.groups, firsts[:-1], firsts[1:], strict=True)
        groups = tuple(replace(group, rest_length=values[row][i:j]) for group, i, j in pieces)
        return replace(scene, groups=groups)

    return changed


def clocked(call):
    """Return CPU seconds and the answer of a call."""
    start = time.process_time()
    answer = call()
    return time.process_time() - start, answer


def measured(scene, name, arguments):
    """Print a line for one scene and what varies."""
    s, m = from_scene(scene), max(200, min(arguments.rows, 10 * arguments.rows // int(s_size(scene))))
    times, failures = {}, {"fsolve": [], "exact": []}
    off = alone = 0
    cgff_cli.solve_many(scene)
    for seed in range(arguments.repeat):
        values = rows(scene, m, seed)[name]
        seconds, found = clocked(lambda values=values: cgff_cli.solve_many(scene, **{name: values}))
        times.setdefault("many", []).append(seconds / m)
        l0 = values if name == "rest_lengths" else np.broadcast_to(s.rest_lengths, (m, len(s.start)))
        off += int((found.converged & (balance(s, found.coordinates, l0) > 1e-10)).sum())
        alone += int(found.alone.sum())
        changed = by_solve(scene, values, name)
        few = [changed(row) for row in range(SAMPLE)]
        seconds, _ = clocked(lambda few=few: [cgff_cli.solve(one, analysis="never") for one in few])
        times.setdefault("solve", []).append(seconds / SAMPLE)
        for rival in failures:
            with np.errstate(all="ignore"):
                seconds, answers = clocked(
                    lambda rival=rival, few=few, l0=l0: [
                        by_fsolve(s, one.coordinates, l0[row], rival == "exact")
                        for row, one in enumerate(few)
                    ]
                )
                failures[rival] += (balance(s, np.stack(answers), l0[:SAMPLE]) > 1e-8).tolist()
            times.setdefault(rival, []).append(seconds / SAMPLE)
    return m, times, failures, off, alone, found


def s_size(scene):
    """Return how many times a prism's elements a scene has."""
    return max(1, scene.element_count // 12)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=int, default=10000)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--only", default="")
    parser.add_argument("--at-once", type=int, default=many.AT_ONCE)
    arguments = parser.parse_args()
    many.AT_ONCE = arguments.at_once
    print(
        f"{'':27}{'rows':>6}{'us':>7}{'a second':>9}{'solve':>7}{'fsolve':>7}{'exact':>7}   alone off   fails"
    )
    for title, scene in scenes().items():
        if arguments.only not in title:
            continue
        for name in ("rest_lengths", "coordinates"):
            m, times, failures, off, alone, _ = measured(scene, name, arguments)
            us = {key: 1e6 * statistics.median(values) for key, values in times.items()}
            ratios = "".join(f"{us[key] / us['many']:6.1f}x" for key in ("solve", "fsolve", "exact"))
            fails = " ".join(f"{100 * np.mean(values):.0f}%" for values in failures.values())
            share = alone / (m * arguments.repeat)
            print(
                f"{title:14}{name:13}{m:6}{us['many']:7.0f}{1e6 / us['many']:9.0f}{ratios}"
                f"{100 * share:7.1f}%{off:4}   {fails}",
                flush=True,
            )


if __name__ == "__main__":
    main()
