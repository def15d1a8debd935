"""One case measured: every method on its scene, a row each, as plain values."""

from collections.abc import Iterator, Sequence
from typing import Any

from cgff_cli import pipeline
from cgff_cli.options import OPTIONS
from cgff_cli.scene.scene import Scene
from cgff_cli.study.alignment import distance_difference, size
from cgff_cli.study.bench import Job, own_method
from cgff_cli.study.case import REFUSED, as_expected, outcome
from cgff_cli.study.compare import BeforeRun, compare
from cgff_cli.study.machine import Row
from cgff_cli.study.record import Method

SAME_ENERGY = 1e-9
"""Energies that differ by no more, relatively, are one energy."""

SAME_SHAPE = 1e-8
"""Shapes whose distances differ by no more, over the structure's size, are one shape."""

ROW_FIELDS = (
    *("suite", "case", "method", "nodes", "elements", "dimension"),
    *("verdict", "converged", "stable", "outcome", "as_expected", "residual_relative", "energy"),
    *("shape_error", "max_node_difference", "max_length_difference", "max_force_density_difference"),
    *("distance_matrix_difference", "same_energy_as", "same_answer"),
    *("iterations", "evaluations", "seconds", "reached", "message", "digest"),
)
"""Fields of a row; those that a Method has mean the same there."""

_AS_IN_A_METHOD = tuple(name for name in ROW_FIELDS if name in Method._fields)


def measured(job: Job, observer: BeforeRun | None = None) -> list[Row]:
    """Return the rows of a job, cgff's first; raises KeyboardInterrupt on Ctrl-C."""
    blank = dict.fromkeys(ROW_FIELDS) | {"suite": job.case.suite, "case": job.case.id, "digest": job.digest}
    scene = job.scene
    if scene is None:
        told = {"method": "cgff", "verdict": REFUSED, "converged": False, "outcome": REFUSED}
        return [blank | told | {"as_expected": True, "reached": {}, "message": job.refusal}]
    sizes = (len(scene.node_names), scene.element_count, scene.dimension)
    blank |= dict(zip(("nodes", "elements", "dimension"), sizes, strict=True))
    methods = compare(scene, job.methods, observer=observer, **job.options).methods
    equals = dict(_equals(methods))
    rows = []
    for method in methods:
        row = blank | {name: getattr(method, name) for name in _AS_IN_A_METHOD}
        row |= {"method": method.name, "seconds": _rounded(method.seconds), "reached": _reached(method)}
        row["same_energy_as"], row["same_answer"] = equals.get(method.name, (None, None))
        if method.name == own_method(job.options):
            row["outcome"], row["as_expected"] = _solved(job, scene)
        rows.append(row)
    return rows


def _solved(job: Job, scene: Scene) -> tuple[str | None, bool | None]:
    """Return how `solve` ends, and whether that is as the case expects; None where it expects nothing."""
    if "outcome" not in job.case.expect:
        return None, None
    options = {name: value for name, value in job.options.items() if name in OPTIONS}
    result = pipeline.solve(scene, **options)
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


def _equals(methods: Sequence[Method]) -> Iterator[tuple[str, tuple[str, bool | None]]]:
    """Yield each method that claims a stable equilibrium of the energy that one before it claims.

    With it come that method, and whether both have one shape; None in structures too large to tell.
    """
    claims = [
        (own.name, own.energy or 0.0, own.X)
        for own in methods
        if own.converged and own.stable and own.X is not None
    ]
    for number, (name, energy, X) in enumerate(claims):
        for other, theirs, target in claims[:number]:
            if abs(energy - theirs) <= SAME_ENERGY * max(abs(energy), abs(theirs)):
                apart = distance_difference(X, target)
                same = None if apart is None else bool(apart <= SAME_SHAPE * size(target))
                yield name, (other, same)
                break
