"""One case of a suite: the scene that it describes, and what `solve` must make of it."""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from cgff_cli.errors import CgffError, OptionError, Problem, SceneError
from cgff_cli.result import Result
from cgff_cli.scene.fields import is_absent, option_value
from cgff_cli.scene.findings import Findings, Mark, Where
from cgff_cli.scene.located import Plain
from cgff_cli.scene.new import new
from cgff_cli.scene.read import from_dict, load, shipped
from cgff_cli.scene.scene import Scene
from cgff_cli.scene.schema import SCENE_KEYS, read_scene
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.structure import refuse_geometry
from cgff_cli.study.changes import CHANGES, chain, changed

SOURCES = {
    "structure": ("structure",),
    "file": ("file",),
    "family": ("family", "parameters"),
    "chain": ("chain",),
}
"""Where a scene may come from unless it is written out -> the keys that belong to it."""


REFUSED = "refused"
"""Outcome of a scene that is no scene."""

BALANCED = ("converged", "floor")
"""First words of an outcome in balance, to the tolerance or to rounding; `balanced` stands for either."""

STABILITIES = ("stable", "unstable", "neutral", "unjudged")

OUTCOMES = (
    REFUSED,
    *(verdict.value for verdict in Verdict if not verdict.converged),
    *(f"{word}-{kind}" for word in ("balanced", *BALANCED) for kind in STABILITIES),
)
"""Every word that an expected outcome can be."""


@dataclass(frozen=True, eq=False)
class Case:
    """One case: how its scene is made, the options to compare by, what cgff must make of it.

    suite  : name of its suite, None for a scene given by itself
    scene  : values as they were written, text without quotes still `Plain`
    path   : the file it stands in; `place` leads from its keys to line and column there
    notes  : entries for its readers
    """

    id: str
    suite: str | None
    scene: dict[str, Any]
    path: str
    place: Callable[[Where, bool], Mark]
    options: dict[str, Any] = field(default_factory=dict)
    expect: dict[str, Any] = field(default_factory=dict)
    notes: dict[str, Any] = field(default_factory=dict)

    def problem(self, message: str) -> Problem:
        """Return a mistake in this case, at its scene."""
        return Problem(self.path, *self.place(("scene",), False), f"case {self.id}: {message}")


def built(case: Case) -> Scene:
    """Return the scene of a case: from its source, then changed in the order written.

    Raises SceneError, placed in the suite or in the scene's own file.
    """
    try:
        scene = _from_source(case)
        refuse_geometry(scene)
        for name in case.scene:
            if name in CHANGES:
                scene = changed(scene, name, meant(case.scene[name]))
    except SceneError:
        raise
    except CgffError as error:
        raise SceneError([case.problem(str(error))]) from None
    return scene


def meant(value: Any) -> Any:
    """Return what values written without quotes mean: numbers, true and false, nothing, else text."""
    if isinstance(value, dict):
        return {str(key): meant(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [meant(entry) for entry in value]
    if is_absent(value):
        return None
    if not isinstance(value, Plain):
        return value
    if value in ("true", "false"):
        return value == "true"
    number = option_value(value)
    return str(value) if isinstance(number, str) else number


def _from_source(case: Case) -> Scene:
    source = next((name for name in SOURCES if name in case.scene), None)
    if source is None:
        return _inline(case)
    written = case.scene[source]
    value, parameters = meant(written), meant(case.scene.get("parameters") or {})
    if source == "structure":
        return load(shipped(value))
    if source == "file":
        return load(os.path.join(os.path.dirname(case.path), str(written)))
    try:
        return new(value, **parameters) if source == "family" else from_dict(chain(**value))
    except (TypeError, ValueError, ZeroDivisionError) as error:
        given = f" {parameters!r}" if parameters else ""
        raise OptionError(f"no {source} can be made of {value!r}{given}: {error}") from None


def _inline(case: Case) -> Scene:
    """Return a scene written out in its case."""
    findings = Findings()
    own = {key: value for key, value in case.scene.items() if key in SCENE_KEYS}
    scene = read_scene(findings, {"name": case.id, **own}, case.path, os.path.dirname(case.path))
    if scene is None or not findings.none:
        raise SceneError(findings.problems(case.path, lambda where, at: case.place(("scene", *where), at)))
    return scene


def outcome(result: Result) -> str:
    """Return how a result ended, in one word such as converged-stable or max_iterations."""
    if not result.converged:
        return result.verdict
    word = "floor" if result.verdict == Verdict.ROUNDING_FLOOR else "converged"
    return f"{word}-{result.analysis['stability'] or 'unjudged'}"


def agrees(word: str, expected: str) -> bool:
    """Return whether an outcome is the one expected."""
    return word in {expected.replace("balanced", kind, 1) for kind in BALANCED}


def as_expected(result: Result, expect: Mapping[str, Any]) -> bool | None:
    """Return whether outcome, number of slack cables and warnings are those expected; None of nothing."""
    if "outcome" not in expect:
        return None
    slack = result.analysis["slack_count"]
    warned = "warns" not in expect or any(expect["warns"] in said for said in result.warnings)
    return agrees(outcome(result), expect["outcome"]) and expect.get("slack", slack) == slack and warned
