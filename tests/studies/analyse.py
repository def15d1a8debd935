"""What `cgff analyse` tells, beside theory and beside code that shares nothing with it.

    python tests/studies/analyse.py known
    python tests/studies/analyse.py random [--count 300] [--seed 0]
    python tests/studies/analyse.py buckling
    python tests/studies/analyse.py large [--factor superlu]

known: states, mechanisms and stability of structures by theory. random: random structures solved, their
eigenvalues, prestress-stability, load factors, factors of first slack and sensitivities by matrices made
element by element, a general eigensolver and differences of solves. buckling: columns of many links, and
arches beside their limit load. large: factors of sparse matrices, and seconds beside one factor of K.
"""

import argparse
import os
import statistics
import sys
from dataclasses import replace
from math import cos, pi, sqrt
from pathlib import Path
from time import perf_counter

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[2]))

import numpy as np
import scipy.linalg

import cgff_cli
from cgff_cli.analysis import large as analysis_large
from cgff_cli.analysis import nulls
from cgff_cli.mechanics.pattern import TangentPattern
from cgff_cli.solvers import factors
from tests.analysis.known import KNOWN
from tests.analysis.test_buckling import arch, column
from tests.analysis.test_sensitivity import by_differences
from tests.bodies import scene


class Matrices:
    """K, K_G and U over the free directions of a shape, made element by element, and its loads."""

    def __init__(self, structure, X):
        self.s, self.X = structure, X
        self.free = np.flatnonzero(structure.free.reshape(-1))
        self.l, self.u, self.t, self.taut = [], [], [], []
        for e in range(len(structure.start)):
            v = X[structure.start[e]] - X[structure.end[e]]
            length = float(np.sqrt(v @ v))
            stretch = length - structure.rest_lengths[e]
            self.taut.append(not (structure.tension_only[e] and stretch < 0.0))
            self.l.append(length)
            self.u.append(v / length)
            self.t.append(structure.stiffness[e] * stretch if self.taut[-1] else 0.0)
        self.K = self.summed(self._whole)
        self.F = structure.loads.reshape(-1)[self.free]

    def _whole(self, e):
        """Return (k - q) u u' + q I of an element."""
        k, q = (self.s.stiffness[e] if self.taut[e] else 0.0), self.t[e] / self.l[e]
        return (k - q) * np.outer(self.u[e], self.u[e]) + q * np.eye(len(self.u[e]))

    def stress(self, q):
        """Return K_G of force densities."""
        return self.summed(lambda e: q[e] * np.eye(len(self.u[e])))

    def summed(self, block):
        n, d = self.X.shape
        A = np.zeros((n, d, n, d))
        for e, (i, j) in enumerate(zip(self.s.start, self.s.end, strict=True)):
            B = block(e)
            A[i, :, i] += B
            A[j, :, j] += B
            A[i, :, j] -= B
            A[j, :, i] -= B
        return A.reshape(n * d, n * d)[np.ix_(self.free, self.free)]

    def equilibrium(self):
        """Return U over taut elements."""
        n, d = self.X.shape
        columns = []
        for e, (i, j) in enumerate(zip(self.s.start, self.s.end, strict=True)):
            if self.taut[e]:
                column_ = np.zeros((n, d))
                column_[i], column_[j] = self.u[e], -self.u[e]
                columns.append(column_.reshape(-1)[self.free])
        return np.array(columns).T

    def load_factor(self):
        """Return the least positive root of the pencil by a general eigensolver, None without."""
        G = self.stress(self.force_changes() / self.l)
        roots = scipy.linalg.eigvals(self.K - G, -G)
        roots = roots[np.isfinite(roots)]
        real = roots.real[np.abs(roots.imag) <= 1e-7 * np.abs(roots)]
        real = real[(real > 1e-9) & (real < 1e9)]
        return float(real.min()) if len(real) else None

    def force_changes(self):
        """Return what the loads change forces by, K at hand."""
        full = np.zeros(self.X.size)
        full[self.free] = np.linalg.solve(self.K, self.F)
        z = full.reshape(self.X.shape)
        return np.array(
            [
                (self.s.stiffness[e] if self.taut[e] else 0.0) * (self.u[e] @ (z[i] - z[j]))
                for e, (i, j) in enumerate(zip(self.s.start, self.s.end, strict=True))
            ]
        )

    def slack_factor(self):
        """Return the least factor above 1 at which a cable has lost its force, None without."""
        changes = self.force_changes()
        rounding = 1e-9 * np.abs(changes).max()
        factors = [
            1.0 - t / change
            for t, change, is_cable in zip(self.t, changes, self.s.tension_only, strict=True)
            if is_cable and t > 0.0 and change < -rounding
        ]
        return min((factor for factor in factors if factor < 1e9), default=None)


