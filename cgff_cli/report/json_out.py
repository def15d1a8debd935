"""Results as JSON text, in pieces; NaN and infinity, which JSON does not know, become null.

Two layouts of the same fields: `pretty`, one row of a table per line, so that `diff` and `grep` serve;
and `line`, everything on one line, for JSON lines.
"""

import json
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from operator import add
from typing import Any, NamedTuple

from cgff_cli.report.columns import element_blocks, node_blocks
from cgff_cli.result import FIELDS, Result

_SMALL = 4  # an object of at most this many entries stays on one line
_TABLES = ("groups", "nodes", "elements", "reactions", "history")


class Rows(NamedTuple):
    """A JSON object or array whose entries are text already."""

    brackets: str
    entries: Iterator[str]


def pretty(fields: Iterable[tuple[str, Any]]) -> Iterator[str]:
    """Yield an object of several lines: one per small field, one per row of a long one."""
    before = "{\n  "
    for name, value in fields:
        yield f"{before}{encode(name)}: "
        rows = _as_rows(name, value)
        yield from (encode(value),) if rows is None else _rows(rows, ",\n    ", "\n    ", "\n  ")
        before = ",\n  "
    yield "{\n}\n" if before[0] == "{" else "\n}\n"


def line(fields: Iterable[tuple[str, Any]]) -> Iterator[str]:
    """Yield an object on one line."""
    before = "{"
    for name, value in fields:
        yield f"{before}{encode(name)}: "
        yield from _rows(value, ", ") if isinstance(value, Rows) else (encode(value),)
        before = ", "
    yield "{}\n" if before == "{" else "}\n"


def result_fields(result: Result) -> Iterator[tuple[str, Any]]:
    """Yield name and value of every field, the long tables as rows made when asked for."""
    for name in FIELDS:
        if name == "nodes":
            yield name, Rows("{}", node_rows(result))
        elif name == "elements":
            yield name, Rows("[]", element_rows(result))
        elif name != "reactions" or result.source.supports:
            yield name, getattr(result, name)


def array(entries: Iterator[str]) -> Iterator[str]:
    """Yield an array of what is text already, such as `element_rows`, one entry per line."""
    yield from _rows(Rows("[]", entries), ",\n  ", "\n  ", "\n")
    yield "\n"


def node_rows(result: Result) -> Iterator[str]:
    """Yield `"name": [x, y(, z)]` for every node."""
    for block in node_blocks(result):
        for name, *position in zip(*map(_texts, block.values()), strict=True):
            yield f"{name}: [{', '.join(position)}]"


def element_rows(result: Result) -> Iterator[str]:
    """Yield one object per element."""
    for block in element_blocks(result):
        names = [f'"{name}": ' for name in block]
        for values in zip(*map(_texts, block.values()), strict=True):
            yield f"{{{', '.join(map(add, names, values))}}}"


def _texts(column: list[Any]) -> Iterable[str]:
    """Return the values of a column as JSON; one call serves all that are no text."""
    return map(encode, column) if isinstance(column[0], str) else encode(column)[1:-1].split(", ")


def lines(table: Mapping[str, Sequence[Any]]) -> Iterator[str]:
    """Yield the rows of a table, given as column name -> values, each as an object on a line of its own."""
    for row in zip(*table.values(), strict=True):
        yield encode(dict(zip(table, row, strict=True))) + "\n"


def encode(value: Any) -> str:
    """Return a value as JSON on one line."""
    try:
        return _encode(value)
    except ValueError:  # NaN or infinity somewhere inside
        return _encode(_finite(value))


def _rows(rows: Rows, between: str, first: str = "", last: str = "") -> Iterator[str]:
    """Yield a table in its brackets, with what goes between its entries, before them and after."""
    before = opened = rows.brackets[0] + first
    for entry in rows.entries:
        yield before + entry
        before = between
    yield rows.brackets if before is opened else last + rows.brackets[1]


def _as_rows(name: str, value: Any) -> Rows | None:
    if isinstance(value, Rows):
        return value
    if isinstance(value, Mapping) and (name in _TABLES or len(value) > _SMALL):
        return Rows("{}", (f"{encode(str(key))}: {encode(entry)}" for key, entry in value.items()))
    if isinstance(value, (list, tuple)) and value and isinstance(value[0], (str, Mapping, list, tuple)):
        return Rows("[]", map(encode, value))
    return None


def _plain(value: Any) -> Any:
    """Turn numpy's arrays and scalars into Python's; json asks only where it has no rule."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no JSON form")


def _finite(value: Any) -> Any:
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(entry) for entry in value]
    return value


_encode = json.JSONEncoder(allow_nan=False, ensure_ascii=False, default=_plain).encode
