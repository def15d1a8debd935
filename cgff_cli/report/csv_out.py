"""Results as CSV text, in pieces; what is not a finite number is an empty cell."""

import csv
import io
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from cgff_cli.report.columns import ELEMENT_COLUMNS, Block, element_blocks, node_blocks, node_columns
from cgff_cli.result import Result

_SPECIAL = re.compile('[,"\r\n]')


def coordinates(result: Result) -> Iterator[str]:
    """Yield `name,x,y[,z]`: the columns a scene's node file has."""
    return _text(node_columns(result), node_blocks(result))


def elements(result: Result) -> Iterator[str]:
    """Yield one row per element, the columns of the JSON records."""
    return _text(ELEMENT_COLUMNS, element_blocks(result))


def history(result: Result) -> Iterator[str]:
    """Yield one row per iteration, row 0 the start."""
    return columns(result.history)


def columns(table: Mapping[str, Sequence[Any]]) -> Iterator[str]:
    """Yield a table given as column name -> values."""
    return _text(tuple(table), [{name: list(values) for name, values in table.items()}])


def _text(header: Sequence[str], blocks: Iterable[Block]) -> Iterator[str]:
    yield _lines([header])
    for block in blocks:
        cells = [_cells(values) for values in block.values()]
        rows = zip(*cells, strict=True)
        yield _lines(rows) if _needs_quotes(block) else "\n".join(map(",".join, rows)) + "\n"


def _needs_quotes(block: Block) -> bool:
    """Return whether csv must look at each cell; joining them is three times as fast."""
    if len(block) < 2 or not all(block.values()):
        return True  # an empty cell alone on its line is written as ""
    columns = (values for values in block.values() if str in set(map(type, values)))
    return any(_SPECIAL.search("".join(v for v in values if type(v) is str)) for values in columns)


def _lines(rows: Iterable[Iterable[Any]]) -> str:
    buffer = io.StringIO()
    csv.writer(buffer, lineterminator="\n").writerows(rows)
    return buffer.getvalue()


def _cells(values: list[Any]) -> list[str]:
    kinds = set(map(type, values))
    if kinds == {str}:
        return values
    if kinds == {float} and all(map(math.isfinite, values)):
        return list(map(repr, values))
    return [_cell(value) for value in values]


def _cell(value: Any) -> str:
    if hasattr(value, "tolist"):  # numpy's scalars would be written as np.float64(...)
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    return str(value)
