"""One job measured: every method on its scene, a row each, as plain values."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from cgff_cli import pipeline
from cgff_cli.options import OPTIONS
from cgff_cli.structure import from_scene
from cgff_cli.study.alignment import aligned, alignment_of, distance_difference, largest_move, size
from cgff_cli.study.compare import Observer, compare
from cgff_cli.study.expectation import REFUSED, as_expected, outcome
from cgff_cli.study.jobs import Job, own_method
from cgff_cli.study.record import Comparison, Method

Row = dict[str, Any]

SAME_ENERGY = 1e-9
"""Energies that differ by no more, relatively, are one energy."""

SAME_SHAPE = 1e-8
"""Shapes whose distances differ by no more, over the structure's size, are one shape."""

ROW_FIELDS = (
    "suite",
    "case",
    "method",
    "nodes",
    "elements",
    "dimension",
    "verdict",
    "converged",
    "stable",
    "outcome",
    "as_expected",
    "residual_relative",
    "energy",
    "shape_error",
    "max_node_difference",
    "max_length_difference",
    "max_force_density_difference",
    "distance_matrix_difference",
    "same_energy_as",
    "same_answer",
    "iterations",
    "evaluations",
    "seconds",
    "reached",
    "message",
    "digest",
)
"""Fields of a row; those that a Method has mean the same there."""

_AS_IN_A_METHOD = tuple(name for name in ROW_FIELDS if name in Method._fields and name != "nodes")


def measured(job: Job, observer: Observer | None = None) -> list[Row]:
    """Return the rows of a job, cgff's first; raises KeyboardInterrupt on Ctrl-C."""
    blank = dict.fromkeys(ROW_FIELDS) | {"suite": job.case.suite, "case": job.case.id, "digest": job.digest}
    scene = job.scene
    if scene is None:
        told = {"method": "cgff", "verdict": REFUSED, "converged": False, "outcome": REFUSED}
        return [blank | told | {"as_expected": True, "reached": {}, "message": job.refusal}]
    blank |= {
        "nodes": len(scene.node_names),
        "elements": scene.element_count,
        "dimension": scene.dimension,
    }
    comparison = compare(scene, job.methods, observer=observer, **job.options)
    equals = dict(_equals(comparison))
    rows = []
    for method in comparison.methods:
        row = blank | {name: getattr(method, name) for name in _AS_IN_A_METHOD}
        row |= {"method": method.name, "seconds": _rounded(method.seconds), "reached": _reached(method)}
        row["shape_error"] = _shape_error(comparison, method)
        row["same_energy_as"], row["same_answer"] = equals.get(method.name, (None, None))
        if method.name == own_method(job.options):
            row["outcome"], row["as_expected"] = _solved(job)
        rows.append(row)
    return rows


def _solved(job: Job) -> tuple[str | None, bool | None]:
    """Return how `solve` ends, and whether that is as the case expects; None where it expects nothing."""
    if "outcome" not in job.case.expect or job.scene is None:
        return None, None
    options = {name: value for name, value in job.options.items() if name in OPTIONS}
    result = pipeline.solve(job.scene, **options)
    if result.interrupted:
        raise KeyboardInterrupt
    return outcome(result), as_expected(result, job.case.expect)


def _reached(method: Method) -> dict[str, Any]:
    """Return tolerance -> iterations and seconds until the relative residual was within it."""
    return {
        f"{point.tolerance:.0e}": {"iterations": point.iterations, "seconds": _rounded(point.seconds)}
        for point in method.curve
    }


def _rounded(seconds: float | None) -> float | None:
    """Return a time to a tenth of a microsecond: no clock tells more."""
    return None if seconds is None else round(seconds, 7)


def _shape_error(comparison: Comparison, method: Method) -> float | None:
    """Return the largest distance of a node from its place in the reference, over the structure's size."""
    if method.nodes is None:
        return None
    X, target = _positions(method.nodes), _positions(comparison.reference["nodes"])
    if method.alignment != "affine":
        X = aligned(X, target, alignment_of(target, from_scene(comparison.source).free))
    return largest_move(X, target) / size(target)


def _positions(nodes: dict[str, list[float]]) -> np.ndarray:
    return np.array(list(nodes.values()))


def _equals(comparison: Comparison) -> Iterator[tuple[str, tuple[str, bool | None]]]:
    """Yield each method that claims a stable equilibrium of the energy that one before it claims.

    With it come that method, and whether both have one shape; None in structures too large to tell.
    """
    claims = [method for method in comparison.methods if method.converged and method.stable and method.nodes]
    for number, method in enumerate(claims):
        other = _of_same_energy(method, claims[:number])
        if other is None:
            continue
        X, target = _positions(method.nodes or {}), _positions(other.nodes or {})
        apart = distance_difference(X, target)
        same = None if apart is None else bool(apart <= SAME_SHAPE * size(target))
        yield method.name, (other.name, same)


def _of_same_energy(method: Method, others: Sequence[Method]) -> Method | None:
    for other in others:
        one, two = method.energy or 0.0, other.energy or 0.0
        if abs(one - two) <= SAME_ENERGY * max(abs(one), abs(two)):
            return other
    return None
