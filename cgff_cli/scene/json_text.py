"""JSON text -> plain values at the speed of the standard library, and the place of any once it is needed.

The library reads fast but knows no positions. Where something is wrong, the text is scanned for it alone:
only the mappings and lists that lead to it are walked, and what stands beside it is skipped.
"""

import json
import re
from array import array
from collections.abc import Iterable, Iterator
from itertools import islice
from typing import Any

from cgff_cli.scene.brackets import CLOSING, Brackets, brackets, deeper, innermost
from cgff_cli.scene.fields import Plain
from cgff_cli.scene.findings import Mark, Where, quoted
from cgff_cli.scene.keys import Holed
from cgff_cli.scene.located import DEPTH, in_rows, too_deep

_QUOTED = r'"(?:[^"\\]++|\\.)*+"'
_FLAT = rf'\[(?:[^][{{}}"]++|{_QUOTED})*+\]'
_MEMBER = re.compile(rf'[\s,]*+(?:({_QUOTED})\s*+:\s*+)?+({_FLAT}|{_QUOTED}|[^][{{}}",\s]++|[{{\[])')
_TO_BRACKET = re.compile(rf'(?:[^][{{}}"]++|{_QUOTED}|{_FLAT})*+([][{{}}])')
_WORD = re.compile(r'[^][{}",\s]+')

_CLOSES = re.compile(r"\s*([]}])")


class _Doubled(Holed):
    """A mapping some keys of which stand in it again: the first ones count. again : (row, key)."""

    def __init__(self, pairs: list[tuple[str, Any]]):
        first: dict[str, int] = {}
        self.again = [(row, key) for row, (key, _) in enumerate(pairs) if first.setdefault(key, row) != row]
        super().__init__({key: pairs[row][1] for key, row in first.items()}, len(self.again))


