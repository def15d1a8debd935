"""The one CSV writer: tables as text, in pieces; what is not a finite number is an empty cell."""

import csv
import io
import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from cgff_cli.report.columns import element_blocks, node_blocks
from cgff_cli.result import Result

if TYPE_CHECKING:
    from cgff_cli.study.record import Comparison

_LONG = ("nodes", "lengths", "force_densities", "curve", "shape_curve")
"""Fields of a method that are no single values."""


def coordinate_table(result: Result) -> Iterator[str]:
    """Yield `name,x,y[,z]`: the columns a scene's node file has."""
    return _text(node_blocks(result))


def elements(result: Result) -> Iterator[str]:
    """Yield one row per element, the columns of the JSON records."""
    return _text(element_blocks(result))


def history(result: Result) -> Iterator[str]:
    """Yield one row per iteration, row 0 the start."""
    return columns(result.history)


def bench_table(found: Iterable[Mapping[str, Any]]) -> Iterator[str]:
    """Yield one row per case and method, the tolerances reached as columns."""
    rows = []
    for own in found:
        row = {name: value for name, value in own.items() if name != "reached"}
        for tolerance, point in own["reached"].items():
            row |= _when(tolerance, point["iterations"], point["seconds"])
        rows.append(row)
    return _records(rows, last=("message", "digest"))


def comparison_table(found: "Iterable[Comparison]") -> Iterator[str]:
    """Yield one row per scene and method, the points of both curves as columns."""
    rows = []
    for comparison in found:
        for method in comparison.methods:
            row = {"scene": comparison.source.path, **method.to_dict()}
            for curve, of in ((method.curve, "residual"), (method.shape_curve, "shape")):
                for point in curve:
                    row |= _when(f"{of}_{point.tolerance:.0e}", point.iterations, point.seconds)
            rows.append({name: value for name, value in row.items() if name not in _LONG})
    return _records(rows, last=("message",))


def _when(reached: str, iterations: int | None, seconds: float | None) -> dict[str, Any]:
    return {f"iterations_to_{reached}": iterations, f"seconds_to_{reached}": seconds}


def _records(rows: Sequence[Mapping[str, Any]], last: tuple[str, ...]) -> Iterator[str]:
    """Yield rows by name, some names last; what a row lacks is an empty cell."""
    names = dict.fromkeys(name for row in rows for name in row if name not in last)
    return columns({name: [row.get(name) for row in rows] for name in (*names, *last)})


def columns(table: Mapping[str, Sequence[Any]]) -> Iterator[str]:
    """Yield a table given as column name -> values."""
    return _text([table])


def rows(table: Mapping[str, Sequence[Any]]) -> Iterator[str]:
    """Yield the rows of a table given as column name -> values, without its header."""
    return _text([table], has_header=False)


def _text(blocks: Iterable[Mapping[str, Sequence[Any]]], has_header: bool = True) -> Iterator[str]:
    """Yield blocks of one table, the header before the first."""
    for number, block in enumerate(blocks):
        out = io.StringIO()
        writer = csv.writer(out, lineterminator="\n")
        if has_header and number == 0:
            writer.writerow(block)
        writer.writerows(zip(*(map(_cell, values) for values in block.values()), strict=True))
        yield out.getvalue()


def _cell(value: Any) -> Any:
    if hasattr(value, "tolist"):  # numpy's scalars would be written as np.float64(...)
        value = value.tolist()
    if isinstance(value, bool):
        return "true" if value else "false"
    return "" if isinstance(value, float) and not math.isfinite(value) else value
