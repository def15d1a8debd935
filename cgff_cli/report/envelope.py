"""Least and greatest forces and reactions over load cases: by element as CSV, by group for people."""

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np

from cgff_cli.cases import Envelope
from cgff_cli.result import Result
from cgff_cli.scene.scene import AXES

if TYPE_CHECKING:
    from rich.console import RenderableType


def envelope_table(result: Result, envelope: Envelope | None) -> Iterator[str]:
    """Yield a row per element, then one per direction that a support holds; result: of any case.

    A reaction stands in the column of forces, its node as start, its axis as end.
    """
    from cgff_cli.report.csv_out import columns

    source, s = result.source, result.structure
    names, held = source.node_names, _held(result)
    owners = [source.groups[owner] for owner in source.owners.tolist()]
    numbers: dict[str, list[Any]] = {name: [] for name in ("least", "least_in", "greatest", "greatest_in")}
    if envelope is not None:
        rows = [*range(len(owners)), *(len(owners) + row for row in _rows_of(result))]
        numbers = {
            "least": envelope.least[rows].tolist(),
            "least_in": [envelope.cases[case] for case in envelope.least_in[rows].tolist()],
            "greatest": envelope.greatest[rows].tolist(),
            "greatest_in": [envelope.cases[case] for case in envelope.greatest_in[rows].tolist()],
        }
    count = len(owners) + len(held)
    return columns(
        {
            "group": [*(group.name for group in owners), *([""] * len(held))],
            "kind": [*(group.kind for group in owners), *(["reaction"] * len(held))],
            "start": [names[row] for row in (*s.start.tolist(), *(row for row, _ in held))],
            "end": [*(names[row] for row in s.end.tolist()), *(axis for _, axis in held)],
            **{name: own or [None] * count for name, own in numbers.items()},
        }
    )


def envelope_page(result: Result, envelope: Envelope | None) -> "Iterator[RenderableType]":
    """Yield least and greatest force of each group and each reaction, and in which cases; result: of any."""
    from cgff_cli.report.table import names_column
    from cgff_cli.report.terminal import Aligned, Column, fields, numbers

    if envelope is None:
        yield fields([("envelope", "no case has a balance of forces")])
        return
    if envelope.left_out:
        yield fields([("envelope", f"without {', '.join(envelope.left_out)}, which did not converge")])
    b, groups = len(result.forces), result.source.groups
    spans = np.split(np.arange(b), np.cumsum([len(group.EA) for group in groups])[:-1])
    held, names = _held(result), result.source.node_names
    for title, labels, rows in (
        ("group", [group.name for group in groups], spans),
        (
            "reaction",
            [f"{names[row]} {axis}" for row, axis in held],
            [np.array([b + row]) for row in _rows_of(result)],
        ),
    ):
        low = [own[envelope.least[own].argmin()] for own in rows]
        high = [own[envelope.greatest[own].argmax()] for own in rows]
        if rows:
            yield Aligned(
                [
                    names_column(title, labels),
                    Column("least", numbers(envelope.least[low].tolist()), True),
                    Column("in", _cases(envelope, envelope.least_in[low])),
                    Column("greatest", numbers(envelope.greatest[high].tolist()), True),
                    Column("in", _cases(envelope, envelope.greatest_in[high])),
                ]
            )


def _cases(envelope: Envelope, numbers: Iterable[int]) -> list[str]:
    return [envelope.cases[number] for number in numbers]


def _held(result: Result) -> list[tuple[int, str]]:
    """Return node row and axis of every direction that a support holds."""
    return [(row, axis) for row, axes in sorted(result.source.supports.items()) for axis in axes]


def _rows_of(result: Result) -> list[int]:
    """Return where these stand among the reactions of an envelope."""
    d, supports = result.source.dimension, sorted(result.source.supports)
    places = {row: d * place for place, row in enumerate(supports)}
    return [places[row] + AXES.index(axis) for row, axis in _held(result)]
