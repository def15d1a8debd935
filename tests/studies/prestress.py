"""Prestress of shapes from formulas: held where it begins, returned to from 1 % off, or proven impossible.

    python tests/studies/prestress.py [--large] [--each] [--solved]

By default the table of shapes, the paper's tables and the weight of the norm; --large times 10^2 to 10^4
members, --each prints a line per shape, --solved takes shapes that `solve` found under weight and snow.
"""

import argparse
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

import cgff_cli
from cgff_cli.analysis import balanced
from cgff_cli.analysis.measures import reach
from cgff_cli.scene.scene import Scene
from tests.geometries import (
    dome,
    family,
    grid,
    moved,
    net,
    of_one_kind,
    prism,
    solid,
    stack,
    swapped,
    truss,
    wheel,
    x_module,
)
from tests.paper.printed import TABLES
from tests.shapes import distance_difference

SOLIDS = ("octahedron", "cube", "icosahedron", "dodecahedron", "cuboctahedron")
OFF = 0.01
BACK = 1e-8


def shapes() -> Iterator[tuple[str, Scene]]:
    """Yield name and shape of everything that is tried."""
    for n in (3, 4, 5, 6, 8, 12, 20, 30):
        yield f"prism {n}", prism(n)
        yield f"tapered prism {n}", prism(n, top=0.6)
    for n, ring, jump in (
        (5, 1, 2),
        (7, 1, 3),
        (8, 1, 3),
        (12, 1, 5),
        (5, 2, 1),
        (7, 2, 1),
        (7, 3, 2),
        (8, 3, 1),
    ):
        yield f"prism {n}, rings by {ring}, jump {jump}", prism(n, ring, jump)
    for name in SOLIDS:
        yield f"{name} with diagonals", solid(name)
        yield f"{name}, struts for cables", swapped(solid(name))
        yield f"{name} askew", moved(solid(name), 0.2, 1)
    for n in (3, 4, 5, 8):
        yield f"wheel {n}", wheel(n)
    for levy in (False, True):
        for n, rings in ((6, 1), (8, 2), (12, 3), (20, 4)):
            name = f"{'Levy' if levy else 'Geiger'} dome {n} x {rings}"
            yield name, dome(n, rings, levy)
            yield f"{name}, askew", moved(dome(n, rings, levy), 0.05, 3)
    for n, stages in ((3, 2), (3, 5), (4, 3), (6, 10)):
        yield f"stack {n} x {stages}", stack(n, stages)
    for side in (4, 6, 10, 20):
        yield f"net {side}", net(side, 0.4)
    for panels in (1, 4, 12):
        yield f"truss {panels}", truss(panels, 2.0)
        yield f"truss {panels}, lifted", truss(panels, -2.0)
    for side in (3, 5):
        yield f"grid {side}", grid(side, 0.0)
        yield f"grid {side}, loaded", grid(side, 1.0)
    for name, given in (
        ("tower", {}),
        ("tower", {"stages": 20}),
        ("drum", {}),
        ("octahedron", {}),
        ("polyhedron", {"kind": "tetrahedron"}),
        ("polyhedron", {"kind": "dodecahedron"}),
        ("x-tower", {"stages": 8}),
        ("snake", {"modules": 7}),
    ):
        yield f"family {name} {given or ''}".strip(), family(name, **given)
    yield "four points", x_module()
    yield "four points, struts around", swapped(x_module())
    yield "four points, one inside", x_module(((0, 0), (1, 0), (0.3, 0.3), (0, 1)))
    yield "prism 3, struts for cables", swapped(prism(3))
    yield "prism 4, 5 degrees off", prism(4, off=5.0)
    yield "prism 6, askew", moved(prism(6), 0.05, 2)
    yield "cables alone", of_one_kind(stack(3, 3), "cable")
    yield "struts alone", of_one_kind(solid("icosahedron"), "strut")


def arrays(scene: Scene) -> tuple[np.ndarray, np.ndarray]:
    """Return signs (b,) and pairs (b, 2)."""
    kinds = [own.kind for own in scene.groups for _ in own.EA]
    return np.where(np.array(kinds) == "cable", 1.0, -1.0), np.concatenate(
        [own.pairs for own in scene.groups]
    )


