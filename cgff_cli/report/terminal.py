"""Plain words and numbers for people: rich text, aligned columns. rich itself is imported here only."""

import io
import math
from collections.abc import Iterable, Iterator, Sequence
from itertools import islice
from typing import NamedTuple

from rich.cells import cell_len
from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

VERDICTS = {
    "converged": ("converged", "green"),
    "rounding_floor": ("converged to rounding", "green"),
    "stationary_not_equilibrium": ("stationary, no equilibrium", "red"),
    "step_vanished": ("steps vanished", "red"),
    "max_iterations": ("iteration limit", "red"),
    "diverged": ("diverged", "red"),
    "interrupted": ("interrupted", "yellow"),
    "bad scene": ("bad scene", "red"),
    "error": ("error", "red"),
    "other_equilibrium": ("another equilibrium", "yellow"),
    "gave_up": ("gave up", "red"),
    "time_limit": ("time limit", "red"),
    "failed": ("failed", "red"),
    "refused": ("refused", "yellow"),
}
"""Verdict -> how it is said, and its colour."""

_WIDE = 10_000  # a pipe has no width: nothing is wrapped there
_DIGITS = 6
_BATCH = 1000


class Column(NamedTuple):
    """One column of a table; numbers stand on the right, styles are one per cell or none at all."""

    title: str
    cells: Sequence[str]
    right: bool = False
    styles: Sequence[str] = ()


def rendered(parts: Iterable[RenderableType], terminal: bool) -> str:
    """Return styled text as one string, coloured for a terminal unless NO_COLOR is set.

    Words wrap at the terminal's width, and nowhere else; text marked `no_wrap` never does. Parts hold
    no plain strings, in which rich would look for markup.
    """
    out = io.StringIO()
    console = Console(file=out, force_terminal=True if terminal else None, width=None if terminal else _WIDE)
    for part in parts:
        console.print(part, soft_wrap=isinstance(part, Text) and bool(part.no_wrap))
    return "".join(f"{line.rstrip(' ')}\n" for line in out.getvalue().splitlines())


def aligned(columns: Sequence[Column]) -> Iterator[Text]:
    """Yield a table: its titles, then its rows, every column as wide as its widest cell."""
    titles, *rows = zip(*(_padded(column) for column in columns), strict=True)
    yield Text("  " + "  ".join(titles).rstrip(), style="bold", no_wrap=True)
    styles = [column.styles or [""] * len(rows) for column in columns]
    lines = map(_line, rows, zip(*styles, strict=True))
    while batch := list(islice(lines, _BATCH)):
        yield Text("\n", no_wrap=True).join(batch)


def _line(cells: Sequence[str], styles: Sequence[str]) -> Text:
    if not any(styles):
        return Text("  " + "  ".join(cells).rstrip())
    text = Text("  ") + Text("  ").join(map(Text, cells, styles))
    text.rstrip()
    return text


def _padded(column: Column) -> list[str]:
    """Return title and cells, all of one width on the screen."""
    cells = (column.title, *column.cells)
    widths = [cell_len(cell) for cell in cells]
    blanks = [" " * (max(widths) - width) for width in widths]
    return [blank + cell if column.right else cell + blank for cell, blank in zip(cells, blanks, strict=True)]


def fields(rows: Iterable[tuple[str, str]]) -> Padding:
    """Return `name  words` lines, the names in one column and long words wrapped beside it."""
    grid = Table.grid(padding=(0, 2, 0, 0))
    grid.add_column(style="dim", no_wrap=True)
    grid.add_column()
    for row in rows:
        grid.add_row(*map(Text, row))
    return Padding(grid, (0, 0, 0, 2))


def verdict_words(verdict: str) -> tuple[str, str]:
    """Return how a verdict is said, and its style."""
    words, colour = VERDICTS.get(verdict, (verdict, "red"))
    return words, f"bold {colour}"


def numbers(values: Sequence[float]) -> list[str]:
    """Return the values of one column with as many decimals as its largest needs for six digits."""
    largest = max((abs(value) for value in values if math.isfinite(value)), default=0.0)
    if largest != 0.0 and not 1e-4 <= largest < 1e7:
        return [f"{value:.{_DIGITS - 1}e}" for value in values]
    decimals = min(max(_DIGITS - 1 - math.floor(math.log10(largest)), 0), 9) if largest else 0
    return [_fixed(value, decimals) for value in values]


def number(value: float) -> str:
    """Return one value with six significant digits."""
    return f"{value:.{_DIGITS}g}"


def _fixed(value: float, decimals: int) -> str:
    text = f"{value:.{decimals}f}"
    return text[1:] if text.startswith("-") and not text.strip("-0.") else text


def duration(seconds: float) -> str:
    """Return a time in ms, s or min."""
    if seconds < 1.0:
        return f"{1000 * seconds:.3g} ms"
    return f"{seconds:.3g} s" if seconds < 120.0 else f"{seconds / 60:.3g} min"


def count(number: int, singular: str, plural: str = "") -> str:
    """Return "no cables", "1 cable" or "2 cables"."""
    return f"{number or 'no'} {singular if number == 1 else plural or singular + 's'}"


def clean(text: str) -> str:
    """Return a user's text with control characters spelled out, which a terminal would obey."""
    return "".join(char if char.isprintable() else ascii(char)[1:-1] for char in text)
