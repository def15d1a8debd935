"""Suites: YAML lists of cases, read with the place of every mistake."""

import os
from collections.abc import Iterable, Mapping
from itertools import islice
from typing import Any

from cgff_cli.errors import OptionError, Problem, SceneError
from cgff_cli.options import OPTIONS, checked
from cgff_cli.scene.fields import found, is_absent, mapping
from cgff_cli.scene.findings import NOWHERE, Findings, Mark, Where
from cgff_cli.scene.keys import check_keys
from cgff_cli.scene.located import Document, FormError
from cgff_cli.scene.schema import SCENE_KEYS
from cgff_cli.scene.shipped import shipped
from cgff_cli.scene.text import read_text, reason
from cgff_cli.scene.yaml_text import yaml_events
from cgff_cli.study.case import SOURCES, Case, meant
from cgff_cli.study.changes import CHANGES
from cgff_cli.study.expectation import outcome_fault

NOTES = ("source", "covers", "slow", "reference", "near", "same_iterations_as", "wrong")
"""Keys of a case for its readers and for tests of its answer; measuring ignores them."""

CASE_KEYS = ("id", "scene", "options", "expect", *NOTES)
EXPECT_KEYS = ("outcome", "slack", "warns", "tolerance", "compare", "closed", "data_digits")
RUN_OPTIONS = ("repeat", "time_limit")
"""Options of comparing that a case may set beside solve options."""


def standard() -> str:
    """Return the path of the suite that comes with the program."""
    return shipped(os.path.join("suites", "standard"))


def cases_of(paths: Iterable[str]) -> list[Case]:
    """Return the cases of suites and of single scenes; raises SceneError with the mistakes of all suites."""
    found_cases: list[Case] = []
    problems: list[Problem] = []
    for path in paths:
        try:
            found_cases += read_suite(path) if _is_suite(path) else [_single(path)]
        except SceneError as error:
            problems += error.problems
    seen: dict[tuple[str | None, str], Case] = {}
    for case in found_cases:
        first = seen.setdefault((case.suite, case.id), case)
        if first is not case:
            problems.append(case.problem(f"there is one of this name in {first.path} already"))
    if problems:
        raise SceneError(problems)
    return found_cases


def read_suite(path: str | os.PathLike[str]) -> list[Case]:
    """Return the cases of a suite; raises SceneError with every mistake in its form."""
    shown = os.fspath(path)
    document = Document(yaml_events(_text(shown)))
    findings = Findings(document.faults)
    if document.whole and not isinstance(document.value, list):
        findings.add((), f"a suite must be a list of cases, got {found(document.value)}")
    entries = document.value if isinstance(document.value, list) else []
    name = os.path.splitext(os.path.basename(shown))[0]
    cases = [_case(findings, shown, name, document, i, entry) for i, entry in enumerate(entries)]
    ids: dict[str, int] = {}
    for i, case in enumerate(cases):
        if case is not None and ids.setdefault(case.id, i) != i:
            findings.add((i, "id"), f"case {case.id} is there already")
    if not findings.none:
        raise SceneError(findings.problems(shown, document.place))
    return [case for case in cases if case is not None]


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
    name = os.path.splitext(os.path.basename(path))[0]
    return Case(name, None, {"file": os.path.basename(path)}, path, lambda where, at_key: NOWHERE)


def _case(
    findings: Findings, path: str, suite: str, document: Document, i: int, entry: object
) -> Case | None:
    """Return one entry of a suite as a case, None where its form is wrong."""
    values = mapping(findings, (i,), entry, "with id and scene")
    if values is None:
        return None
    check_keys(findings, (i,), values, CASE_KEYS, dict.fromkeys(("id", "scene"), ""))
    name = values.get("id")
    if name is not None and (not isinstance(name, str) or not name or not name.isprintable()):
        findings.add((i, "id"), f"must be a word, got {found(name)}")
        return None
    blocks = {key: _block(findings, (i, key), values.get(key)) for key in ("scene", "options", "expect")}
    _check_scene(findings, (i, "scene"), blocks["scene"])
    options = _options(findings, (i, "options"), meant(blocks["options"]))
    expect = meant(blocks["expect"])
    _check_expectation(findings, (i, "expect"), expect)
    notes = {key: meant(values[key]) for key in NOTES if key in values}

    def place(where: Where, at_key: bool) -> Mark:
        """Return line and column of an entry of this case."""
        return document.place((i, *where), at_key)

    return Case(str(name), suite, blocks["scene"], path, place, options, expect, notes)


def _block(findings: Findings, where: Where, value: object) -> dict[str, Any]:
    if is_absent(value):
        return {}
    return mapping(findings, where, value, "of names to values") or {}


def _check_scene(findings: Findings, where: Where, recipe: Mapping[str, Any]) -> None:
    """Record what cannot be in a scene's recipe: two sources, unknown keys."""
    sources = [name for name in SOURCES if name in recipe]
    if len(sources) > 1:
        findings.add((*where, sources[1]), f"a scene has one source, here {' and '.join(sources)}")
        return
    keys = SOURCES[sources[0]] if sources else (*SOURCES, *SCENE_KEYS)
    check_keys(findings, where, recipe, (*keys, *CHANGES))


def _check_expectation(findings: Findings, where: Where, expect: dict[str, Any]) -> None:
    check_keys(findings, where, expect, EXPECT_KEYS)
    fault = outcome_fault(expect.get("outcome"))
    if fault:
        findings.add((*where, "outcome"), fault)
    if type(expect.get("slack", 0)) is not int:
        findings.add((*where, "slack"), f"must be a number of cables, got {found(expect['slack'])}")
    if not isinstance(expect.get("warns", ""), str):
        findings.add((*where, "warns"), f"must be words of a warning, got {found(expect['warns'])}")


def _options(findings: Findings, where: Where, given: dict[str, Any]) -> dict[str, Any]:
    """Return the options of a case, each checked."""
    options: dict[str, Any] = {}
    check_keys(findings, where, given, (*OPTIONS, *RUN_OPTIONS))
    for name, value in given.items():
        try:
            if name in OPTIONS:
                options[name] = checked(name, value)
            elif name in RUN_OPTIONS:
                options[name] = _checked_run_option(name, value)
        except OptionError as error:
            findings.add((*where, name), str(error).removeprefix(f"{name} "))
    return options


def _checked_run_option(name: str, value: object) -> float | int:
    whole = name == "repeat"
    if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)) or not value > 0:
        raise OptionError(f"must be a {'whole ' if whole else ''}number > 0, got {value!r}")
    return value