def proven(scene: Scene, found: "cgff_cli.rest_lengths.Prestressed") -> bool:
    """Return whether the motion does what it is said to, by its own arithmetic."""
    signs, pairs = arrays(scene)
    v = np.array(list(found.certificate.values()))
    along = scene.coordinates[pairs[:, 0]] - scene.coordinates[pairs[:, 1]]
    rate = signs * ((v[pairs[:, 0]] - v[pairs[:, 1]]) * along).sum(1) / np.linalg.norm(along, axis=1)
    size = np.abs(rate).max()
    names = scene.node_names
    labels = [f"{own.name}: {names[a]}-{names[b]}" for own in scene.groups for a, b in own.pairs.tolist()]
    never = np.isin(labels, found.never)
    work = sum(float(v[row] @ load) for row, load in scene.loads.items())
    still = np.abs(rate[~never]).max(initial=0.0) <= 1e-9 * max(size, 1.0)
    return bool(still and (rate[never] > 1e-9 * size).all() and work <= 1e-9 and (never.any() or work < 0.0))


def returned(scene: Scene) -> float:
    """Return how far the shape from 1 % off is from the one that was held, over its size."""
    size = 2.0 * float(reach(scene.coordinates).max())
    off = np.random.default_rng(7).uniform(-OFF, OFF, scene.coordinates.shape) * size / 2.0
    for row in scene.supports:
        off[row] = 0.0
    result = cgff_cli.solve(replace(scene, coordinates=scene.coordinates + off), tolerance=1e-12)
    if scene.supports:
        return float(np.abs(result.coordinates - scene.coordinates).max()) / size
    return float(distance_difference(result.coordinates, scene.coordinates)) / size


def judged(name: str, scene: Scene) -> tuple[str, str]:
    """Return the outcome of a shape in a word, and a line about it."""
    start = perf_counter()
    found = cgff_cli.prestress(scene)
    took = f"{1e3 * (perf_counter() - start):7.1f} ms"
    line = f"{name:40} {scene.element_count:5} {found.self_stress_states!s:>4} {took}"
    if found.feasible is None:
        return "undecided", f"{line} {found.reason}"
    if not found.feasible:
        word = "impossible, proven" if proven(scene, found) else "impossible, NOT PROVEN"
        return word, f"{line} {word}: {len(found.never)} never, {len(found.idle)} of them idle"
    iterations = cgff_cli.solve(found.scene, objective="residual").counts["iterations"]
    if found.stability != "stable":
        word = f"{found.stability}, said so" if found.warnings else f"{found.stability}, NOT SAID"
        return word + (", moves at once" if iterations else ""), f"{line} {word}"
    back = returned(found.scene)
    word = "held" if not iterations and back <= BACK else "NOT HELD"
    return (
        word,
        f"{line} {word}, super-stable {found.super_stable}, {iterations} iterations, back to {back:.1e}",
    )


def paper() -> None:
    """Print what is said of the tables as they are printed."""
    for name, table in TABLES.items():
        base = cgff_cli.load(Path(__file__).parents[2] / "structures" / f"{name}.yaml")
        for column in ("cgff", "fdm"):
            scene = replace(base, coordinates=getattr(table, column))
            for tolerance in (1e-9, 2e-5, 1e-3, 1e-2):
                found = cgff_cli.prestress(scene, tolerance=tolerance)
                q = found.force_densities
                told = found.reason if q is None else np.array2string(q / -q[-1], precision=6)
                moved_by = found.max_node_motion or 0.0
                print(
                    f"{name} {column} tolerance {tolerance:g}: {found.feasible}, moved {moved_by:.1e}, {told}"
                )


def weight_of_the_norm() -> None:
    """Print what the weight of the norm costs the least member, against a thousandth of the default."""
    default = balanced.LIGHT
    many = [scene for _, scene in shapes() if not scene.loads]
    many += [moved(scene, 0.05, seed) for scene in many for seed in (1, 2)]
    best = list(map(_least_member, many, [1e-3 * default] * len(many)))
    for weight in (1e-1, 1e-2, 1e-3, 1e-4, default):
        pairs = zip(map(_least_member, many, [weight] * len(many)), best, strict=True)
        lost = [1.0 - least / most for least, most in pairs if least and most]
        over = sum(share > 1e-6 for share in lost)
        print(f"weight {weight:g}: of {len(lost)} shapes {over} lose more than 1e-6, {max(lost):.1e} at most")
    balanced.LIGHT = default


