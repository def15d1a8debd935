"""Many results, a row per scene: as one table for the terminal, as CSV, as lines of JSON."""

from collections.abc import Callable, Iterable, Iterator, Sequence
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
    from cgff_cli.report.terminal import Column, aligned, clean, duration, rendered, verdict_words

    def cells(title: str, name: str, text: Callable[[Any], str], to_the_right: bool = True) -> Column:
        """Return a column of one field, a dash where it is lacking."""
        found = ["-" if row.get(name) is None else text(row[name]) for row in rows]
        return Column(title, found, to_the_right)

    verdicts = [verdict_words(row["verdict"]) for row in rows]
    table = [
        Column("scene", [clean(row["scene"]) for row in rows]),
        Column("verdict", [words for words, _ in verdicts], styles=[style for _, style in verdicts]),
        cells("stability", "stability", str, to_the_right=False),
        cells("residual", "residual_relative", "{:.1e}".format),
        cells("iterations", "iterations", str),
        cells("elements", "elements", str),
        cells("time", "seconds", duration),
    ]
    return rendered(aligned(table), terminal, colour)
