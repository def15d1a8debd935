"""What is wrong with a scene, collected by place; line and column are worked out only at the end."""

import re
from collections.abc import Callable, Collection, Hashable, Iterable, Sequence
from itertools import chain
from typing import NamedTuple

from cgff_cli.errors import Problem
from cgff_cli.hints import did_you_mean

Where = tuple[str | int, ...]
"""Keys and indices that lead to a value, such as ("elements", "ring", "EA", 3)."""

Mark = tuple[int, int]
"""Line and column, both counted from 1."""

NOWHERE: Mark = (0, 0)
"""The place of what has none: a file that cannot be read, a value from Python."""

LISTED = 100
"""At most so many problems of one file are listed; more would bury the first ones."""

_HINTS = 20
_LINES = 5
_WORD = re.compile(r"[\w+-]+")

Placing = Callable[[Where, bool], Mark]
"""Leads from a value, or from its key, to line and column."""


class _Item(NamedTuple):
    where: Where
    message: str
    at_key: bool
    alike: Hashable


class Findings:
    """Problems found so far in one file, and in the files it refers to.

    faults : (place, message) of what is wrong with the form of the file
    closed : first steps that lead to what is reported as a whole: nothing more is told of it
    tables : paths of the files it refers to
    notes  : what is passed over
    """

    def __init__(
        self,
        faults: Sequence[tuple[Mark, str]] = (),
        label_of: Callable[[Where], str] | None = None,
    ) -> None:
        self.faults = faults
        self.closed: set[str | int] = set()
        self.tables: list[str] = []
        self.notes: list[str] = []
        self._label_of = label_of or label
        self._items: list[_Item] = []
        self._hints: dict[tuple[str, int], str] = {}
        self._files: list[tuple[Findings, str, Placing]] = []

    def of_file(self, path: str, place: Placing, other: "Findings") -> None:
        """Take in what is found in a file that this one refers to."""
        self._files.append((other, path, place))

    def add(self, where: Where, message: str, at_key: bool = False, alike: Hashable = None) -> None:
        """Record a problem of the value at `where`; `at_key` points at its key instead.

        Problems that are `alike` are one mistake, made in many places, and told once.
        """
        self._add(where, where, message, at_key, alike)

    def add_key(self, where: Where, message: str, alike: Hashable = None) -> None:
        """Record a problem of a key; the message speaks of the mapping that holds it."""
        self._add(where, where[:-1], message, True, alike)

    def _add(self, where: Where, named: Where, message: str, at_key: bool, alike: Hashable) -> None:
        if not self.closed or where[0] not in self.closed:
            message = labelled(self._label_of(named), message)
            self._items.append(_Item(where, message, at_key, alike))

    @property
    def none(self) -> bool:
        """Whether nothing was found."""
        return not self.faults and not self._items and all(file.none for file, _, _ in self._files)

    @property
    def wheres(self) -> list[Where]:
        """What the problems are about that have to do with a value."""
        return [item.where for item in self._items]

    def problems(self, path: str, place: Placing) -> list[Problem]:
        """Return the problems of every file, cut to a readable number each.

        Those of the scene itself are placed by `place`; nothing else is told of a value whose form is at
        fault.
        """
        at_fault = {at for at, _ in self.faults}
        placed = [(place(item.where, item.at_key), item.message, item.alike) for item in self._items]
        here = [Problem(path, *at, message) for at, message in self.faults]
        for at, message, others in folded(item for item in placed if item[0] not in at_fault):
            here.append(Problem(path, *at, counted(message, at[0], [line for line, _ in others])))
        of_files = (file.problems(its, at) for file, its, at in self._files)
        return listed(here) + list(dict.fromkeys(chain.from_iterable(of_files)))  # a file may be used twice

    def hint(self, name: str, candidates: Collection[str]) -> str:
        """Return "; did you mean 'x'?", or nothing where no candidate is near.

        Only the first few unknown names are compared: one wrong table would otherwise compare
        every name with every other.
        """
        asked = (name, id(candidates))
        if asked not in self._hints:
            self._hints[asked] = did_you_mean(name, candidates) if len(self._hints) < _HINTS else ""
        return self._hints[asked]


def label(where: Where) -> str:
    """Return a path as people write it: elements.ring.pairs[2]."""
    text = ""
    for step in where:
        if isinstance(step, int):
            text += f"[{step}]"
        else:
            word = step if _WORD.fullmatch(step) and len(step) <= 60 else quoted(step)
            text += f".{word}" if text else word
    return text


def labelled(name: str, message: str) -> str:
    """Return a message behind the name of what it is about, where that has one."""
    return f"{name}: {message}" if name else message


def quoted(text: str, limit: int = 60) -> str:
    """Return a text in quotes on one line, cut where it is long."""
    text = str(text)
    return repr(text) if len(text) <= limit else repr(text[:limit]) + "..."


def first_few(names: Collection[str], limit: int = 3) -> str:
    """Return the first names of a collection in quotes, and how many there are if more."""
    shown = ", ".join(quoted(name) for _, name in zip(range(limit), names, strict=False))
    return shown if len(names) <= limit else f"{shown}, ... ({len(names)} in all)"


def folded(found: Iterable[tuple[Mark, str, Hashable]]) -> list[tuple[Mark, str, list[Mark]]]:
    """Return (place, message, other places) of each mistake: what is alike is one, told where it is first."""
    mistakes: dict[Hashable, tuple[Mark, str, list[Mark]]] = {}
    for place, message, alike in sorted(set(found), key=lambda item: item[:2]):
        key = (place, message) if alike is None else alike
        if key in mistakes:
            mistakes[key][2].append(place)
        else:
            mistakes[key] = (place, message, [])
    return list(mistakes.values())


def counted(message: str, line: int, others: Sequence[int], how_often: str = "times") -> str:
    """Return a message with how often and on which lines the same mistake was made, where not once."""
    if not others:
        return message
    lines = list(map(str, dict.fromkeys([line, *others])))
    shown = ", ".join(lines[:_LINES]) + (", ..." if len(lines) > _LINES else "")
    where = f", on line{'s' if len(lines) > 1 else ''} {shown}" if line else ""
    return f"{message}{'' if message.endswith('?') else ';'} {len(others) + 1} {how_often}{where}"


def listed(problems: list[Problem]) -> list[Problem]:
    """Return the problems of one file, sorted; beyond LISTED only their number and the last place."""
    problems = sorted(set(problems))
    if len(problems) <= LISTED:
        return problems
    rest = f"... and {len(problems) - LISTED} more problems, the last one here"
    return [*problems[:LISTED], problems[-1]._replace(message=rest)]
