"""What the default analysis costs: beside the solve of small scenes, and by the size of large ones.

    python tests/studies/analysis_cost.py [--repeat 100] [--factor superlu] [--sizes 100,300,900,1500,3000]

Small: `solve(scene)` and `solve(scene, analysis="never")` in turn, medians. Large: one solve without, then
the medians of three analyses of its answer, ranks and stability apart, and which fields are null.
"""

import argparse
import statistics
from pathlib import Path
from time import process_time

import cgff_cli
from cgff_cli.analysis.large import stability_of_large
from cgff_cli.analysis.ranks import Ranks, rank_tolerance
from cgff_cli.analysis.stability import stability

STRUCTURES = Path(__file__).parents[2] / "structures"
FAMILIES = {
    "tower": lambda f: {"stages": max(1, round(f / 9 - 1)), "noise": 0.03},
    "drum": lambda f: {"struts": 10, "stages": max(1, round(f / 30 - 1)), "noise": 0.03},
    "net": lambda f: {"side": round((f / 3) ** 0.5) + 2, "jitter": 0.02},
}


def timed(call):
    start = process_time()
    found = call()
    return process_time() - start, found


def small(repeat):
    print(f"{'':12}{'never ms':>10}{'auto ms':>10}{'ratio':>8}")
    for path in sorted(STRUCTURES.glob("*.yaml")):
        scene, times = cgff_cli.load(str(path)), {"never": [], "auto": []}
        for _ in range(repeat):
            for asked in times:
                times[asked].append(timed(lambda a=asked, s=scene: cgff_cli.solve(s, analysis=a))[0])
        never, auto = (1e3 * statistics.median(own) for own in times.values())
        print(f"{path.stem:12}{never:10.3f}{auto:10.3f}{auto / never:8.2f}")


def large(sizes, factor):
    print(f"{'':12}{'free':>8}{'solve s':>10}{'ranks s':>10}{'signs s':>10}{'share':>8}")
    for family, parameters in FAMILIES.items():
        for size in sizes:
            scene = cgff_cli.new(family, **parameters(size))
            seconds, result = timed(lambda s=scene: cgff_cli.solve(s, analysis="never", factor=factor))
            state, floor = result.solution.state, result.solution.balance.floor
            tolerance = rank_tolerance(result.residual["relative"])

            def ranks(state=state, tolerance=tolerance):
                own = Ranks(state, tolerance)
                return own.conditions() | {"super_stable": own.is_super_stable()}

            def signs(state=state, floor=floor):
                if state.mechanics.is_small:
                    return stability(state, floor)
                return stability_of_large(state, factor, floor)

            own = [statistics.median(timed(call)[0] for _ in range(3)) for call in (ranks, signs)]
            null = [name for name, value in {**ranks(), **signs()}.items() if value is None]
            free = int(result.structure.free.sum())
            share = sum(own) / seconds
            print(f"{family:12}{free:8}{seconds:10.3f}{own[0]:10.3f}{own[1]:10.3f}{share:8.2f}", *null)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--repeat", type=int, default=100)
    parser.add_argument("--factor", default="superlu", choices=("superlu", "cholmod"))
    parser.add_argument("--sizes", default="100,300,900,1500,3000")
    arguments = parser.parse_args()
    small(arguments.repeat)
    large([int(size) for size in arguments.sizes.split(",")], arguments.factor)


if __name__ == "__main__":
    main()
