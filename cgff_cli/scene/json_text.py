"""JSON text -> plain values at the speed of the standard library, or its events with their places.

The library reads fast but knows no positions. Only a text with a problem is read a second time,
event by event, to say where the problem is.
"""

import json
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

from cgff_cli.scene.brackets import innermost

_TOKEN = re.compile(r'[ \t\n\r,:]*([\[\]{}]|"(?:[^"\\]|\\.)*"|[^ \t\n\r,:\[\]{}"]+)')


_CLOSES = re.compile(r"\s*([]}])")
_CLOSING = {"[": "]", "{": "}"}


class UnclearError(ValueError):
    """Valid JSON that the fast path leaves to the located one: duplicates, NaN, deep nesting."""


def values(text: str) -> Any:
    """Return the values of a JSON text; raises JSONDecodeError or UnclearError."""
    try:
        return json.loads(text, object_pairs_hook=_unique, parse_constant=_constant)
    except json.JSONDecodeError:
        raise
    except (ValueError, RecursionError):
        _check_form(text)
        raise UnclearError from None


def _check_form(text: str) -> None:
    """Raise JSONDecodeError where the form is wrong further on, behind what stopped the fast path."""
    try:
        json.loads(text, parse_int=str)
    except RecursionError:
        return


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    mapping = dict(pairs)
    if len(mapping) != len(pairs):
        raise UnclearError
    return mapping


def _constant(word: str) -> Any:
    raise UnclearError


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
    opened = innermost(text, text.find(text.lstrip()[:1]), at)
    closing = text[at : at + 1] if text[at:].strip() else ""
    if opened is not None and closing in ("", *"]}") and closing != _CLOSING[text[opened]]:
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
    quotes = [begin + mark.start() for mark in re.finditer(r'(?<!\\)"', line)]
    if len(quotes) % 2 == 0:
        return None
    before = [quote for i, quote in enumerate(quotes) if quote <= at and i % 2 == 0]
    return before[-1] if before else quotes[0]


class _Mark(NamedTuple):
    line: int
    column: int


def events(text: str) -> Iterator[Any]:
    """Yield the events of a text known to be JSON, the same ones a YAML reader would."""
    from yaml import events as kinds

    yield kinds.StreamStartEvent()
    yield kinds.DocumentStartEvent()
    line, line_start, seen = 0, 0, 0
    for token in _TOKEN.finditer(text):
        word, offset = token.group(1), token.start(1)
        line += text.count("\n", seen, offset)
        line_start = max(line_start, text.rfind("\n", seen, offset) + 1)
        seen = offset
        yield _event(kinds, word, _Mark(line, offset - line_start))
    yield kinds.DocumentEndEvent()
    yield kinds.StreamEndEvent()


def _event(kinds: Any, word: str, mark: _Mark) -> Any:
    if word == "{":
        return kinds.MappingStartEvent(None, None, True, mark)
    if word == "[":
        return kinds.SequenceStartEvent(None, None, True, mark)
    if word == "}":
        return kinds.MappingEndEvent(mark)
    if word == "]":
        return kinds.SequenceEndEvent(mark)
    if word[0] == '"':
        return kinds.ScalarEvent(None, None, (False, True), json.loads(word), mark, style='"')
    return kinds.ScalarEvent(None, None, (True, False), word, mark)
