"""Brackets of a text in YAML or JSON: which are open where reading stops, and how deep they nest."""

import re

_PARTS = re.compile(r"""(?<![^\s,:\[{])(?:"(?:[^"\\]|\\.)*"|'[^']*'|\#[^\n]*)|[][{}]""")
_OPENED_BY = {"]": "[", "}": "{"}
_LEVELS = {"[": 1, "{": 1, "]": -1, "}": -1}


def innermost(text: str, start: int, end: int) -> int | None:
    """Return the offset of the innermost bracket still open at `end`, or closed by one of another kind.

    `start` is the offset of a bracket; None where that one is closed before the end.
    """
    opened: list[int] = []
    for part in _PARTS.finditer(text, start, end):
        mark = part.group()
        if mark in _OPENED_BY:
            if not opened or text[opened[-1]] != _OPENED_BY[mark]:
                break
            opened.pop()
            if not opened:
                return None
        elif mark in ("[", "{"):
            opened.append(part.start())
    return opened[-1] if opened else None


def deeper(text: str, start: int, end: int, levels: int) -> int | None:
    """Return the offset of the first bracket from `start` on that opens more than so many levels, or None."""
    for part in _PARTS.finditer(text, start, end):
        levels -= _LEVELS.get(part.group(), 0)
        if levels < 0:
            return part.start()
    return None
