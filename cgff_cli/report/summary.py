"""Many results, a row per scene: as one table for the terminal, as CSV, as lines of JSON."""

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

from cgff_cli.study.machine import Row
from cgff_cli.study.scenes import SUMMARY

if TYPE_CHECKING:
    from rich.console import RenderableType


def summary_csv(rows: Sequence[Row]) -> Iterator[str]:
    """Yield the rows as CSV; what a scene without a result lacks is an empty cell."""
    from cgff_cli.report.csv_out import columns

    return columns({name: [row.get(name) for row in rows] for name in SUMMARY})


def summary_lines(rows: Iterable[Row]) -> Iterator[str]:
    """Yield the rows as JSON, an object a line; what a scene without a result lacks is null."""
    from cgff_cli.report.json_out import line

    for row in rows:
        yield from line((name, row.get(name)) for name in SUMMARY)


def summary_page(rows: Sequence[Row]) -> "Iterator[RenderableType]":
    """Yield the summary table; a row of a scene without a result has `scene` and `verdict` only."""
    from cgff_cli.report.terminal import Aligned, Column, clean, column, duration, verdicts

    def of(name: str) -> list[Any]:
        """Return one field of all rows."""
        return [row.get(name) for row in rows]

    has_cases = any(of("case"))
    own_of_cases = [column("slack", of("slack_count")), column("moves", of("moves"), "{:.3g}".format)]
    yield Aligned(
        [
            Column("scene", list(map(clean, of("scene")))),
            *([column("case", of("case"), to_the_right=False)] if has_cases else []),
            verdicts(of("verdict")),
            column("stability", of("stability"), to_the_right=False),
            *(own_of_cases if has_cases else []),
            column("residual", of("residual_relative"), "{:.1e}".format),
            column("iterations", of("iterations")),
            *([] if has_cases else [column("elements", of("elements"))]),
            column("time", of("seconds"), duration),
        ]
    )
