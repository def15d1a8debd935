"""Is f, eq. (10), convex? Segments, second derivatives, and where minimising it ends.

Measured with the scene's cables, which go slack, and with cables that push, as in the paper.
"""

from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np

import cgff_cli
from cgff_cli.mechanics.frame import UNSCALED
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.solvers.objectives import Residual
from tests.studies.claims.cases import LAWS, NAMES, answer_of, random_starts, scene_of, structure_of

STEP = 1e-6
ENDS = ("stable", "unstable", "neutral", "stationary", "none")


def measure(count: int, segments: int) -> dict[str, Any]:
    """Return the exhibit, shares of random segments, curvatures, and ends from `count` random starts."""
    return {
        "quarter_turn": {law: quarter_turn(law) for law in LAWS},
        "segments": {name: {law: above_the_chord(name, law, segments) for law in LAWS} for name in NAMES},
        "curvature_at_the_start": {name: {law: curvatures(name, law) for law in LAWS} for name in NAMES},
        "ends": {
            name: {
                law: {kind: ends(name, law, kind, count) for kind in ("residual", "energy")} for law in LAWS
            }
            for name in NAMES
        },
    }


def quarter_turn(law: str) -> dict[str, float]:
    """Return f at the prism's answer, at the same turned a quarter about its axis z, and half way."""
    mechanics = Mechanics(structure_of("prism", law), UNSCALED)
    X, Y = turned_prism()
    f = {"X": X, "Y": Y, "middle": 0.5 * (X + Y)}
    return {place: Residual().value(mechanics.at(shape.T)) for place, shape in f.items()}


def turned_prism() -> tuple[np.ndarray, np.ndarray]:
    """Return the prism's answer about its centroid, its axis along z, and the same turned by 90 degrees."""
    X = answer_of("prism").shape
    X = X - X.mean(axis=0)
    axis = X[3:].mean(axis=0)
    # An orthonormal basis whose last vector is the axis.
    across = np.linalg.svd(axis[None])[2][1:]
    X = X @ np.vstack((across, axis / np.linalg.norm(axis))).T
    return X, X @ np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])


def above_the_chord(name: str, law: str, count: int) -> dict[str, int]:
    """Return how many random segments have f at their middle above the mean of f at their ends."""
    mechanics = Mechanics(structure_of(name, law), UNSCALED)
    objective = Residual()
    shapes = list(random_starts(name, 2 * count))
    above = 0
    for X, Y in zip(shapes[::2], shapes[1::2], strict=True):
        f = [objective.value(mechanics.at(shape.T)) for shape in (X, 0.5 * (X + Y), Y)]
        above += f[1] > 0.5 * (f[0] + f[2])
    return {"segments": count, "above": above}


def curvatures(name: str, law: str) -> dict[str, float]:
    """Return the least and largest eigenvalue of the second derivatives of f at the scene's own start."""
    values = np.linalg.eigvalsh(second_derivatives(name, law))
    return {"least": float(values[0]), "largest": float(values[-1])}


def second_derivatives(name: str, law: str) -> np.ndarray:
    """Return them, (n d, n d), by central differences of the exact gradient."""
    mechanics = Mechanics(structure_of(name, law), UNSCALED)
    objective, X = Residual(), mechanics.start
    columns = []
    for dof in range(X.size):
        step = np.zeros(X.size)
        step[dof] = STEP
        ahead, behind = (mechanics.at(X + sign * step.reshape(X.shape)) for sign in (1.0, -1.0))
        columns.append((objective.gradient(ahead) - objective.gradient(behind)).ravel() / (2.0 * STEP))
    hessian = np.array(columns)
    return 0.5 * (hessian + hessian.T)


def ends(name: str, law: str, objective: str, count: int) -> dict[str, int]:
    """Return how many of `count` random starts end how."""
    scene = scene_of(name, law)
    counts = Counter(
        end_of(cgff_cli.solve(replace(scene, coordinates=X), objective=objective))
        for X in random_starts(name, count)
    )
    return {end: counts[end] for end in ENDS}


def end_of(result: "cgff_cli.Result") -> str:
    """Return the kind of equilibrium, or how the run ended without one."""
    kind = result.analysis["stability"] if result.converged else result.verdict
    if kind == "stationary_not_equilibrium":
        return "stationary"
    return kind if kind in ENDS else "none"


def show(found: dict[str, Any]) -> None:
    """Print the four parts."""
    for law, f in found["quarter_turn"].items():
        print(f"prism, {LAWS[law]}: f = {f['X']:.1e}, turned {f['Y']:.1e}, half way {f['middle']:.4g}")
    print(f"\n{'':14}{'segments':>9}{'above':>7}{'least curvature':>17}{'largest':>10}")
    for name in NAMES:
        for law in LAWS:
            one, curvature = found["segments"][name][law], found["curvature_at_the_start"][name][law]
            print(
                f"{NAMES[name] + ', ' + law:14}{one['segments']:9}{one['above']:7}"
                f"{curvature['least']:17.3g}{curvature['largest']:10.3g}"
            )
    print(f"\n{'ends from random starts':24}" + "".join(f"{end:>12}" for end in ENDS))
    for name in NAMES:
        for law in LAWS:
            for kind, counts in found["ends"][name][law].items():
                label = f"{NAMES[name]}, {law}, {kind}"
                print(f"{label:24}" + "".join(f"{counts[end]:12}" for end in ENDS))
