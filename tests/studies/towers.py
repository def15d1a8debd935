"""Prism towers from 5 % off: to 1e-10 or the rounding floor; beside scipy's L-BFGS-B on the same energy.

    OPENBLAS_NUM_THREADS=1 python tests/studies/towers.py [--stages 10,100,1000] [--noise 0.05]

Both start from the same shape in one process. L-BFGS-B is stopped as soon as its largest out-of-balance
force is 1e-6 of the largest force, or at --limit seconds.
"""

import argparse
import time
from contextlib import suppress

import numpy as np
from scipy.optimize import minimize

import cgff_cli
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.cgff import form_find
from cgff_cli.structure import from_scene


class ThereError(Exception):
    """L-BFGS-B is there, or out of time."""


def lbfgs(structure, goal, limit):
    """Return seconds, evaluations and the relative residual that L-BFGS-B reached."""
    mechanics = Mechanics(structure)
    shape = mechanics.start.shape
    start = time.perf_counter()
    seen = {"evaluations": 0, "relative": np.inf}

    def energy_and_gradient(x):
        state = mechanics.at(x.reshape(shape))
        seen["evaluations"] += 1
        seen["relative"] = float(np.abs(state.g).max() / np.abs(state.t).max())
        if seen["relative"] <= goal or time.perf_counter() - start > limit:
            raise ThereError
        return state.energy, state.g.reshape(-1)

    options = {"maxiter": 10**7, "maxfun": 10**7, "ftol": 0.0, "gtol": 0.0, "maxcor": 20}
    x0 = mechanics.start.reshape(-1)
    with suppress(ThereError):
        minimize(energy_and_gradient, x0, jac=True, method="L-BFGS-B", options=options)
    return time.perf_counter() - start, seen["evaluations"], seen["relative"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--stages", default="10,100,1000")
    parser.add_argument("--noise", type=float, default=0.05)
    parser.add_argument("--factor", default="superlu")
    parser.add_argument("--limit", type=float, default=60.0)
    arguments = parser.parse_args()
    form_find(from_scene(cgff_cli.new("tower", stages=40, noise=0.01)), SolveOptions())  # imports
    print(
        f"{'stages':>6} {'elements':>8} {'verdict':14} {'iterations':>10} {'residual':>9} {'floor':>8}"
        f" {'length error':>12} {'seconds':>8} |"
        f" L-BFGS-B {'reached':>8} {'calls':>6} {'seconds':>8} {'ratio':>6}"
    )
    for stages in map(int, arguments.stages.split(",")):
        exact = from_scene(cgff_cli.new("tower", stages=stages))
        lengths = np.linalg.norm(exact.coordinates[exact.start] - exact.coordinates[exact.end], axis=1)
        structure = from_scene(cgff_cli.new("tower", stages=stages, noise=arguments.noise, seed=1))
        start = time.perf_counter()
        found = form_find(structure, SolveOptions(factor=arguments.factor))
        seconds = time.perf_counter() - start
        error = float(np.abs(found.lengths / lengths - 1.0).max())
        other, calls, reached = lbfgs(structure, 1e-6, arguments.limit)
        print(
            f"{stages:6} {len(lengths):8} {found.verdict:14} {found.iterations:10}"
            f" {found.residual_max / found.reference:9.1e} {found.floor / found.reference:8.1e}"
            f" {error:12.1e} {seconds:8.2f} |"
            f"          {reached:8.1e} {calls:6} {other:8.2f} {other / seconds:6.1f}",
            flush=True,
        )


if __name__ == "__main__":
    main()