class JsonDocument:
    """The values of a JSON text, the place of each, and the faults of its form; raises JSONDecodeError.

    value  : dict, list, text, number, true, false or None
    faults : (place, message) of everything that is wrong with the form
    """

    def __init__(self, text: str):
        self._text = text
        self._root = len(text) - len(text.lstrip())
        self._members: dict[int, _Members] = {}
        self._seen = (0, 1, 0)
        self._doubled: list[_Doubled] = []
        self._looked_at = False
        self._values: list[Any] = [None]
        self.faults: list[tuple[Mark, str]] = []
        self.whole = True
        try:
            self._values = [self._read()]
        except RecursionError:
            self._refuse_depth()
        if self._doubled and not self._is_too_deep():
            self.faults += self._doubles()

    @property
    def value(self) -> Any:
        """What the whole text holds."""
        return self._values[0]

    def _read(self) -> Any:
        hooks: dict[str, Any] = {"object_pairs_hook": self._mapping, "parse_constant": Plain}
        try:
            return json.loads(self._text, **hooks)
        except json.JSONDecodeError:
            raise
        except ValueError:  # a whole number of thousands of digits
            return json.loads(self._text, parse_int=Plain, **hooks)

    def _mapping(self, pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        mapping = dict(pairs)
        if len(mapping) == len(pairs):
            return mapping
        self._doubled.append(_Doubled(pairs))
        return self._doubled[-1]

    def _is_too_deep(self) -> bool:
        """Return whether the values nest too deep, of which the library has no opinion."""
        self._looked_at = True
        if self.whole and too_deep(self.value):
            self._refuse_depth()
        return not self.whole

    def _refuse_depth(self) -> None:
        at = deeper(brackets(self._text, 0, len(self._text)), DEPTH) or 0
        self.whole, self.faults = False, [(self._mark(at), f"nested deeper than {DEPTH} levels")]

    def _doubles(self) -> Iterator[tuple[Mark, str]]:
        """Yield the faults of all keys that stand twice in a mapping."""
        places = list(_doubled_in(self.value, (), dict))
        if len(places) < len(self._doubled):
            places = list(_doubled_in(self.value, (), (dict, list)))
        for where, value in places:
            members = self._members_of(value, self._find(where)[1])
            again = [self._mark(members.offsets(row)[0]) for row, _ in value.again]
            first = [self._mark(members.offsets(members.row(key))[0])[0] for _, key in value.again]
            wrong = (
                (row - i, again[i], f"duplicate key {quoted(key)}; first on line {first[i]}")
                for i, (row, key) in enumerate(value.again)
            )
            yield from in_rows(where, wrong)

    def sharpened(self, wheres: Iterable[Where]) -> bool:
        """Put in what is written for every number, true, false and null at some places.

        Return whether there was any, or the form is at fault: what was found wrong is then to be found anew.
        """
        if not self._looked_at and self._is_too_deep():
            return True
        changed = False
        for where in wheres:
            owner: Any = self._values
            for step in (path := (0, *where))[:-1]:
                owner = owner[step] if _has(owner, step) else None
            if _has(owner, path[-1]) and not isinstance(owner[path[-1]], (str, list, dict)):
                word = _WORD.match(self._text, self._find(where)[1])
                owner[path[-1]] = Plain(word.group() if word else "")
                changed = True
        return changed

    def place(self, where: Where, at_key: bool = False) -> Mark:
        """Return the line and column of a value, or of its key; of its owner where it is missing."""
        key, at = self._find(where)
        return self._mark(key if at_key else at)

    def _find(self, where: Where) -> tuple[int, int]:
        """Return the offsets of a key and its value; of its owner's where it is missing."""
        value, key, at = self.value, self._root, self._root
        for step in where:
            if not _has(value, step):
                break
            members = self._members_of(value, at)
            key, at = members.offsets(members.row(step))
            value = value[step]
        return key, at

    def _members_of(self, value: Any, at: int) -> "_Members":
        if at not in self._members:
            self._members[at] = _Members(self._text, at, value)
        return self._members[at]

    def _mark(self, offset: int) -> Mark:
        """Return line and column of an offset, counted on from the offset asked for before."""
        seen, line, begin = self._seen if self._seen[0] <= offset else (0, 1, 0)
        line += self._text.count("\n", seen, offset)
        begin = max(begin, self._text.rfind("\n", seen, offset) + 1)
        self._seen = offset, line, begin
        return line, offset - begin + 1


class _Members:
    """Where the keys and values of a mapping or list stand, found as far as they are asked for."""

    def __init__(self, text: str, at: int, value: Any):
        self._text = text
        self._found = array("q")
        self._rest = self._scan(at + 1)
        again = {row for row, _ in value.again} if isinstance(value, _Doubled) else ()
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


def _doubled_in(value: Any, where: Where, kinds: Any) -> Iterator[tuple[Where, _Doubled]]:
    """Yield the way to every mapping with doubled keys inside a value, through values of some kinds."""
    if isinstance(value, _Doubled):
        yield where, value
    for step, inside in value.items() if isinstance(value, dict) else enumerate(value):
        if isinstance(inside, kinds):
            yield from _doubled_in(inside, (*where, step), kinds)


def _brackets(text: str, at: int, end: int) -> Brackets:
    """Yield (offset, bracket) of every bracket of a JSON text but those of lists without lists inside."""
    while (bracket := _TO_BRACKET.match(text, at, end)) is not None:
        at = bracket.end()
        yield at - 1, text[at - 1]


def _end(text: str, at: int) -> int:
    """Return where the mapping or list ends that begins at an offset."""
    depth = 0
    for offset, mark in _brackets(text, at, len(text)):
        depth += 1 if mark in CLOSING else -1
        if depth == 0:
            return offset + 1
    return len(text)


def _has(value: Any, step: Any) -> bool:
    """Return whether a value has a member of a key or an index."""
    if isinstance(value, list):
        return isinstance(step, int) and step < len(value)
    return isinstance(value, dict) and step in value


def fault(text: str, error: json.JSONDecodeError) -> tuple[int, str]:
    """Return where a text stops being JSON, or where what is not finished was begun, and why."""
    at = error.pos
    quote = _open_quote(text, at)
    if quote is not None:
        return quote, "the quote opened here is not closed, or one on its line is too many"
    if text.startswith(("//", "/*", "#"), at):
        return at, "comments are for scenes in YAML, behind #"
    if text.startswith("'", at):
        return at, "names and words stand in double quotes"
    opened = innermost(_brackets(text, 0, at))
    closing = text[at : at + 1] if text[at:].strip() else ""
    if opened is not None and closing in ("", *"]}") and closing != CLOSING[text[opened]]:
        return opened, f"the {text[opened]!r} opened here is not closed"
    return _behind_comma(text, error) or (at, error.msg[:1].lower() + error.msg[1:])


def _behind_comma(text: str, error: json.JSONDecodeError) -> tuple[int, str] | None:
    """Return where a bracket closes behind a comma; Python 3.13 stops at the comma, others behind it."""
    comma = text.rfind(",", 0, error.pos + 1)
    close = _CLOSES.match(text, comma + 1) if comma >= 0 else None
    if close is None or close.end() <= error.pos:
        return None
    wanted = "property name enclosed in double quotes" if close.group(1) == "}" else "value behind the comma"
    return close.start(1), f"expecting {wanted}"


def _open_quote(text: str, at: int) -> int | None:
    """Return where the text in quotes begins that is not closed on its line, or closed at a wrong place."""
    begin = text.rfind("\n", 0, at) + 1
    line = text[begin : text.find("\n", begin) if "\n" in text[begin:] else None]
    if (line.count('"') - line.count('\\"')) % 2 == 0:
        return None
    quotes = [begin + mark.start() for mark in re.finditer(r'(?<!\\)"', line)]
    before = [quote for i, quote in enumerate(quotes) if quote <= at and i % 2 == 0]
    return before[-1] if before else quotes[0]
