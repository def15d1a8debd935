"""YAML of other programs: its values with their places, singly and in lists, every fault recorded."""

import os
from typing import Any, cast

from cgff_cli.errors import Problem, SceneError
from cgff_cli.scene.fields import CellColumn, found
from cgff_cli.scene.findings import NOWHERE, Findings, Where, quoted
from cgff_cli.scene.located import Document
from cgff_cli.scene.nodes import ANY_SIZE
from cgff_cli.scene.text import read_text, reason
from cgff_cli.scene.yaml_text import yaml_events
from cgff_cli.values import Rule

Pair = tuple[str, str, Where]
"""The names of two nodes, and where they stand."""


class Source:
    """One YAML file: its values, the place of each, and what is wrong with it."""

    def __init__(self, text: str, path: str):
        self.path = path
        self.document = Document(yaml_events(text.removeprefix("\ufeff")))
        self.findings = Findings(self.document.faults)
        self.values: dict[str, Any] = {}
        if isinstance(self.document.value, dict):
            self.values = self.document.value
        elif self.document.whole:
            self.findings.add((), f"must be a mapping, got {found(self.document.value)}")

    def block(self, *where: str) -> dict[str, Any]:
        """Return the mapping at a place, empty where there is none."""
        value: Any = self.values
        for step in where:
            value = value.get(step)
            if value is None or (isinstance(value, str) and value in ("", "~", "null")):
                return {}
            if not isinstance(value, dict):
                self.findings.add(where, f"must be a mapping, got {found(value)}")
                return {}
        return cast(dict[str, Any], value)

    def number(self, where: Where, value: object, rule: Rule = ANY_SIZE) -> float | None:
        """Return a number, None where it is none or beyond its rule."""
        numbers = CellColumn(self.findings, [value], lambda _: where).numbers(rule)
        return None if numbers is None else float(numbers[0])

    def vector(self, where: Where, value: object) -> list[float] | None:
        """Return three numbers, None where they are none."""
        if not isinstance(value, list) or len(value) != 3:
            self.findings.add(where, f"must be a list of 3 numbers, got {found(value)}")
            return None
        numbers = CellColumn(self.findings, value, lambda i: (*where, i)).numbers(ANY_SIZE)
        return None if numbers is None else numbers.tolist()

    def names(self, where: Where, value: object, what: str) -> list[str] | None:
        """Return a list of names, None where it is none; `what` says which."""
        if not isinstance(value, list) or not all(isinstance(name, str) and name for name in value):
            self.findings.add(where, f"must be {what}, got {found(value)}")
            return None
        return list(map(str, value))

    def pairs(self, where: Where, value: object) -> list[Pair]:
        """Return the pairs of node names in a list; none joins a node to itself."""
        if not isinstance(value, list):
            self.findings.add(where, f"must be a list of pairs such as [a, b], got {found(value)}")
            return []
        read = []
        for i, entry in enumerate(value):
            ends = self.names((*where, i), entry, "two node names such as [a, b]")
            if ends is not None and len(ends) != 2:
                self.findings.add((*where, i), f"must be two node names, got {len(ends)}")
            elif ends is not None:
                read.append((ends[0], ends[1], (*where, i)))
        return read

    def refuse(self) -> None:
        """Raise SceneError where anything was found wrong in this file, or in those it refers to."""
        if not self.findings.none:
            raise SceneError(self.findings.problems(self.path, self.document.place))


def open_source(path: str, base: Source, where: Where) -> Source | None:
    """Return a file that another refers to; None where it cannot be read, which is recorded there."""
    try:
        source = Source(read_text(path), path)
    except SceneError as error:
        faults = [((problem.line, problem.column), problem.message) for problem in error.problems]
        base.findings.of_file(path, lambda *_: NOWHERE, Findings(faults))
        return None
    except (OSError, ValueError) as error:
        base.findings.add(where, f"cannot read {quoted(path)}: {reason(error)}")
        return None
    base.findings.of_file(path, source.document.place, source.findings)
    return source


def beside(path: str, name: str) -> str:
    """Return the path of a file that another names, relative to that one."""
    return os.path.normpath(os.path.join(os.path.dirname(path), name))


def unreadable(path: str, error: Exception) -> SceneError:
    """Return the error of a file that the system does not give."""
    return SceneError([Problem(path, *NOWHERE, f"cannot read the file: {reason(error)}")])
