"""Many results as one table for the terminal, a row per scene."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from cgff_cli.report.terminal import Aligned, Column, clean, column, duration, rendered, verdict_column


def summary_text(rows: Iterable[Mapping[str, Any]], *, terminal: bool, colour: bool | None = None) -> str:
    """Return the summary table; a row of a scene without a result has `scene` and `verdict` only."""
    return rendered([Aligned(_columns(list(rows)))], terminal, colour)


def _columns(rows: list[Mapping[str, Any]]) -> Iterator[Column]:
    yield Column("scene", [clean(row["scene"]) for row in rows])
    yield verdict_column(row["verdict"] for row in rows)
    for title, name, text in (
        ("stability", "stability", str),
        ("residual", "residual_relative", "{:.1e}".format),
        ("iterations", "iterations", str),
        ("elements", "elements", str),
        ("time", "seconds", duration),
    ):
        yield column(title, (row.get(name) for row in rows), text, right=name != "stability")
