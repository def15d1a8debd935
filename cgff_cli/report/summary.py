"""Many results, a row per scene: as one table for the terminal, as CSV, as lines of JSON."""

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

from cgff_cli.study.machine import Row
from cgff_cli.study.scenes import SUMMARY


def summary_csv(rows: Sequence[Row]) -> Iterator[str]:
    """Yield the rows as CSV; what a scene without a result lacks is an empty cell."""
    from cgff_cli.report.csv_out import columns

    return columns({name: [row.get(name) for row in rows] for name in SUMMARY})


def summary_lines(rows: Iterable[Row]) -> Iterator[str]:
    """Yield the rows as JSON, an object a line; what a scene without a result lacks is null."""
    from cgff_cli.report.json_out import line

    for row in rows:
        yield from line((name, row.get(name)) for name in SUMMARY)


def summary_text(rows: Sequence[Row], *, terminal: bool, colour: bool | None = None) -> str:
    """Return the summary table; a row of a scene without a result has `scene` and `verdict` only."""
    from cgff_cli.report.cells import column, verdicts
    from cgff_cli.report.terminal import Column, aligned, clean, duration, rendered

    def of(name: str) -> list[Any]:
        """Return one field of all rows."""
        return [row.get(name) for row in rows]

    table = [
        Column("scene", list(map(clean, of("scene")))),
        verdicts(of("verdict")),
        column("stability", of("stability"), to_the_right=False),
        column("residual", of("residual_relative"), "{:.1e}".format),
        column("iterations", of("iterations")),
        column("elements", of("elements")),
        column("time", of("seconds"), duration),
    ]
    return rendered(aligned(table), terminal, colour)
