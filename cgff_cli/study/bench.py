"""A bench: cases of suites as jobs, a row per method of each; its record, schema cgff-bench/1, read back."""

import json
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from cgff_cli import TOOL, pipeline
from cgff_cli.errors import OptionError, Problem, SceneError
from cgff_cli.options import OPTIONS
from cgff_cli.scene.scene import Scene
from cgff_cli.study.alignment import SAME_SHAPE, distance_difference, size
from cgff_cli.study.case import REFUSED, Case, as_expected, built, outcome
from cgff_cli.study.compare import BeforeRun, chosen, compare
from cgff_cli.study.digest import contents, digest_of, machine
from cgff_cli.study.machine import Row
from cgff_cli.study.record import Method

BENCH_SCHEMA = "cgff-bench/1"

TIME_LIMIT = 10.0
"""Seconds after which a run is ended, unless the case or the command line says otherwise."""

SAME_ENERGY = 1e-9
"""Energies that differ by no more, relatively, are one energy."""

ROW_FIELDS = (
    *("suite", "case", "method", "nodes", "elements", "dimension"),
    *("verdict", "converged", "stable", "outcome", "as_expected", "residual_relative", "energy"),
    *("shape_error", "max_node_difference", "max_length_difference", "max_force_density_difference"),
    *("distance_matrix_difference", "same_energy_as", "same_answer"),
    *("iterations", "evaluations", "seconds", "reached", "message", "digest"),
)
"""Fields of a row; those that a Method has mean the same there."""

_AS_IN_A_METHOD = tuple(name for name in ROW_FIELDS if name in Method._fields)


class Job(NamedTuple):
    """One case to measure.

    scene   : None where it was refused, as the case expects; `refusal` says why
    options : those of the case, and of the command line, which win
    digest  : of the program, the machine and everything here
    """

    case: Case
    scene: Scene | None
    refusal: str
    methods: tuple[str, ...]
    options: dict[str, Any]
    digest: str


def jobs_of(cases: Iterable[Case], methods: Iterable[str], options: Mapping[str, Any]) -> list[Job]:
    """Return a job per case; raises SceneError with all scenes that cannot be built, unless expected."""
    asked = list(methods)
    jobs: list[Job] = []
    problems: list[Problem] = []
    for case in cases:
        try:
            jobs.append(_job(case, asked, {"time_limit": TIME_LIMIT, **case.options, **options}))
        except SceneError as error:
            problems += error.problems
    if problems:
        raise SceneError(problems)
    return jobs


def _job(case: Case, methods: list[str], options: dict[str, Any]) -> Job:
    scene, refusal = None, ""
    try:
        scene = built(case)
    except SceneError as error:
        if case.expect.get("outcome") != REFUSED:
            raise
        refusal = str(error)
    names = tuple(chosen([*methods, own_method(options)], bool(scene and scene.supports)))
    told = [case.suite, case.id, case.expect, names, options, refusal, machine()]
    digest = digest_of(told, contents(scene) if scene else ())
    return Job(case, scene, refusal, names, options, digest)


def own_method(options: Mapping[str, Any]) -> str:
    """Return the method that `solve` would run by these options, which a case's expectation is about."""
    if options.get("method") == "table1":
        return "table1"
    return "cgff-residual" if options.get("objective") == "residual" else "cgff"


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


def record(options: Mapping[str, Any], rows: Iterable[Row]) -> dict[str, Any]:
    """Return every field of the JSON, in the order it is written; options are those of the command line."""
    told = {"schema": BENCH_SCHEMA, "tool": dict(TOOL), "machine": machine()}
    return told | {"options": dict(options), "rows": list(rows)}


def kept(path: str, jobs: Iterable[Job]) -> dict[str, list[Row]]:
    """Return digest -> rows of the jobs that an earlier record at a path holds; none where there is none.

    Raises OptionError where the file is something else, which must not be written over.
    """
    if not os.path.exists(path):
        return {}
    known = {job.digest for job in jobs}
    found: dict[str, list[Row]] = {}
    try:
        with open(path, encoding="utf-8") as file:
            earlier = json.load(file)
        if earlier["schema"] != BENCH_SCHEMA:
            raise KeyError("schema")
        for row in earlier["rows"]:
            if row["digest"] in known:
                found.setdefault(row["digest"], []).append(row)
    except (OSError, ValueError, KeyError, TypeError):
        raise OptionError(
            f"{path} is there and holds no {BENCH_SCHEMA}; name another file, or remove it"
        ) from None
    return found
