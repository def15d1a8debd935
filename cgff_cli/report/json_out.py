"""Results as JSON text, in pieces; NaN and infinity, which JSON does not know, become null.

Two layouts of the same fields: `pretty`, one row of a table per line, so that `diff` and `grep` serve;
and `line`, everything on one line, for JSON lines.
"""

import json
import math
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain, islice, repeat
from json.encoder import encode_basestring
from typing import Any, NamedTuple

from cgff_cli.report.columns import Block, element_blocks, node_blocks
from cgff_cli.result import FIELDS, Result

_SMALL = 4  # an object of at most this many entries stays on one line
_BATCH = 1024
_TABLES = ("groups", "nodes", "elements", "reactions", "history")


class Rows(NamedTuple):
    """A JSON object or array whose entries are text already, written one per line."""

    brackets: str
    entries: Iterator[str]


def pretty(fields: Iterable[tuple[str, Any]]) -> Iterator[str]:
    """Yield an object of several lines: one per small field, one per row of a long one."""
    return _object(fields, comma=",", outer="\n  ", inner="\n    ", end="\n")


def line(fields: Iterable[tuple[str, Any]]) -> Iterator[str]:
    """Yield an object on one line."""
    return _object(fields, comma=", ", outer="", inner="", end="")


def result_fields(result: Result) -> Iterator[tuple[str, Any]]:
    """Yield name and value of every field, the long tables as rows made when asked for."""
    for name in FIELDS:
        if name == "nodes":
            yield name, Rows("{}", node_rows(result))
        elif name == "elements":
            yield name, Rows("[]", element_rows(result))
        elif name != "reactions" or result.source.supports:
            yield name, getattr(result, name)


def array(records: Iterable[Mapping[str, Any]]) -> Iterator[str]:
    """Yield an array of objects, one per line."""
    yield from _rows(Rows("[]", map(encode, records)), ",", "\n", "\n  ")
    yield "\n"


def elements(result: Result) -> Iterator[str]:
    """Yield the array of element records, one per line."""
    yield from _rows(Rows("[]", element_rows(result)), ",", "\n", "\n  ")
    yield "\n"


def node_rows(result: Result) -> Iterator[str]:
    """Yield `"name": [x, y(, z)]` for every node."""
    for block in node_blocks(result):
        names, *axes = map(_texts, block.values())
        parts: list[str | list[str]] = [names]
        for before, axis in zip(chain([": ["], repeat(", ")), axes, strict=False):
            parts += [before, axis]
        yield from _joined([*parts, "]"])


def element_rows(result: Result) -> Iterator[str]:
    """Yield one object per element."""
    for block in element_blocks(result):
        yield from _records(block)


def encode(value: Any) -> str:
    """Return a value as JSON on one line."""
    try:
        return _encode(value)
    except ValueError:  # NaN or infinity somewhere inside
        return _encode(_finite(value))


def _records(block: Block) -> Iterator[str]:
    """Return the objects of a block of elements."""
    parts: list[str | list[str]] = []
    for before, (name, values) in zip(chain("{", repeat(", ")), block.items(), strict=False):
        parts.append(f'{before}"{name}": ')
        parts.append(_texts(values))
    return _joined([*parts, "}"])


def _joined(parts: list[str | list[str]]) -> Iterator[str]:
    """Return one text per row of columns (lists) and of what stands between them (text)."""
    columns = (repeat(part) if isinstance(part, str) else part for part in parts)
    return map("".join, zip(*columns, strict=False))  # a third of the time % takes


def _texts(values: list[Any]) -> list[str]:
    """Return the JSON text of each value of a column; columns at once are twice as fast as rows."""
    first = values[0]
    if (first or first is False) and values.count(first) == len(values):  # no zeros: 0.0 equals -0.0
        return [encode(first)] * len(values)
    if isinstance(first, str):
        return list(map(encode_basestring, values))
    return encode(values)[1:-1].split(", ")


def _object(
    fields: Iterable[tuple[str, Any]], *, comma: str, outer: str, inner: str, end: str
) -> Iterator[str]:
    yield "{"
    before = outer
    for name, value in fields:
        yield f"{before}{encode(name)}: "
        rows = _as_rows(name, value)
        if rows is None:
            yield encode(value)
        else:
            yield from _rows(rows, comma, outer, inner)
        before = comma + outer
    yield f"{end}}}\n"


def _rows(rows: Rows, comma: str, outer: str, inner: str) -> Iterator[str]:
    entries = iter(rows.entries)
    before = rows.brackets[0] + inner
    empty = True
    while batch := list(islice(entries, _BATCH)):
        yield before + (comma + inner).join(batch)
        before, empty = comma + inner, False
    yield rows.brackets if empty else outer + rows.brackets[1]


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
