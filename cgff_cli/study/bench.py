"""A bench: cases of suites as jobs for the machine; its record, schema cgff-bench/1, and reading one back."""

import json
import os
from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

from cgff_cli import TOOL
from cgff_cli.errors import OptionError, Problem, SceneError
from cgff_cli.scene.scene import Scene
from cgff_cli.study.case import REFUSED, Case, built
from cgff_cli.study.compare import chosen
from cgff_cli.study.digest import contents, digest_of, machine
from cgff_cli.study.machine import Row

BENCH_SCHEMA = "cgff-bench/1"

TIME_LIMIT = 10.0
"""Seconds after which a run is ended, unless the case or the command line says otherwise."""


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
