"""Columns that the tables of many rows share: verdicts, stability, and values that may be lacking."""

from collections.abc import Callable, Iterable
from typing import Any

from cgff_cli.report.terminal import Column, verdict_words

_STABILITY = {True: "stable", False: "not stable", None: "-"}


def verdicts(values: Iterable[str]) -> Column:
    """Return a column of verdicts in words and colours."""
    told = [verdict_words(value) for value in values]
    return Column("verdict", [words for words, _ in told], styles=[style for _, style in told])


def stabilities(values: Iterable[bool | None]) -> Column:
    """Return a column that tells which equilibria are stable."""
    return Column("stability", [_STABILITY[value] for value in values])


def column(
    title: str, values: Iterable[Any], text: Callable[[Any], str] = str, to_the_right: bool = True
) -> Column:
    """Return a column of values as texts, a dash where one is lacking."""
    return Column(title, ["-" if value is None else text(value) for value in values], to_the_right)
