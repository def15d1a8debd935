"""Brackets of a text in YAML or JSON: which are open where reading stops, and how deep they nest."""

import re
from collections.abc import Iterator

_PARTS = re.compile(r"""(?<![^\s,:\[{])(?:"(?:[^"\\]|\\.)*"|'[^']*'|\#[^\n]*)|[][{}]""")
CLOSING = {"[": "]", "{": "}"}
_LEVELS = {"[": 1, "{": 1, "]": -1, "}": -1}


Brackets = Iterator[tuple[int, str]]


def brackets(text: str, start: int, end: int) -> Brackets:
    """Yield (offset, bracket) of every bracket outside quotes and comments."""
    for part in _PARTS.finditer(text, start, end):
        if part.group() in _LEVELS:
            yield part.start(), part.group()


def innermost(brackets: Brackets) -> int | None:
    """Return the offset of the innermost bracket still open behind all, or closed by one of another kind.

    None where the first one is closed before the end.
    """
    opened: list[tuple[int, str]] = []
    for offset, mark in brackets:
        if mark in CLOSING:
            opened.append((offset, mark))
            continue
        if not opened or CLOSING[opened[-1][1]] != mark:
            break
        opened.pop()
        if not opened:
            return None
    return opened[-1][0] if opened else None


def deeper(brackets: Brackets, levels: int) -> int | None:
    """Return the offset of the first bracket that opens more than so many levels, or None."""
    for offset, mark in brackets:
        levels -= _LEVELS[mark]
        if levels < 0:
            return offset
    return None
