"""Suites: YAML lists of cases, read with the place of every mistake."""

import os
from collections.abc import Iterable, Mapping
from itertools import islice
from typing import Any

from cgff_cli.errors import Problem, SceneError
from cgff_cli.options import OPTIONS
from cgff_cli.scene.fields import found, mapping, optional, ruled
from cgff_cli.scene.findings import NOWHERE, Findings, Mark, Where
from cgff_cli.scene.keys import check_keys
from cgff_cli.scene.located import Document, FormError
from cgff_cli.scene.read import shipped
from cgff_cli.scene.schema import OPTION_RULES, SCENE_KEYS
from cgff_cli.scene.text import read_text, reason
from cgff_cli.scene.yaml_text import yaml_events
from cgff_cli.study.case import OUTCOMES, SOURCES, Case, meant
from cgff_cli.study.changes import CHANGES
from cgff_cli.values import Rule

NOTES = ("source", "covers", "slow", "reference", "near", "same_iterations_as", "wrong")
"""Keys of a case for its readers and for tests of its answer; measuring ignores them."""

CASE_KEYS = ("id", "scene", "options", "expect", *NOTES)

EXPECT_KEYS = ("outcome", "slack", "warns", "tolerance", "compare", "closed", "data_digits")

RUN_OPTIONS = ("repeat", "time_limit")
"""Options of comparing that a case may set beside solve options."""

VALUES = OPTION_RULES | {
    "repeat": Rule(kind=int, positive=True),
    "time_limit": Rule(positive=True),
    "outcome": Rule(kind=str, choices=OUTCOMES),
    "slack": Rule(kind=int, least=0),
    "warns": Rule(kind=str),
}
"""Key of a case's options or of what it expects -> what may stand there."""


def standard() -> str:
    """Return the path of the suite that comes with the program."""
    return shipped(os.path.join("suites", "standard"))


def cases_of(paths: Iterable[str]) -> list[Case]:
    """Return the cases of suites and of single scenes; raises SceneError with the mistakes of all suites."""
    cases: dict[tuple[str | None, str], Case] = {}
    problems: list[Problem] = []
    for path in paths:
        try:
            read = _read_suite(path) if _is_suite(path) else [_single(path)]
        except SceneError as error:
            problems += error.problems
            continue
        for case in read:
            first = cases.setdefault((case.suite, case.id), case)
            if first is not case:
                problems.append(case.problem(f"there is one of this name in {first.path} already"))
    if problems:
        raise SceneError(problems)
    return list(cases.values())


def _read_suite(path: str) -> list[Case]:
    """Return the cases of a suite; raises SceneError with every mistake in its form."""
    document = Document(yaml_events(_text(path)))
    findings = Findings(document.faults)
    if document.whole and not isinstance(document.value, list):
        findings.add((), f"a suite must be a list of cases, got {found(document.value)}")
    entries = document.value if isinstance(document.value, list) else []
    cases: dict[str, Case] = {}
    for i, entry in enumerate(entries):
        case = _case(findings, path, document, i, entry)
        if case is not None and cases.setdefault(case.id, case) is not case:
            findings.add((i, "id"), f"case {case.id} is there already")
    if not findings.none:
        raise SceneError(findings.problems(path, document.place))
    return list(cases.values())


def _text(path: str) -> str:
    try:
        return read_text(path).removeprefix("\ufeff")
    except (OSError, ValueError) as error:
        raise SceneError([Problem(path, *NOWHERE, f"cannot read the file: {reason(error)}")]) from None


def _is_suite(path: str) -> bool:
    """Return whether a file holds a list; reads no further than its first character that matters."""
    try:
        first = next(islice(yaml_events(_text(path)), 2, None), None)
    except FormError:
        return False
    return type(first).__name__ == "SequenceStartEvent"


def _single(path: str) -> Case:
    """Return the case that a scene file amounts to."""
    file = os.path.basename(path)
    return Case(os.path.splitext(file)[0], None, {"file": file}, path, lambda where, at_key: NOWHERE)


def _case(findings: Findings, path: str, document: Document, i: int, entry: object) -> Case | None:
    """Return one entry of a suite as a case, None where its form is wrong."""
    values = mapping(findings, (i,), entry, "with id and scene")
    if values is None:
        return None
    check_keys(findings, (i,), values, CASE_KEYS, dict.fromkeys(("id", "scene"), ""))
    name = values.get("id")
    if name is not None and (not isinstance(name, str) or not name or not name.isprintable()):
        findings.add((i, "id"), f"must be a word, got {found(name)}")
        return None
    scene, given, expect = (
        optional(findings, (i, key), values.get(key), "of names to values") or {}
        for key in ("scene", "options", "expect")
    )
    _check_scene(findings, (i, "scene"), scene)
    check_keys(findings, (i, "options"), given, (*OPTIONS, *RUN_OPTIONS))
    check_keys(findings, (i, "expect"), expect, EXPECT_KEYS)
    options, checked = (
        ruled(findings, (i, key), own, VALUES) for key, own in (("options", given), ("expect", expect))
    )

    def place(where: Where, at_key: bool) -> Mark:
        """Return line and column of an entry of this case."""
        return document.place((i, *where), at_key)

    suite = os.path.splitext(os.path.basename(path))[0]
    notes = {key: meant(values[key]) for key in NOTES if key in values}
    return Case(str(name), suite, scene, path, place, options, meant(expect) | checked, notes)


def _check_scene(findings: Findings, where: Where, recipe: Mapping[str, Any]) -> None:
    """Record what cannot be in a scene's recipe: two sources, unknown keys."""
    sources = [name for name in SOURCES if name in recipe]
    if len(sources) > 1:
        findings.add((*where, sources[1]), f"a scene has one source, here {' and '.join(sources)}")
        return
    keys = SOURCES[sources[0]] if sources else (*SOURCES, *SCENE_KEYS)
    check_keys(findings, where, recipe, (*keys, *CHANGES))
