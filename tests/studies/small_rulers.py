"""Small scenes by the whole call, beside an older version, a plain Newton, and scipy's solvers.

    git worktree add /tmp/before 814ae4d
    OPENBLAS_NUM_THREADS=1 python tests/studies/small_rulers.py --before /tmp/before [--repeat 40]

`cgff_cli.solve(scene, analysis="never")` from a scene in memory to a Result, tolerance 1e-10; in turn with
`yardsticks.dense_newton`, which gets the same arrays ready made, with fsolve and root(method="lm"), exact
Jacobian, on the same State. Medians of wall time; ratios to the present version.
"""

import argparse
import statistics
import time
from dataclasses import replace
from importlib import import_module
from pathlib import Path

import numpy as np
from scipy.optimize import fsolve, root
from versions_in_one import ROOT, Version
from yardsticks import dense_newton

SHIPPED = sorted(path.stem for path in (ROOT / "structures").glob("*.yaml"))
FAMILIES = {
    "tower": {"stages": 10},
    "drum": {"stages": 10},
    "x-tower": {"stages": 10},
    "snake": {"modules": 10},
    "net": {"side": 10},
    "catenary": {"links": 10},
}
"""Ten stages of whatever a family is made of, moved off its answer where the answer is the start."""

MOVED = {"noise": 0.05, "seed": 1}


def scenes(cgff):
    """Return name -> scene."""
    found = {name: cgff.load(str(ROOT / "structures" / f"{name}.yaml")) for name in SHIPPED}
    for family, size in FAMILIES.items():
        given = size if family == "catenary" else size | ({"jitter": 0.05} if family == "net" else MOVED)
        found[f"{family} {next(iter(size.values()))}"] = cgff.new(family, **given)
    return found


def rivals(scene):
    """Return name -> a call that gives (n, d) coordinates."""
    structure = import_module("cgff_cli.structure").from_scene(scene)
    mechanics = import_module("cgff_cli.mechanics.state").Mechanics(structure)
    x0, shape, dofs = mechanics.start.ravel(), mechanics.start.shape, mechanics.dofs

    def at(x):
        full = x0.copy()
        full[dofs] = x
        return mechanics.at(full.reshape(shape))

    def residual(x):
        return at(x).g.ravel()[dofs]

    def jacobian(x):
        return at(x).dense_tangent()[np.ix_(dofs, dofs)]

    def coordinates(x):
        return mechanics.shape(at(x).X) + mechanics.frame.centre

    arrays = (
        structure.coordinates,
        structure.start,
        structure.end,
        structure.stiffness,
        structure.rest_lengths,
        structure.tension_only,
        structure.free,
        structure.loads,
    )
    return {
        "newton": lambda: dense_newton(*arrays),
        "fsolve": lambda: coordinates(fsolve(residual, x0[dofs], fprime=jacobian, xtol=1e-12)),
        "lm": lambda: coordinates(
            root(residual, x0[dofs], jac=jacobian, method="lm", options={"xtol": 1e-12, "ftol": 1e-14}).x
        ),
    }


def ours(scene):
    """Return a call of the present version's solve."""
    solve = import_module("cgff_cli").solve

    def call():
        return solve(scene, analysis="never").coordinates

    return call


def relative(scene, X):
    """Return the largest out-of-balance force over the largest force, at (n, d) coordinates."""
    structure = replace(import_module("cgff_cli.structure").from_scene(scene), coordinates=X)
    mechanics = import_module("cgff_cli.mechanics.state").Mechanics(structure)
    state = mechanics.at(mechanics.start)
    return np.abs(state.g).max() / max(np.abs(state.t).max(), mechanics.largest_load)


def timed(calls, repeat):
    """Return name -> median seconds, calls in turn; the versions are put in place outside the clock."""
    times = {name: [] for name in calls}
    for _ in range(repeat):
        for name, (version, call) in calls.items():
            with version, np.errstate(all="ignore"):
                call()
                for _ in range(3):
                    start = time.perf_counter()
                    call()
                    times[name].append(time.perf_counter() - start)
    return {name: statistics.median(values) for name, values in times.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--before", type=Path)
    parser.add_argument("--repeat", type=int, default=40)
    parser.add_argument("--only", default="")
    arguments = parser.parse_args()
    now = Version(ROOT)
    versions = {"now": now} | ({"before": Version(arguments.before)} if arguments.before else {})
    own = {}
    for name, version in versions.items():
        with version:
            own[name] = scenes(import_module("cgff_cli"))
    print(f"{'':15}{'now ms':>8}{'its':>4}{'before':>8}{'newton':>8}{'fsolve':>8}{'lm':>8}   residuals")
    for scene in own["now"]:
        if arguments.only not in scene:
            continue
        calls, residuals = {}, {}
        for name, version in versions.items():
            with version:
                calls[name] = version, ours(own[name][scene])
        with now:
            its = import_module("cgff_cli").solve(own["now"][scene]).counts["iterations"]
            calls |= {name: (now, call) for name, call in rivals(own["now"][scene]).items()}
            for name, (version, call) in list(calls.items()):
                if version is not now:
                    continue
                try:
                    with np.errstate(all="ignore"):
                        residuals[name] = relative(own["now"][scene], call())
                except Exception as failure:  # a rival's failure is a figure
                    residuals[name] = type(failure).__name__
                    del calls[name]
        seconds = timed(calls, arguments.repeat)
        ratios = "".join(
            f"{seconds[name] / seconds['now']:8.2f}" if name in seconds else f"{'fails':>8}"
            for name in ("before", "newton", "fsolve", "lm")
        )
        told = " ".join(r if isinstance(r, str) else f"{r:.0e}" for r in residuals.values())
        print(f"{scene:15}{1e3 * seconds['now']:8.3f}{its:4}{ratios}   {told}", flush=True)


if __name__ == "__main__":
    main()
