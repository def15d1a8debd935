"""Plain words and numbers for people: rich text, aligned columns. rich itself is imported here only."""

import io
import math
import os
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import accumulate, repeat
from typing import Any, NamedTuple

from rich.cells import cell_len
from rich.console import Console, ConsoleOptions, RenderableType
from rich.padding import Padding
from rich.table import Table as Grid
from rich.text import Text

from cgff_cli.scene.scene import Scene

VERDICTS = {
    "converged": ("converged", "green"),
    "rounding_floor": ("converged to rounding", "green"),
    "stationary_not_equilibrium": ("stationary, no equilibrium", "red"),
    "step_vanished": ("steps vanished", "red"),
    "max_iterations": ("iteration limit", "red"),
    "diverged": ("diverged", "red"),
    "interrupted": ("interrupted", "yellow"),
    "bad_scene": ("bad scene", "red"),
    "error": ("error", "red"),
    "same_shape": ("cgff's shape", "yellow"),
    "other_equilibrium": ("another equilibrium", "yellow"),
    "gave_up": ("gave up", "red"),
    "time_limit": ("time limit", "red"),
    "failed": ("failed", "red"),
    "refused": ("refused", "yellow"),
}
"""Verdict -> how it is said, and its colour."""

_STABILITY = {True: "stable", False: "not stable", None: "-"}

_WIDE = 10_000  # a pipe has no width: nothing is wrapped there
_DIGITS = 6


class Column(NamedTuple):
    """One column of a table; numbers stand on the right, styles are one per cell or none at all."""

    title: str
    cells: Sequence[str]
    right: bool = False
    styles: Sequence[str] = ()


def column(
    title: str, values: Iterable[Any], text: Callable[[Any], str] = str, to_the_right: bool = True
) -> Column:
    """Return a column of values as texts, a dash where one is lacking."""
    return Column(title, ["-" if value is None else text(value) for value in values], to_the_right)


def verdicts(values: Iterable[str]) -> Column:
    """Return a column of verdicts in words and colours."""
    told = [verdict_words(value) for value in values]
    return Column("verdict", [words for words, _ in told], styles=[style for _, style in told])


def stabilities(values: Iterable[bool | None]) -> Column:
    """Return a column that tells which equilibria are stable."""
    return Column("stability", [_STABILITY[value] for value in values])


def rendered(parts: Iterable[RenderableType], terminal: bool, colour: bool | None = None) -> str:
    """Return a page as one string, its parts a blank line apart; only a terminal's width wraps it.

    colour : whether to write escape sequences; None: for a terminal that can, unless NO_COLOR is set

    Parts hold no plain strings, in which rich would look for markup.
    """
    if colour is None:
        colour = terminal and not os.environ.get("NO_COLOR") and os.environ.get("TERM") != "dumb"
    out = io.StringIO()
    console = Console(
        file=out,
        force_terminal=colour,
        color_system="standard" if colour else None,
        no_color=not colour,
        width=None if terminal else _WIDE,
    )
    for number, part in enumerate(parts):
        if number:
            console.print()
        console.print(part, crop=False)
    return "".join(f"{line.rstrip(' ')}\n" for line in out.getvalue().splitlines())


class Aligned:
    """Titles, then rows, in columns as wide as their widest cells; on a narrow screen, some below the others.

    keys : how many columns name a row, and stand before every block of the others
    """

    def __init__(self, columns: Iterable[Column], keys: int = 1):
        padded = list(map(_padded, columns))
        self.keys, self.others = padded[:keys], padded[keys:]

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> Iterator[Text]:
        """Yield the keys with as many of the other columns as fit, until all have been shown."""
        rest, room = self.others, options.max_width - sum(map(_width, self.keys))
        while True:
            fitting = max(bisect_right(list(accumulate(map(_width, rest))), room), 1)
            yield from _block([*self.keys, *rest[:fitting]])
            rest = rest[fitting:]
            if not rest:
                return
            yield Text("")


def _width(column: Column) -> int:
    return 2 + cell_len(column.title)


def _block(columns: Sequence[Column]) -> Iterator[Text]:
    yield _unwrapped("  " + "  ".join(column.title for column in columns).rstrip(), style="bold")
    rows = zip(*(column.cells for column in columns), strict=True)
    styles = zip(*(column.styles or repeat("") for column in columns), strict=False)
    lines = list(map(_line, rows, styles))
    if lines:
        yield _unwrapped("\n").join(lines)  # rich prints many lines in half the time it takes one by one


def _unwrapped(text: str, style: str = "") -> Text:
    return Text(text, style=style, no_wrap=True, overflow="ignore")


def _line(cells: Sequence[str], styles: Sequence[str]) -> Text:
    if not any(styles):
        return Text("  " + "  ".join(cells).rstrip())
    text = Text("  ") + Text("  ").join(map(Text, cells, styles))
    text.rstrip()
    return text


def _padded(column: Column) -> Column:
    """Return a column whose title and cells are all of one width on the screen."""
    cells = (column.title, *column.cells)
    width = max(map(cell_len, cells))
    blanks = (" " * (width - cell_len(cell)) for cell in cells)
    title, *padded = (
        blank + cell if column.right else cell + blank for cell, blank in zip(cells, blanks, strict=True)
    )
    return column._replace(title=title, cells=padded)


def heading(scene: Scene) -> tuple[str, str]:
    """Return what a page calls a scene, its load case too, and how that is drawn."""
    return clean(f"{scene.name}, {scene.case}" if scene.case else scene.name), "bold"


def fields(rows: Iterable[tuple[str, str]]) -> Padding:
    """Return `name  words` lines, the names in one column and long words wrapped beside it."""
    grid = Grid.grid(padding=(0, 2, 0, 0))
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
    """Return a time in ms, s, min or h."""
    if seconds < 1.0:
        return f"{1000 * seconds:.3g} ms"
    if seconds < 120.0:
        return f"{seconds:.3g} s"
    return f"{seconds / 60:.3g} min" if seconds < 7200.0 else f"{seconds / 3600:.3g} h"


def clean(text: str) -> str:
    """Return a user's text with control characters spelled out, which a terminal would obey."""
    return "".join(char if char.isprintable() else ascii(char)[1:-1] for char in text)
