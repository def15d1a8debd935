"""JSON text -> plain values at the speed of the standard library, or its events with their places.

The library reads fast but knows no positions. Only a text with a problem is read a second time,
event by event, to say where the problem is.
"""

import json
import re
from collections.abc import Iterator
from typing import Any, NamedTuple

_TOKEN = re.compile(r'[ \t\n\r,:]*([\[\]{}]|"(?:[^"\\]|\\.)*"|[^ \t\n\r,:\[\]{}"]+)')


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
