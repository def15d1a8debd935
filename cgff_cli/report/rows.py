"""Many results as data, a row per scene."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any

from cgff_cli.report.result import Result

COLUMNS = (
    "scene",
    "case",
    "verdict",
    "stability",
    "iterations",
    "residual_relative",
    "energy",
    "max_strain",
    "slack_count",
    "smallest_stiffness",
    "seconds",
)
"""What a summary in a file tells of each scene; times, which differ between runs, come last."""

Row = Mapping[str, Any]


def summary_row(scene: str, result: Result) -> dict[str, Any]:
    """Return what a summary needs of a result, which need not be kept for it."""
    return {
        "scene": scene,
        "case": None,
        "verdict": result.verdict,
        "stability": result.analysis.get("stability"),
        "iterations": result.counts["iterations"],
        "residual_relative": result.residual["relative"],
        "energy": result.energy,
        "max_strain": result.max_strain,
        "slack_count": result.analysis.get("slack_count"),
        "smallest_stiffness": result.analysis.get("smallest_stiffness"),
        "seconds": result.seconds,
        "elements": result.source.element_count,
    }


def summary_csv(rows: Sequence[Row]) -> Iterator[str]:
    """Yield the rows as CSV; what a scene without a result lacks is an empty cell."""
    from cgff_cli.report.csv_out import columns

    return columns({name: [row.get(name) for row in rows] for name in COLUMNS})


def summary_lines(rows: Iterable[Row]) -> Iterator[str]:
    """Yield the rows as JSON, an object a line; what a scene without a result lacks is null."""
    from cgff_cli.report.json_out import line

    for row in rows:
        yield from line((name, row.get(name)) for name in COLUMNS)
