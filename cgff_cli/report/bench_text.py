"""The rows of a bench for the terminal: a block per case, and what all of them say together."""

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

from rich.console import Group, RenderableType
from rich.text import Text

from cgff_cli.hints import count
from cgff_cli.report.terminal import (
    Aligned,
    Column,
    clean,
    column,
    duration,
    fields,
    stabilities,
    verdicts,
)
from cgff_cli.study.machine import Row

SHOWN = ("1e-04", "1e-08", "1e-12")
"""Tolerances to which the table shows times."""

TOLD_THE_ANSWER = ("fdm", "afdm", "dsvd", "schek")
"""Methods that are given CGFF's answer, or are laid over it by more than a rigid motion: never the first."""

_NAMED = 5


def first_to(rows: Sequence[Row], tolerance: str) -> str | None:
    """Return the method of one case that is first within a tolerance, None where none gets there.

    A balance that is not stable is no answer, nor is one that the method was told.
    """
    times = {
        row["method"]: seconds
        for row in rows
        if row["method"] not in TOLD_THE_ANSWER
        and row["stable"] is not False
        and (seconds := seconds_to(row, tolerance)) is not None
    }
    return min(times, key=lambda method: times[method], default=None)


def seconds_to(row: Row, tolerance: str) -> float | None:
    """Return the time of a row to a tolerance, None where it was never reached."""
    return (row["reached"].get(tolerance) or {}).get("seconds")


def by_case(rows: Sequence[Row]) -> dict[tuple[str | None, str], list[Row]]:
    """Return the rows of each case, by suite and name, in order."""
    cases: dict[tuple[str | None, str], list[Row]] = {}
    for row in rows:
        cases.setdefault((row["suite"], row["case"]), []).append(row)
    return cases


def case_page(rows: Sequence[Row]) -> Iterator[RenderableType]:
    """Yield the block of one case: its name above a line per method."""
    first, size = rows[0], "no scene"
    if first["nodes"] is not None:
        counted = [count(first["nodes"], "node"), count(first["elements"], "element")]
        size = f"{', '.join(counted)}, {first['dimension']}-D"
    judged = {True: ", as expected", False: ", not as expected", None: ""}
    word = next((row["as_expected"] for row in rows if row["as_expected"] is not None), None)
    title = Text.assemble((clean(first["case"]), "bold"), "  ", (size + judged[word], "dim"))
    reached = {within: [seconds_to(row, within) for row in rows] for within in SHOWN}
    table = [
        Column("method", _of(rows, "method")),
        verdicts(_of(rows, "verdict")),
        stabilities(_of(rows, "stable")),
        column("residual", _of(rows, "residual_relative"), "{:.1e}".format),
        column("shape", _of(rows, "shape_error"), "{:.1e}".format),
        column("iterations", _of(rows, "iterations")),
        *(column(f"to {within}", times, duration) for within, times in reached.items()),
    ]
    yield Group(title, Aligned(table))


def _of(rows: Sequence[Row], name: str) -> list[Any]:
    return [row[name] for row in rows]


def all_cases_page(rows: Sequence[Row]) -> Iterator[RenderableType]:
    """Yield a line per method over all cases, and what is to be told of them."""
    cases = by_case(rows)
    methods = list(dict.fromkeys(row["method"] for row in rows))
    own = {method: [row for row in rows if row["method"] == method] for method in methods}
    ends = {method: Counter(row["verdict"] for row in own[method]) for method in methods}
    balanced = [sum(bool(row["converged"]) for row in own[method]) for method in methods]
    columns = [
        Column("method", methods),
        Column("cases", [str(len(own[method])) for method in methods], True),
        Column("equilibrium", [str(number) for number in balanced], True),
        Column("another", [str(ends[method]["other_equilibrium"]) for method in methods], True),
        Column("out of time", [str(ends[method]["time_limit"]) for method in methods], True),
        Column("failed", [str(ends[method]["failed"]) for method in methods], True),
    ]
    for tolerance in SHOWN:
        firsts = Counter(first_to(case, tolerance) for case in cases.values())
        cells = ["-" if method in TOLD_THE_ANSWER else str(firsts[method]) for method in methods]
        columns.append(Column(f"first to {tolerance}", cells, True))
    yield Aligned(columns)
    yield fields(remarks(rows))


def remarks(rows: Sequence[Row]) -> Iterator[tuple[str, str]]:
    """Yield what all rows say together: about expectations, and about answers of one energy."""
    cases = by_case(rows)
    yield "measured", f"{count(len(cases), 'case')}, {count(len(rows), 'row')}"
    judged = [row for row in rows if row["as_expected"] is not None]
    if judged:
        wrong = [row["case"] for row in judged if not row["as_expected"]]
        right = len(judged) - len(wrong)
        yield "expected", f"{right} of {len(judged)} cases end as their suite says{_but(wrong)}"
    near = [f"{row['case']} ({row['method']})" for row in rows if row["verdict"] == "same_shape"]
    if near:
        yield "cgff's shape", f"found to 1e-8, but out of balance by the difference: {_listed(near)}"
    pairs = [row for row in rows if row["same_answer"] is not None]
    if pairs:
        other = [
            f"{row['case']} ({row['method']}, {row['same_energy_as']})"
            for row in pairs
            if not row["same_answer"]
        ]
        yield (
            "answers",
            f"where two methods claim a stable equilibrium of one energy, it is one shape to 1e-8 in "
            f"{len(pairs) - len(other)} of {count(len(pairs), 'pair')}{_but(other)}",
        )


def _but(names: Sequence[str]) -> str:
    """Return "; not: ..." for exceptions by name, nothing where there are none."""
    return f"; not: {_listed(names)}" if names else ""


def _listed(names: Sequence[str]) -> str:
    """Return names in a row, of many the first few."""
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return f"{', '.join(map(clean, names[:_NAMED]))}{more}"
