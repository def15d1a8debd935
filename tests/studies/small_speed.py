"""In-process time of the prism to 1e-10: cgff beside scipy's fsolve and root(method="lm").

    python tests/studies/small_speed.py [--repeat 200]

All start from the scene's own first guess and use the same vectorised residual, a `State`'s. The rivals
run in turn, so that drift hits all alike; medians and ratios are printed.
"""

import argparse
import statistics
import time
from pathlib import Path

import numpy as np
from scipy.optimize import fsolve, root

import cgff_cli
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.cgff import form_find
from cgff_cli.structure import from_scene

PRISM = Path(__file__).parents[2] / "structures" / "prism.yaml"


def rivals(path):
    """Return name -> a call that solves the scene and returns its largest relative residual."""
    scene = cgff_cli.load(str(path))
    structure = from_scene(scene)
    mechanics = Mechanics(structure)
    x0, shape = mechanics.start.ravel(), mechanics.start.shape

    def residual(x):
        return mechanics.at(x.reshape(shape)).g.ravel()

    def jacobian(x):
        return mechanics.at(x.reshape(shape)).dense_tangent()

    def relative(x):
        state = mechanics.at(x.reshape(shape))
        return np.abs(state.g).max() / np.abs(state.t).max()

    options = SolveOptions(analysis="never")
    return {
        "cgff, solver": lambda: form_find(structure, options).residual_max / 7.0,
        "cgff, solve() with analysis": lambda: cgff_cli.solve(scene).residual["relative"],
        "fsolve": lambda: relative(fsolve(residual, x0, xtol=1e-12)),
        "fsolve, exact Jacobian": lambda: relative(fsolve(residual, x0, fprime=jacobian, xtol=1e-12)),
        "root lm, exact Jacobian": lambda: relative(
            root(residual, x0, jac=jacobian, method="lm", options={"xtol": 1e-12, "ftol": 1e-14}).x
        ),
        "root lm": lambda: relative(root(residual, x0, method="lm", options={"xtol": 1e-12}).x),
    }


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=200)
    parser.add_argument("--scene", default=PRISM)
    arguments = parser.parse_args()
    calls = rivals(arguments.scene)
    times = {name: [] for name in calls}
    for _ in range(arguments.repeat):
        for name, call in calls.items():
            start = time.perf_counter()
            call()
            times[name].append(time.perf_counter() - start)
    base = statistics.median(times["cgff, solver"])
    print(f"{'':30}{'median ms':>10}{'ratio':>8}{'residual':>11}")
    for name, call in calls.items():
        median = statistics.median(times[name])
        print(f"{name:30}{1e3 * median:10.3f}{median / base:8.2f}{call():11.1e}")


if __name__ == "__main__":
    main()
