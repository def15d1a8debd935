"""JSON text -> plain values at the speed of the standard library, and the place of any once it is needed.

The library reads fast but knows no positions; where something is wrong, the text is searched for it alone.
"""

import json
import re
from collections.abc import Iterable, Iterator
from typing import Any

from cgff_cli.scene.fields import Plain
from cgff_cli.scene.findings import Mark, Where, quoted
from cgff_cli.scene.json_places import Doubled, Places, has
from cgff_cli.scene.located import DEPTH, in_rows, too_deep
from cgff_cli.scene.yaml_text import CLOSING, brackets, deeper, innermost

_CLOSES = re.compile(r"\s*([]}])")


class JsonDocument:
    """The values of a JSON text, the place of each, and the faults of its form; raises JSONDecodeError.

    value  : dict, list, text, number, true, false or None
    faults : (place, message) of everything that is wrong with the form
    """

    def __init__(self, text: str):
        self._text = text
        self._places = Places(text)
        self._doubled: list[Doubled] = []
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
        self._doubled.append(Doubled(pairs))
        return self._doubled[-1]

    def _is_too_deep(self) -> bool:
        """Return whether the values nest too deep, of which the library has no opinion."""
        self._looked_at = True
        if self.whole and too_deep(self.value):
            self._refuse_depth()
        return not self.whole

    def _refuse_depth(self) -> None:
        at = deeper(brackets(self._text, 0, len(self._text)), DEPTH) or 0
        self.whole, self.faults = False, [(self._places.mark(at), f"nested deeper than {DEPTH} levels")]

    def _doubles(self) -> Iterator[tuple[Mark, str]]:
        """Yield the faults of all keys that stand twice in a mapping."""
        places = list(_doubled_in(self.value, (), dict))
        if len(places) < len(self._doubled):
            places = list(_doubled_in(self.value, (), (dict, list)))
        for where, value in places:
            members = self._places.members(value, self._places.find(self.value, where)[1])
            again = [self._places.mark(members.offsets(row)[0]) for row, _ in value.again]
            first = [self._places.mark(members.offsets(members.row(key))[0])[0] for _, key in value.again]
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
                owner = owner[step] if has(owner, step) else None
            if has(owner, path[-1]) and not isinstance(owner[path[-1]], (str, list, dict)):
                owner[path[-1]] = self._places.word(self._places.find(self.value, where)[1])
                changed = True
        return changed

    def place(self, where: Where, at_key: bool = False) -> Mark:
        """Return the line and column of a value, or of its key; of its owner where it is missing."""
        key, at = self._places.find(self.value, where)
        return self._places.mark(key if at_key else at)


def _doubled_in(value: Any, where: Where, kinds: Any) -> Iterator[tuple[Where, Doubled]]:
    """Yield the way to every mapping with doubled keys inside a value, through values of some kinds."""
    if isinstance(value, Doubled):
        yield where, value
    for step, inside in value.items() if isinstance(value, dict) else enumerate(value):
        if isinstance(inside, kinds):
            yield from _doubled_in(inside, (*where, step), kinds)


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
    opened = innermost(brackets(text, 0, at))
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
