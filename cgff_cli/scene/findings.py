"""What is wrong with a scene, collected by place; line and column are worked out only at the end."""

import re
from collections.abc import Callable, Collection, Iterable
from typing import Protocol

from cgff_cli.errors import Problem

Where = tuple[str | int, ...]
"""Keys and indices that lead to a value, such as ("elements", "ring", "EA", 3)."""

Mark = tuple[int, int]
"""Line and column, both counted from 1."""

LISTED = 100
"""At most so many problems of one file are listed; more would bury the first ones."""

_HINTS = 20
_POOL = 1000
_WORD = re.compile(r"[\w+-]+")


class OtherFile(Protocol):
    """A file a scene refers to, which keeps its own problems."""

    @property
    def sound(self) -> bool:
        """Whether no problem was found in it."""

    def problems(self) -> list[Problem]:
        """Return its problems with their places."""


class Findings:
    """Problems found so far, in the scene file itself and in the files it refers to."""

    def __init__(self) -> None:
        self._items: list[tuple[Where, str, bool]] = []
        self._hints: dict[tuple[str, int], str] = {}
        self.other_files: list[OtherFile] = []

    def add(self, where: Where, message: str, at_key: bool = False) -> None:
        """Record a problem of the value at `where`; `at_key` points at its key instead."""
        self._items.append((where, f"{label(where)}: {message}" if where else message, at_key))

    def add_key(self, where: Where, message: str) -> None:
        """Record a problem of a key; the message speaks of the mapping that holds it."""
        owner = where[:-1]
        self._items.append((where, f"{label(owner)}: {message}" if owner else message, True))

    @property
    def none(self) -> bool:
        """Whether nothing was found."""
        return not self._items and all(file.sound for file in self.other_files)

    def problems(
        self, path: str, place: Callable[[Where, bool], Mark], faults: Iterable[tuple[Mark, str]] = ()
    ) -> list[Problem]:
        """Return the problems of every file, cut to a readable number each.

        Those of the scene itself are placed by `place`; `faults` of its form have their places.
        """
        here = [Problem(path, *at, message) for at, message in faults]
        here += [Problem(path, *place(where, at_key), text) for where, text, at_key in self._items]
        return listed(here) + [problem for file in self.other_files for problem in file.problems()]

    def hint(self, name: str, candidates: Collection[str]) -> str:
        """Return "; did you mean 'x'?", or nothing where no candidate is near.

        Only the first few unknown names are compared: one wrong table would otherwise compare
        every name with every other.
        """
        asked = (name, id(candidates))
        if asked not in self._hints:
            near = nearest(name, candidates) if len(self._hints) < _HINTS else None
            self._hints[asked] = f"; did you mean {quoted(near)}?" if near else ""
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


def quoted(text: str, limit: int = 60) -> str:
    """Return a text in quotes on one line, cut where it is long."""
    text = str(text)
    return repr(text) if len(text) <= limit else repr(text[:limit]) + "..."


def nearest(name: str, candidates: Iterable[str]) -> str | None:
    """Return the first of the candidates most like a name, or None where none is near."""
    from difflib import SequenceMatcher

    pool = [word for word in candidates if abs(len(word) - len(name)) <= 1 + len(name) // 3]
    if len(pool) > _POOL:
        pool = [word for word in pool if word[:3] == name[:3]][:_POOL]
    matcher = SequenceMatcher(None, "", name.lower(), autojunk=False)
    best, score = None, 0.6 if len(name) > 2 else 0.5
    for word in pool:
        matcher.set_seq1(word.lower())
        ratio = matcher.ratio() if matcher.quick_ratio() >= score else 0.0
        if ratio > score or (best is None and ratio == score):
            best, score = word, ratio
    return best


def first_few(names: Collection[str], limit: int = 3) -> str:
    """Return the first names of a collection in quotes, and how many there are if more."""
    shown = ", ".join(quoted(name) for _, name in zip(range(limit), names, strict=False))
    return shown if len(names) <= limit else f"{shown}, ... ({len(names)} in all)"


def listed(problems: list[Problem]) -> list[Problem]:
    """Return the problems of one file, sorted; beyond LISTED only their number and the last place."""
    problems = sorted(set(problems))
    if len(problems) <= LISTED:
        return problems
    last = problems[-1]
    rest = len(problems) - LISTED
    return [*problems[:LISTED], more(last, rest)]


def more(last: Problem, count: int) -> Problem:
    """Return the line that stands for problems not listed, at the last of them."""
    return Problem(last.path, last.line, last.column, f"... and {count} more problems, the last one here")
