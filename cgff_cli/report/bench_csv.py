"""The rows of a bench as CSV: a line per case and method, the tolerances reached as columns."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from cgff_cli.report.csv_out import columns

AFTER = ("message", "digest")
"""Fields that come last, after those of the tolerances."""


def bench_table(rows: Iterable[Mapping[str, Any]]) -> Iterator[str]:
    """Yield the table; cells of what was never reached are empty."""
    lines = [_line(row) for row in rows]
    names = dict.fromkeys(name for line in lines for name in line if name not in AFTER)
    return columns({name: [line.get(name) for line in lines] for name in (*names, *AFTER)})


def _line(row: Mapping[str, Any]) -> dict[str, Any]:
    line = {name: value for name, value in row.items() if name != "reached"}
    for tolerance, point in row["reached"].items():
        line[f"iterations_to_{tolerance}"] = point["iterations"]
        line[f"seconds_to_{tolerance}"] = point["seconds"]
    return line