def _least_member(scene: Scene, weight: float) -> float | None:
    balanced.LIGHT = weight
    q = cgff_cli.prestress(scene).force_densities
    return None if q is None else float(np.abs(q).min() / np.abs(q).max())


def large() -> None:
    """Print seconds for 10^2, 10^3 and 10^4 members."""
    cases: list[tuple[str, Callable[[], Scene]]] = []
    for n in (8, 83, 830):
        cases.append((f"tower of {n}", partial(family, "tower", stages=n)))
        cases.append((f"tower of {n}, cut", partial(cut, n)))
        cases.append((f"tower of {n}, cables", lambda n=n: of_one_kind(family("tower", stages=n), "cable")))
    cases += [(f"prism of {n}", partial(family, "prism", sides=n)) for n in (25, 250, 2500)]
    cases += [(f"net of {n} a side", partial(net, n, 0.4)) for n in (9, 24, 72)]
    cases += [
        (f"Levy dome of {n} x {m}", partial(dome, n, m, True)) for n, m in ((10, 2), (40, 4), (100, 17))
    ]
    for name, make in cases:
        scene = make()
        for options in ({}, {"by_symmetry": True}):
            start = perf_counter()
            found = cgff_cli.prestress(scene, **options)
            seconds = perf_counter() - start
            word = (
                found.stability if found.feasible else proven(scene, found) if not options else found.feasible
            )
            how, states = "by symmetry" if options else "", (found.self_stress_states, found.group_states)
            print(
                f"{name:24}{scene.element_count:6} members {how:12}{seconds:7.2f} s",
                *states,
                word,
                flush=True,
            )


def solved() -> None:
    """Print what is said of shapes that `solve` found, asked for any forces and for those that it found."""
    made = [("net", {"side": side, **own}) for side in (6, 8, 12, 16, 20, 32) for own in BURDENS]
    made += [
        (name, {"law": law, "weight": 0.01}) for name in ("geiger", "levy") for law in ("paper", "hooke")
    ]
    for tolerance in (1e-10, 1e-12, 1e-14):
        words, off, most = Counter(), [0.0], 0
        for family_name, given in made:
            scene = cgff_cli.new(family_name, **given)
            result = cgff_cli.solve(scene, tolerance=tolerance, analysis="never")
            shape, first = scene.with_coordinates(result.coordinates), scene.groups[0]
            force = float(np.abs(result.forces[: len(first.EA)]).max())
            for asked in ({}, {"force": {first.name: force}}):
                found = cgff_cli.prestress(shape, **asked)
                words[f"{'that force' if asked else 'any'} {found.feasible}"] += 1
                if found.scene is not None:
                    most = max(most, cgff_cli.solve(found.scene, analysis="never").counts["iterations"])
                if found.scene is not None and not found.self_stress_states:
                    off.append(float(np.abs(found.forces - result.forces).max()) / force)
        print(f"solved to {tolerance:g}: {dict(words)}, at most {most} iterations, forces to {max(off):.1e}")


BURDENS = ({"weight": 0.01}, {"weight": 0.1}, {"snow": 0.2}, {"snow": 0.02, "weight": 0.01})


def cut(stages: int) -> Scene:
    """Return a tower without its end rings."""
    whole = family("tower", stages=stages)
    return replace(whole, groups=whole.groups[1:])


def main() -> None:
    """Run what is asked for."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--large", action="store_true")
    parser.add_argument("--each", action="store_true")
    parser.add_argument("--solved", action="store_true")
    asked = parser.parse_args()
    if asked.solved:
        solved()
        return
    if asked.large:
        large()
        return
    words = Counter()
    for name, scene in shapes():
        word, line = judged(name, scene)
        words[word] += 1
        if asked.each or "NOT" in word or word == "undecided":
            print(line)
    print(
        f"{sum(words.values())} shapes:", ", ".join(f"{count} {word}" for word, count in words.most_common())
    )
    paper()
    weight_of_the_norm()


if __name__ == "__main__":
    main()
