"""Where the values of a JSON text stand: only the way to one is walked, what stands beside it is skipped."""

import re
from array import array
from collections.abc import Iterator
from itertools import islice
from typing import Any

from cgff_cli.scene.fields import Plain
from cgff_cli.scene.findings import Mark, Where
from cgff_cli.scene.keys import Holed

_QUOTED = r'"(?:[^"\\]++|\\.)*+"'
_FLAT = rf'\[(?:[^][{{}}"]++|{_QUOTED})*+\]'
_MEMBER = re.compile(rf'[\s,]*+(?:({_QUOTED})\s*+:\s*+)?+({_FLAT}|{_QUOTED}|[^][{{}}",\s]++|[{{\[])')
_WORD = re.compile(r'[^][{}",\s]*')
_TO_BRACKET = re.compile(rf'(?:[^][{{}}"]++|{_QUOTED}|{_FLAT})*+([][{{}}])')
_FEW = 50  # members of a list that are found anew each time rather than kept: there may be a million lists


class Doubled(Holed):
    """A mapping some keys of which stand in it again: the first ones count. again : (row, key)."""

    def __init__(self, pairs: list[tuple[str, Any]]):
        first: dict[str, int] = {}
        self.again = [(row, key) for row, (key, _) in enumerate(pairs) if first.setdefault(key, row) != row]
        super().__init__({key: pairs[row][1] for key, row in first.items()}, len(self.again))


class Places:
    """Leads from keys and indices to the offset of a value, and from there to line and column."""

    def __init__(self, text: str):
        self.text = text
        self._root = len(text) - len(text.lstrip())
        self._members: dict[int, MembersInText] = {}
        self._seen = (0, 1, 0)

    def find(self, value: Any, where: Where) -> tuple[int, int]:
        """Return the offsets of a key and its value inside a value; of its owner's where it is missing."""
        key = at = self._root
        for step in where:
            if not has(value, step):
                break
            members = self.members(value, at)
            key, at = members.offsets(members.row(step))
            value = value[step]
        return key, at

    def members(self, value: Any, at: int) -> "MembersInText":
        """Return the places of the members of a mapping or list that begins at an offset."""
        if isinstance(value, list) and len(value) < _FEW:
            return MembersInText(self.text, at, value)
        if at not in self._members:
            self._members[at] = MembersInText(self.text, at, value)
        return self._members[at]

    def word(self, at: int) -> Plain:
        """Return a number, true, false or null as it is written."""
        word = _WORD.match(self.text, at)
        return Plain(word.group() if word else "")

    def mark(self, offset: int) -> Mark:
        """Return line and column of an offset, counted on from the offset asked for before."""
        seen, line, begin = self._seen if self._seen[0] <= offset else (0, 1, 0)
        line += self.text.count("\n", seen, offset)
        begin = max(begin, self.text.rfind("\n", seen, offset) + 1)
        self._seen = offset, line, begin
        return line, offset - begin + 1


class MembersInText:
    """Where the keys and values of a mapping or list stand, found as far as they are asked for."""

    def __init__(self, text: str, at: int, value: Any):
        self._text = text
        self._found = array("q")
        self._rest = self._scan(at + 1)
        again = {row for row, _ in value.again} if isinstance(value, Doubled) else ()
        rows = (row for row in range(len(value) + len(again)) if row not in again)
        self._rows = dict(zip(value, rows, strict=True)) if isinstance(value, dict) else None

    def row(self, step: Any) -> int:
        """Return which member a key or an index leads to."""
        return int(step) if self._rows is None else self._rows[step]

    def offsets(self, row: int) -> tuple[int, int]:
        """Return where the key and the value of a member begin; both the value where there is no key."""
        missing = 2 * (row + 1) - len(self._found)
        self._found.extend(islice(self._rest, max(missing, 0)))
        return self._found[2 * row], self._found[2 * row + 1]

    def _scan(self, at: int) -> Iterator[int]:
        while (member := _MEMBER.match(self._text, at)) is not None:
            value, at = member.span(2)
            yield value if member.start(1) < 0 else member.start(1)
            yield value
            if at == value + 1 and self._text[value] in "[{":
                at = _end(self._text, value)


def _end(text: str, at: int) -> int:
    """Return where the mapping or list ends that begins at an offset."""
    depth = 0
    for bracket in _TO_BRACKET.finditer(text, at):
        depth += 1 if bracket.group(1) in "[{" else -1
        if depth == 0:
            return bracket.end()
    return len(text)


def has(value: Any, step: Any) -> bool:
    """Return whether a value has a member of a key or an index."""
    if isinstance(value, list):
        return isinstance(step, int) and step < len(value)
    return isinstance(value, dict) and step in value
