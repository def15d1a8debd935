"""How the time for a cable net grows from 10^2 to 10^6 elements, and where it goes.

    OPENBLAS_NUM_THREADS=1 python tests/studies/growth.py [--sides 9,24,72,225,708] [--factor superlu]

Nets of `cgff new net` with rest lengths 1 % off. Shares of the time: factors, solves with them, the rest
(lengths, forces, line searches). The exponent is that of time against elements between neighbouring rows.
"""

import argparse
import resource
import time
from math import log

import cgff_cli
from cgff_cli.options import SolveOptions
from cgff_cli.solvers import cgff
from cgff_cli.solvers.preconditioners import frames
from cgff_cli.structure import from_scene


class Timed:
    """A factor whose solves are timed."""

    def __init__(self, solve):
        self.solve = solve


class Clock:
    """Adds up the time spent in calls that it wraps."""

    def __init__(self):
        self.seconds = {}

    def wrapped(self, name, call):
        def timed(*args, **kwargs):
            start = time.perf_counter()
            result = call(*args, **kwargs)
            self.seconds[name] = self.seconds.get(name, 0.0) + time.perf_counter() - start
            return result

        return timed


def timed_factory(clock, make):
    """Return a factory function whose factors and solves are timed."""

    def factory(*args):
        made = make(*args)
        factor = made.factor

        def timed(*numbers, **known):
            found = clock.wrapped("factor", factor)(*numbers, **known)
            return None if found is None else Timed(clock.wrapped("solve", found.solve))

        made.factor = timed
        return made

    return factory


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--sides", default="9,24,72,225,708")
    parser.add_argument("--factor", default="superlu")
    parser.add_argument("--jitter", type=float, default=0.01)
    parser.add_argument("--prestress", type=float, default=100.0)
    arguments = parser.parse_args()
    cgff.form_find(from_scene(cgff_cli.new("net", side=20)), SolveOptions(factor=arguments.factor))  # imports
    plain, before = frames.factory, None
    print(
        f"{'elements':>8} {'nodes':>7} {'verdict':10} {'iterations':>10} {'seconds':>8} {'exponent':>8}"
        f" {'factors':>8} {'solves':>7} {'rest':>6} {'GB':>5}"
    )
    for side in map(int, arguments.sides.split(",")):
        clock = Clock()
        frames.factory = timed_factory(clock, plain)
        scene = cgff_cli.new("net", side=side, jitter=arguments.jitter, prestress=arguments.prestress, seed=1)
        structure = from_scene(scene)
        start = time.perf_counter()
        found = cgff.form_find(structure, SolveOptions(factor=arguments.factor))
        seconds = time.perf_counter() - start
        b = len(structure.start)
        exponent = "" if before is None else f"{log(seconds / before[1]) / log(b / before[0]):.2f}"
        factor, solve = (clock.seconds.get(name, 0.0) / seconds for name in ("factor", "solve"))
        peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6
        print(
            f"{b:8} {len(structure.coordinates):7} {found.verdict:10} {found.iterations:10} {seconds:8.3f}"
            f" {exponent:>8} {factor:8.0%} {solve:7.0%} {1.0 - factor - solve:6.0%} {peak:5.2f}",
            flush=True,
        )
        before = b, seconds


if __name__ == "__main__":
    main()