def known():
    wrong = 0
    print(
        f"{'structure':42}{'states':>8}{'theory':>8}{'mechanisms':>12}{'theory':>8}  {'stability':10}theory"
    )
    for one in KNOWN:
        told = cgff_cli.analyse(one.scene).analysis
        ours = told["self_stress_states"], told["mechanisms"], told["stability"], told["negative_eigenvalues"]
        theirs = one.states, one.mechanisms, one.word, one.unstable
        m = Matrices(cgff_cli.analyse(one.scene).result.structure, one.scene.coordinates)
        values = np.linalg.eigvalsh(m.K)
        negative = int((values < -1e-9 * np.abs(values).max()).sum())
        fine = ours == theirs and negative == one.unstable
        wrong += not fine
        print(
            f"{one.name:42}{ours[0]:8}{theirs[0]:8}{ours[1]:12}{theirs[1]:8}  {ours[2]:10}{theirs[2]:10}"
            f"{'' if fine else 'NO'}"
        )
    print(f"{len(KNOWN) - wrong} of {len(KNOWN)} as theory says, and with as many negative eigenvalues")


def random_scene(rng):
    """Return a random loaded structure, held at two or three nodes."""
    d, nodes = int(rng.integers(2, 4)), int(rng.integers(4, 9))
    X = rng.uniform(-1.0, 1.0, (nodes, d))
    every = [(i, j) for i in range(nodes) for j in range(i)]
    count = min(len(every), int(rng.integers(d * nodes - d, d * nodes + 4)))
    bars = []
    for row in rng.choice(len(every), count, replace=False):
        i, j = every[row]
        rest = float(np.linalg.norm(X[i] - X[j])) * (1.0 + rng.uniform(-0.15, 0.1))
        bars.append((i, j, str(rng.choice(["cable", "strut", "strut"])), float(rng.uniform(1.0, 10.0)), rest))
    supports = dict.fromkeys(range(d), "xyz"[:d])
    loads = {row: 0.2 * rng.normal(size=d) for row in range(d, nodes)}
    return scene(X, bars, supports, loads, str(rng.choice(["paper", "hooke"])))


def off(ours, theirs):
    size = np.abs(theirs).max()
    return float(np.abs(np.asarray(ours) - theirs).max() / size) if size else 0.0


def random(count, seed):
    rng = np.random.default_rng(seed)
    worst = {"eigenvalues": [], "load factors": [], "slack factors": [], "motions": [], "forces": []}
    tally = dict.fromkeys(("balanced", "unstable", "factors", "without", "untold", "prestress", "wrong"), 0)
    for number in range(count):
        body = random_scene(rng)
        objective = "residual" if number % 3 == 0 else "energy"
        result = cgff_cli.solve(body, tolerance=1e-12, objective=objective, analysis="never")
        if not result.converged:
            continue
        tally["balanced"] += 1
        told = cgff_cli.analyse(result, modes=2).analysis
        m = Matrices(result.structure, result.coordinates)
        values = np.linalg.eigvalsh(m.K)
        worst["eigenvalues"].append(off(told["tangent_eigenvalues"], values[:6]))
        clear = np.abs(values).min() > 1e-9 * np.abs(values).max()
        if clear:
            fine = told["negative_eigenvalues"] == int((values < 0.0).sum())
            fine &= told["stability"] == ("stable" if values[0] > 0.0 else "unstable")
            tally["unstable"] += bool(values[0] < 0.0)
            fine &= _factor_is_right(told, m, tally, worst)
            fine &= _slack_is_right(told, m, worst)
            fine &= _prestress_is_right(told, m, tally)
            tally["wrong"] += not fine
            if not fine:
                print("not as the other code says:", number, told["stability"], told["critical_load_factor"])
        if clear and values[0] > 1e-3 * values[-1] and not result.slack.any():
            of = body.groups[int(rng.integers(len(body.groups)))].name
            own = result.sensitivity(of)
            moves, changes = by_differences(body, of, result.coordinates)
            worst["motions"].append(off(own.coordinates, moves))
            worst["forces"].append(off(own.forces, changes))
    print(tally)
    for name, own in worst.items():
        print(
            f"{name:14}{len(own):6} compared, relative difference: median {statistics.median(own):.1e}, "
            f"largest {max(own):.1e}"
        )


def _factor_is_right(told, m, tally, worst):
    ours, theirs = told["critical_load_factor"], m.load_factor()
    if ours is None:
        why = told["reason"]["critical_load_factor"]
        tally["untold" if "neither" in why else "without"] += 1
        return theirs is None or "neither" in why
    tally["factors"] += 1
    worst["load factors"].append(off([ours], np.array([theirs or 1e300])))
    return theirs is not None and worst["load factors"][-1] < 1e-5


def _slack_is_right(told, m, worst):
    ours, theirs = told["first_slack_factor"], m.slack_factor()
    if ours is None or theirs is None:
        return ours is theirs
    worst["slack factors"].append(off([ours], np.array([theirs])))
    return worst["slack factors"][-1] < 1e-5


