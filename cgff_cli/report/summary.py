"""Many results as one table for the terminal, a row per scene."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from cgff_cli.report.terminal import Column, aligned, clean, duration, rendered, verdict_words


def summary_text(rows: Iterable[Mapping[str, Any]], *, terminal: bool, colour: bool | None = None) -> str:
    """Return the summary table; a row of a scene without a result has `scene` and `verdict` only."""
    return rendered(aligned(list(_columns(list(rows)))), terminal, colour)


def _columns(rows: list[Mapping[str, Any]]) -> Iterator[Column]:
    verdicts = [verdict_words(row["verdict"]) for row in rows]
    yield Column("scene", [clean(row["scene"]) for row in rows])
    yield Column("verdict", [words for words, _ in verdicts], styles=[style for _, style in verdicts])
    yield Column("stability", _cells(rows, "stability", str))
    yield Column("residual", _cells(rows, "residual_relative", "{:.1e}".format), True)
    yield Column("iterations", _cells(rows, "iterations", str), True)
    yield Column("elements", _cells(rows, "elements", str), True)
    yield Column("time", _cells(rows, "seconds", duration), True)


def _cells(rows: list[Mapping[str, Any]], name: str, text: Callable[[Any], str]) -> list[str]:
    return ["-" if row.get(name) is None else text(row[name]) for row in rows]
