"""Cases made ready to measure: their scenes, methods and options, and a digest of all that they depend on."""

import hashlib
import json
import os
import platform
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import cgff_cli
from cgff_cli.errors import Problem, SceneError
from cgff_cli.scene.scene import Scene
from cgff_cli.study.case import Case, built
from cgff_cli.study.compare import chosen
from cgff_cli.study.expectation import REFUSED

NOT_MEASURING = ("report", "cli")
"""Rooms whose text changes no measurement."""


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


def own_method(options: Mapping[str, Any]) -> str:
    """Return the method that `solve` would run by these options, which a case's expectation is about."""
    if options.get("method") == "table1":
        return "table1"
    return "cgff-residual" if options.get("objective") == "residual" else "cgff"


@cache
def machine() -> dict[str, Any]:
    """Return what times depend on besides the program."""
    return {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": version("scipy"),
        "processor": _processor(),
        "cores": os.cpu_count(),
    }


def _job(case: Case, methods: list[str], options: dict[str, Any]) -> Job:
    try:
        scene: Scene | None = built(case)
        refusal = ""
    except SceneError as error:
        if case.expect.get("outcome") != REFUSED:
            raise
        scene, refusal = None, str(error)
    names = tuple(chosen([*methods, own_method(options)], bool(scene and scene.supports)))
    told = [case.suite, case.id, case.expect, names, options, refusal, machine(), _program()]
    digest = hashlib.sha256(json.dumps(told, sort_keys=True).encode())
    for part in _contents(scene) if scene else ():
        digest.update(part)
    return Job(case, scene, refusal, names, options, digest.hexdigest()[:16])


def _contents(scene: Scene) -> Iterator[bytes]:
    words = (scene.name, scene.law, scene.node_names, scene.supports, scene.loads, scene.solver)
    yield repr(words).encode()
    yield scene.coordinates.tobytes()
    for group in scene.groups:
        yield repr((group.name, group.kind, len(group.EA))).encode()
        yield group.pairs.tobytes() + group.EA.tobytes() + group.rest_length.tobytes()


@cache
def _program() -> str:
    """Return version and digest of the sources that measure: between versions they change."""
    package = Path(cgff_cli.__file__).parent
    digest = hashlib.sha256()
    for path in sorted(package.rglob("*.py")):
        if path.relative_to(package).parts[0] not in NOT_MEASURING:
            digest.update(path.read_bytes())
    return f"{cgff_cli.__version__} {digest.hexdigest()}"


def _processor() -> str:
    """Return the processor's name; Linux tells it in a file alone."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text(errors="replace").splitlines() if info.is_file() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()
