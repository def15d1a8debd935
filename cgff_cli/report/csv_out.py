"""The one CSV writer: tables as text, in pieces; what is not a finite number is an empty cell."""

import csv
import io
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from cgff_cli.report.columns import element_blocks, node_blocks
from cgff_cli.result import Result


def coordinate_table(result: Result) -> Iterator[str]:
    """Yield `name,x,y[,z]`: the columns a scene's node file has."""
    return _text(node_blocks(result))


def elements(result: Result) -> Iterator[str]:
    """Yield one row per element, the columns of the JSON records."""
    return _text(element_blocks(result))


def history(result: Result) -> Iterator[str]:
    """Yield one row per iteration, row 0 the start."""
    return columns(result.history)


def columns(table: Mapping[str, Sequence[Any]]) -> Iterator[str]:
    """Yield a table given as column name -> values."""
    return _text([table])


def _text(blocks: Iterable[Mapping[str, Sequence[Any]]]) -> Iterator[str]:
    """Yield blocks of one table, the header before the first."""
    for number, block in enumerate(blocks):
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        if number == 0:
            writer.writerow(block)
        writer.writerows(zip(*(map(_cell, values) for values in block.values()), strict=True))
        yield out.getvalue()


def _cell(value: Any) -> Any:
    if hasattr(value, "tolist"):  # numpy's scalars would be written as np.float64(...)
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    return "" if isinstance(value, float) and not math.isfinite(value) else value
