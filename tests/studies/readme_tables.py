"""Write into README.md beside this file what `cgff bench` measured: from `<!-- bench: NAME -->` to its end.

    cgff bench -o tests/studies/bench.json && python tests/studies/readme_tables.py

All of it comes from bench.json, also beside this file; the rest of the page stays as it is.
"""

import json
import math
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cgff_cli.report.bench_text import SHOWN, by_case, first_to, remarks, seconds_to

PAGE = Path(__file__).parent / "README.md"
RECORD = Path(__file__).parent / "bench.json"
BLOCK = re.compile(r"(<!-- bench: ([\w ]+) -->\n).*?(<!-- end -->)", re.DOTALL)
COLUMNS = (
    *("cgff", "cgff-residual", "table1", "fdm or schek", "afdm", "dsvd"),
    *("fsolve", "fsolve-fd", "lm", "lbfgs", "dr", "znn", "mc"),
)
FAMILIES_TO = "1e-08"

Row = dict[str, Any]


def filled(text: str, record: dict[str, Any]) -> str:
    """Return the page's text with its blocks made anew."""

    def made(found: re.Match[str]) -> str:
        return found[1] + "\n".join(MAKERS[found[2]](record)) + "\n" + found[3]

    return BLOCK.sub(made, text)


def six_structures(record: dict[str, Any]) -> Iterator[str]:
    """Yield the table of times to each tolerance, a column per method, the first in bold."""
    yield f"| structure | nodes | to | {' | '.join(COLUMNS)} |"
    yield f"|---|--:|---{'|--:' * len(COLUMNS)}|"
    for name, rows in cases(record, lambda family: family == "structures"):
        for tolerance in SHOWN:
            cells = [time_of(rows, column, tolerance) for column in COLUMNS]
            to = tolerance.replace("e-0", "e-")
            yield f"| {name} | {rows[0]['nodes']} | {to} | {' | '.join(cells)} |"


def families(record: dict[str, Any]) -> Iterator[str]:
    """Yield the table of families by size: CGFF, and the fastest of the others."""
    yield "| family | elements | iterations | ms | fastest other | times as long |"
    yield "|---|--:|--:|--:|---|--:|"
    for name, rows in cases(record, lambda family: family != "structures"):
        own = point(rows, "cgff")
        others = [row for row in rows if row["method"] != "cgff"]
        rival = first_to(others, FAMILIES_TO)
        ratio = "-" if rival is None else f"{point(rows, rival)['seconds'] / own['seconds']:.2g}"
        yield (
            f"| {name.rpartition('/')[0]} | {rows[0]['elements']} | {own['iterations']} | "
            f"{milliseconds(own['seconds'])} | {rival or '-'} | {ratio} |"
        )


def not_first(record: dict[str, Any]) -> Iterator[str]:
    """Yield a list of where CGFF is not the first, in either table."""
    asked = [(case, to) for case in cases(record, lambda family: family == "structures") for to in SHOWN]
    asked += [(case, FAMILIES_TO) for case in cases(record, lambda family: family != "structures")]
    reached = [(name, rows, to) for (name, rows), to in asked if first_to(rows, to) is not None]
    shares: dict[tuple[str, str], list[float]] = {}
    for name, rows, to in reached:
        first, own = first_to(rows, to), seconds_to(row_of(rows, "cgff"), to)
        if first != "cgff":
            shares.setdefault((name, first), []).append(
                seconds_to(row_of(rows, first), to) / (own or math.inf)
            )
    lost = [f"{name} ({first}, {span(own)} of its time)" for (name, first), own in shares.items()]
    number = sum(map(len, shares.values()))
    yield f"CGFF is not the first in {number} of {len(reached)} comparisons: {', '.join(lost) or 'none'}."


def span(shares: list[float]) -> str:
    """Return the least and the largest of some numbers, one where they look the same."""
    return " to ".join(dict.fromkeys(f"{end:.2g}" for end in (min(shares), max(shares))))


def answers(record: dict[str, Any]) -> Iterator[str]:
    """Yield what the answers of one energy have to say."""
    words = dict(remarks(record["rows"]))["answers"]
    yield words[0].upper() + words[1:] + "."


def machine(record: dict[str, Any]) -> Iterator[str]:
    """Yield what measured."""
    own = record["machine"]
    yield (
        f"On {own['cores']} cores of {own['processor']}, Python {own['python']}, numpy {own['numpy']}, "
        f"scipy {own['scipy']}."
    )


def cases(record: dict[str, Any], wanted) -> list[tuple[str, list[Row]]]:
    """Return name and rows of the cases whose family, the first word of the name, is wanted."""
    found = [(name, rows) for (_, name), rows in by_case(record["rows"]).items()]
    return [
        (name.removeprefix("structures/"), rows) for name, rows in found if wanted(name.partition("/")[0])
    ]


def time_of(rows: list[Row], column: str, tolerance: str) -> str:
    """Return milliseconds, bold for the first, `-` where the tolerance was never reached."""
    for method in column.split(" or "):
        seconds = seconds_to(row_of(rows, method), tolerance)
        if seconds is not None:
            text = milliseconds(seconds)
            return f"**{text}**" if first_to(rows, tolerance) == method else text
    return "-"


def row_of(rows: list[Row], method: str) -> Row:
    """Return a method's row, an empty one where it was not run."""
    return next((row for row in rows if row["method"] == method), {"reached": {}})


def point(rows: list[Row], method: str) -> dict[str, Any]:
    """Return iterations and seconds of a method to the tolerance of the families' table."""
    return row_of(rows, method)["reached"][FAMILIES_TO]


def milliseconds(seconds: float) -> str:
    """Return a time in ms with three digits."""
    value = 1e3 * seconds
    return f"{value:.0f}" if value >= 100.0 else f"{value:.3g}"


MAKERS = {
    "six structures": six_structures,
    "families": families,
    "not first": not_first,
    "answers": answers,
    "machine": machine,
}
"""Name of a block -> what yields its lines."""


def main() -> None:
    text = PAGE.read_text(encoding="utf-8")
    PAGE.write_text(filled(text, json.loads(RECORD.read_text())), encoding="utf-8")


if __name__ == "__main__":
    main()
