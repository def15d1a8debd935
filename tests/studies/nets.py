"""Anchored cable nets: time to 1e-10 in linear force density solves, and how it grows.

    OPENBLAS_NUM_THREADS=1 python tests/studies/nets.py [--sides 30,100] [--jitter 0.05] [--prestress 100,1]

One linear force density solve is a SuperLU factor of the n x n force density matrix and three solves with
it, of the same net in the same process: `linear` with the ordering and panels that cgff uses, `plain` with
scipy's defaults. The smallest of three runs counts on either side. Peak memory is the whole process's; run
one side per process to read it.
"""

import argparse
import resource
import time
from functools import partial

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

import cgff_cli
from cgff_cli.mechanics.pattern import GraphPattern
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.cgff import form_find
from cgff_cli.structure import from_scene

TUNED = {
    "permc_spec": "MMD_AT_PLUS_A",
    "diag_pivot_thresh": 0.0,
    "panel_size": 4,
    "options": {"SymmetricMode": True},
}

HEAD = (
    f"{'side':>5} {'elements':>8} {'prestress':>9} {'factor':8} {'verdict':14} {'iterations':>10}"
    f" {'factors':>7} {'slack':>6} {'seconds':>8} {'linear':>7} {'ratio':>6}"
    f" {'plain':>7} {'ratio':>6} {'GB':>5}"
)


def least_seconds(call, repeat):
    best = float("inf")
    for _ in range(repeat):
        start = time.perf_counter()
        result = call()
        best = min(best, time.perf_counter() - start)
    return best, result


def linear_solve(structure, **how):
    """Return a call that makes one linear force density solve."""
    moves = structure.free[:, 0]
    pattern = GraphPattern(structure.start, structure.end, np.where(moves, np.cumsum(moves) - 1, -1))
    k = structure.stiffness
    rhs = np.ones(pattern.size)

    def call():
        lu = splu(csc_array((pattern.fill(k, k, -k), pattern.indices, pattern.indptr)), **how)
        for _ in range(3):
            lu.solve(rhs)

    return call


def study(side, prestress, arguments):
    """Print one row per factor for a net of this side and prestress."""
    given = {"jitter": arguments.jitter, "snow": arguments.snow, "prestress": prestress}
    structure = from_scene(cgff_cli.new("net", side=side, seed=1, **given))
    runs = []
    for factor in arguments.factors.split(","):
        call = partial(form_find, structure, SolveOptions(factor=factor))
        runs.append((factor, *least_seconds(call, arguments.repeat)))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
    linear, _ = least_seconds(linear_solve(structure, **TUNED), arguments.repeat)
    plain, _ = least_seconds(linear_solve(structure), arguments.repeat)
    for factor, seconds, found in runs:
        print(
            f"{side:5} {len(structure.start):8} {prestress:9g} {factor:8} {found.verdict:14}"
            f" {found.iterations:10} {found.factorizations:7} {int(found.slack.sum()):6}"
            f" {seconds:8.3f} {linear:7.3f} {seconds / linear:6.2f}"
            f" {plain:7.3f} {seconds / plain:6.2f} {peak:5.2f}",
            flush=True,
        )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sides", default="30,100,300")
    parser.add_argument("--jitter", type=float, default=0.05)
    parser.add_argument("--snow", type=float, default=0.0)
    parser.add_argument("--prestress", default="100")
    parser.add_argument("--factors", default="superlu,cholmod")
    parser.add_argument("--repeat", type=int, default=3)
    arguments = parser.parse_args()
    print(HEAD)
    for side in map(int, arguments.sides.split(",")):
        for prestress in map(float, arguments.prestress.split(",")):
            study(side, prestress, arguments)


if __name__ == "__main__":
    main()
