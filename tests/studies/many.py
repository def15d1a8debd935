"""How many structures a second `solve_many` solves, beside a loop of fsolve and of `solve`.

    OPENBLAS_NUM_THREADS=1 python tests/studies/many.py [--rows 10000] [--repeat 5] [--only prism]
        [--entries 512]

Rest lengths of every element scatter by 5 % about the scene's, or starts by 20 % of its size. Microseconds
of CPU time a row, medians of rounds in which all take their turn, rivals on the round's first rows; beside
them how many times longer others take: `solve_many` that tells no stability, a loop of
`solve(analysis="never")`, and fsolve without and with its exact Jacobian, on a residual as one would write
it and on the program's own State. Every row of `solve_many` is checked: forces from its coordinates alone,
summed over nodes, against the tolerance and what rounding explains. `off`: rows that fail, or are no
equilibrium; `alone`: those that the scalar solver had to solve; `fails`: percent of the rivals' answers that
balance no better than 1e-8.
"""

import argparse
import statistics
import time
from collections import defaultdict
from dataclasses import replace
from functools import partial

import numpy as np
from scipy.optimize import fsolve
from versions_in_one import ROOT

import cgff_cli
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.solvers.many import loop as many
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


def balance(s, X, k, l0):
    """Return (m,) out-of-balance forces over the tolerance's reference: X (m, n, d), k and l0 (m, b)."""
    V = X[:, s.start] - X[:, s.end]
    l = np.linalg.norm(V, axis=2)
    t = k * (l - l0)
    t[(t < 0.0) & s.tension_only] = 0.0
    pull = V * (t / l)[..., None]
    eta = np.broadcast_to(s.loads, X.shape).copy()
    for e in range(len(s.start)):
        eta[:, s.start[e]] -= pull[:, e]
        eta[:, s.end[e]] += pull[:, e]
    force, largest = np.maximum(np.abs(t).max(1), np.abs(s.loads).max()), (k * l).max(1)
    rounding = 64.0 * np.finfo(float).eps * largest
    reference = np.where(force > 1e-12 * largest, force, largest)
    return np.maximum(np.abs(eta * s.free).max((1, 2)) - rounding, 0.0) / reference


def by_fsolve(s, X, exact):
    """Return fsolve's (n, d) answer for a structure from X (n, d)."""
    b, free = np.arange(len(s.start)), s.free.ravel()
    C = np.zeros((len(b), len(X)))
    C[b, s.start], C[b, s.end] = 1.0, -1.0
    full, d = X.copy(), X.shape[1]

    def parts(x):
        full[s.free] = x
        V = C @ full
        l = np.sqrt((V * V).sum(axis=1))
        t = s.stiffness * (l - s.rest_lengths)
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


def by_fsolve_on_state(s, exact):
    """Return fsolve's (n, d) answer on the program's own State, as `small_rulers` has it."""
    mechanics = Mechanics(s)
    x0, dofs = mechanics.start.ravel(), mechanics.dofs

    def at(x):
        full = x0.copy()
        full[dofs] = x
        return mechanics.at(full.reshape(mechanics.start.shape))

    def jacobian(x):
        return at(x).dense_tangent()[np.ix_(dofs, dofs)]

    fprime = jacobian if exact else None
    x = fsolve(lambda x: at(x).g.ravel()[dofs], x0[dofs], fprime=fprime, xtol=1e-12)
    return mechanics.shape(at(x).X) + mechanics.frame.centre


def changed(scene, values, name, row):
    """Return the scene of a row."""
    if name == "coordinates":
        return replace(scene, coordinates=values[row])
    firsts = np.cumsum([0, *(len(group.EA) for group in scene.groups)])
    pieces = zip(scene.groups, firsts[:-1], firsts[1:], strict=True)
    return replace(scene, groups=tuple(replace(g, rest_length=values[row][i:j]) for g, i, j in pieces))


def rivals(few):
    """Return name -> a call that solves each of some scenes; structures are made outside the clock."""
    structures = [from_scene(one) for one in few]
    return {
        "solve": lambda: [cgff_cli.solve(one, analysis="never").coordinates for one in few],
        "fsolve": lambda: [by_fsolve(s, s.coordinates, False) for s in structures],
        "exact": lambda: [by_fsolve(s, s.coordinates, True) for s in structures],
        "on State": lambda: [by_fsolve_on_state(s, False) for s in structures],
        "exact on State": lambda: [by_fsolve_on_state(s, True) for s in structures],
    }


def clocked(call):
    """Return CPU seconds and the answer of a call."""
    start = time.process_time()
    with np.errstate(all="ignore"):
        answer = call()
    return time.process_time() - start, answer


def measured(scene, name, arguments):
    """Return rows a round, seconds a row by name, failures by name, rows off balance, and rows alone."""
    s, m = from_scene(scene), max(200, arguments.rows * 12 // scene.element_count)
    EA = np.concatenate([group.EA for group in scene.groups])
    times, failures, off, alone = defaultdict(list), defaultdict(list), 0, 0
    cgff_cli.solve_many(scene)
    for seed in range(arguments.repeat):
        values = rows(scene, m, seed)[name]
        for told in ("auto", "never"):
            call = partial(cgff_cli.solve_many, scene, analysis=told, **{name: values})
            seconds, found = clocked(call)
            times[told].append(seconds / m)
        l0 = values if name == "rest_lengths" else np.broadcast_to(s.rest_lengths, (m, len(s.start)))
        k = np.broadcast_to(EA, l0.shape) if scene.law == "paper" else EA / l0
        off += int((found.converged & (balance(s, found.coordinates, k, l0) > 1e-10)).sum())
        off += int((~found.converged).sum())
        alone += int(found.alone.sum())
        few = [changed(scene, values, name, row) for row in range(SAMPLE)]
        for rival, call in rivals(few).items():
            seconds, answers = clocked(call)
            times[rival].append(seconds / SAMPLE)
            failures[rival] += (balance(s, np.stack(answers), k[:SAMPLE], l0[:SAMPLE]) > 1e-8).tolist()
    return m, times, failures, off, alone


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rows", type=int, default=10000)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--only", default="")
    parser.add_argument("--entries", type=int, default=many.ENTRIES)
    arguments = parser.parse_args()
    many.ENTRIES = arguments.entries
    names = ("never", "solve", "fsolve", "exact", "on State", "exact on State")
    heads = "".join(f"{name:>15}" if " on" in name else f"{name:>9}" for name in names)
    print(f"{'':27}{'rows':>6}{'us':>6}{'a second':>9}{heads}{'alone':>8}{'off':>5}   fails", flush=True)
    for title, scene in scenes().items():
        if arguments.only not in title:
            continue
        for name in ("rest_lengths", "coordinates"):
            m, times, failures, off, alone = measured(scene, name, arguments)
            us = {key: 1e6 * statistics.median(values) for key, values in times.items()}
            ratios = "".join(f"{us[key] / us['auto']:{14 if ' on' in key else 8}.1f}x" for key in names)
            fails = " ".join(f"{100.0 * np.mean(values):.0f}" for values in failures.values())
            print(
                f"{title:14}{name:13}{m:6}{us['auto']:6.0f}{1e6 / us['auto']:9.0f}{ratios}"
                f"{100.0 * alone / (m * arguments.repeat):7.1f}%{off:5}   {fails} %",
                flush=True,
            )


if __name__ == "__main__":
    main()