def _prestress_is_right(told, m, tally):
    left, singular, _ = np.linalg.svd(m.equilibrium())
    still = left[:, int((singular > 1e-8).sum()) :]
    if not still.shape[1]:
        return told["prestress_stable"] is True and told["mechanisms"] == 0
    tally["prestress"] += 1
    G = m.stress(np.array(m.t) / m.l)
    least = float(np.linalg.eigvalsh(still.T @ G @ still)[0])
    if abs(least) < 1e-9 * np.abs(G).max():
        return told["prestress_stable"] is not True or told["stability"] == "stable"
    return told["prestress_stable"] == (least > 0.0)


def buckling():
    print("columns of links on springs: factor, theory, relative difference")
    for links in (2, 5, 20, 100, 400):
        load = 0.5
        step = 2.0 - load / 1000.0
        theory = 3.0 * step / (load * (2.0 + 2.0 * cos(pi / links)))
        ours = cgff_cli.analyse(column(links, load)).analysis["critical_load_factor"]
        print(f"{links:6}{ours:14.8f}{theory:14.8f}{abs(ours / theory - 1.0):10.1e}")
    print("arch 4 wide and 1 high, k 100: load, factor x load, limit load by theory")
    for load in (0.01, 0.1, 1.0, 3.0):
        body, half, _, k, *_ = arch(load)
        rest = float(body.groups[0].rest_length[0])
        # 2 k (rest / l - 1) y is largest where l^3 = rest half^2.
        l = (rest * half**2) ** (1.0 / 3.0)
        limit = 2.0 * k * (rest / l - 1.0) * sqrt(l * l - half**2)
        ours = cgff_cli.analyse(body).analysis["critical_load_factor"]
        print(f"{load:6}{ours * load:12.4f}{limit:12.4f}")


class Counted:
    """How many sparse matrices are factored, and the seconds it takes."""

    def __init__(self):
        self.tangents = self.others = 0
        for kind in (factors._SuperLU, factors._Cholmod):
            kind.factor = self._counting(kind.factor, "tangents")
        nulls.shifted_factor = analysis_large.shifted_factor = self._counting(nulls.shifted_factor, "others")

    def _counting(self, call, name):
        def counting(*arguments, **options):
            setattr(self, name, getattr(self, name) + 1)
            return call(*arguments, **options)

        return counting


def large(factor):
    tower, net = cgff_cli.new("tower", stages=1000), cgff_cli.new("net", side=100)
    snow = dict.fromkeys(range(len(net.node_names)), (0.0, 0.0, -1e-4))
    feet, heads = range(3), range(3000, 3003)
    pushed = {"supports": dict.fromkeys(feet, "xyz"), "loads": dict.fromkeys(heads, (0.0, 0.0, -1e-6))}
    scenes = {
        "tower, 1000 stages": tower,
        "tower, 100 stages, loaded": replace(
            cgff_cli.new("tower", stages=100),
            supports=dict.fromkeys(feet, "xyz"),
            loads=dict.fromkeys(range(300, 303), (0.0, 0.0, -1e-4)),
        ),
        "tower, 1000 stages, loaded": replace(tower, **pushed),
        "net of 100 a side": net,
        "net of 100 a side, snow": replace(net, loads=snow),
    }
    counted = Counted()
    print(f"{'':28}{'of K':>6}{'others':>8}{'one, s':>10}{'all, s':>10}{'ratio':>8}  stability, null")
    for name, body in scenes.items():
        result = cgff_cli.solve(body, analysis="never", factor=factor)
        one, seconds = _seconds_of_a_factor(result.solution.state, factor), []
        for _ in range(3):
            counted.tangents = counted.others = 0
            start = perf_counter()
            told = cgff_cli.analyse(result, factor=factor).analysis
            seconds.append(perf_counter() - start)
        whole = statistics.median(seconds)
        print(
            f"{name:28}{counted.tangents:6}{counted.others:8}{one:10.4f}{whole:10.3f}{whole / one:8.1f}  "
            f"{told['stability']}, {', '.join(told['reason']) or 'nothing'}",
            flush=True,
        )


def _seconds_of_a_factor(state, kind):
    pattern = TangentPattern(state.mechanics)
    data = pattern.fill(*state.parts()[1:])
    data[pattern.diagonal] += 1e-9 * data.max()
    own, seconds = factors.factory(pattern.indices, pattern.indptr, kind), []
    for _ in range(6):
        start = perf_counter()
        own.factor(data)
        seconds.append(perf_counter() - start)
    return statistics.median(seconds[1:])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("what", choices=("known", "random", "buckling", "large"))
    parser.add_argument("--count", type=int, default=300)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--factor", default="superlu", choices=("superlu", "cholmod"))
    asked = parser.parse_args()
    own = {"random": (asked.count, asked.seed), "large": (asked.factor,)}
    {"known": known, "random": random, "buckling": buckling, "large": large}[asked.what](
        *own.get(asked.what, ())
    )


if __name__ == "__main__":
    main()
