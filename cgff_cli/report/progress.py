"""One live line on standard error while a solve takes its time."""

import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from math import log10
from time import perf_counter
from types import TracebackType
from typing import Any

DELAY = 0.5
"""Seconds of silence: a solve that ends sooner shows nothing and never imports rich."""

_REDRAW = 0.1

BARS = "▁▂▃▄▅▆▇█"
CURVE = 24
"""Columns of the curve that shows how the residual falls."""

_UNITS = (("s", 1.0), ("min", 60.0), ("h", 3600.0))


class Progress:
    """An observer of a solve, to be used in a `with` block, which wipes the line when it ends.

    The line is drawn by carriage returns alone, which every terminal knows and NO_COLOR allows. Where solves
    are counted it shows the count, and the iterations of one that is slow.
    """

    def __init__(self, title: str, delay: float = DELAY):
        self.title = title
        self.begun = perf_counter()
        self.silent_until = self.begun + delay
        self.drawn = 0.0
        self.width = 0
        self.counted = ""
        self.digits: list[float] = []
        self.every = 1

    def __enter__(self) -> "Progress":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.wipe()

    def __call__(self, row: Mapping[str, Any]) -> None:
        """Show a row of the history of a solve that takes its time, ten times a second at most."""
        self._note(row)
        if perf_counter() >= self.silent_until:
            residual = f"{row['residual_max']:.2e}{self._fall()}"
            self.show(f"{self.counted}iteration {row['iteration']}  residual {residual}")

    def _note(self, row: Mapping[str, Any]) -> None:
        """Keep the digits of the residual; once there are many, those of every other row."""
        if row["iteration"] == 0:
            self.digits, self.every = [], 1
        if row["residual_max"] > 0.0 and row["iteration"] % self.every == 0:
            self.digits.append(log10(row["residual_max"]))
        if len(self.digits) > 2 * CURVE:
            self.digits, self.every = self.digits[::2], 2 * self.every

    def _fall(self) -> str:
        """Return the curve of the residual's digits so far, in blocks; nothing where it has no shape yet."""
        least, most = min(self.digits, default=0.0), max(self.digits, default=0.0)
        if most - least < 1.0 or not str(getattr(sys.stderr, "encoding", "")).lower().startswith("utf"):
            return ""
        step = (most - least) / (len(BARS) - 1)
        shown = self.digits[:: 1 + (len(self.digits) - 1) // CURVE]
        return "  " + "".join(BARS[round((value - least) / step)] for value in shown)

    def show(self, words: str) -> None:
        """Show words on what is going on, ten times a second at most."""
        if self._is_due():
            from cgff_cli.report.terminal import duration

            self._draw(f"{words}  {duration(perf_counter() - self.begun)}")

    def count(self, done: int, total: int, what: str, before: int = 0) -> None:
        """Show how many of all are done, at which rate, and the time left, ten times a second at most.

        before : how many of those done were so when this began; the rate is that of the others
        """
        now = perf_counter()
        self.silent_until = now + DELAY
        self.counted = f"{done} of {total} {what}  "
        if self._is_due():
            self._draw(f"{self.counted}{_pace(done - before, total - done, now - self.begun)}")

    def wipe(self) -> None:
        """Leave the terminal to what else is written; the line is back when next something is shown."""
        if self.width:
            _write(f"\r{' ' * self.width}\r")
            self.width, self.drawn = 0, 0.0

    def _is_due(self) -> bool:
        return perf_counter() - self.drawn >= _REDRAW

    def _draw(self, words: str) -> None:
        from rich.cells import set_cell_size

        from cgff_cli.report.terminal import clean

        self.drawn, self.width = perf_counter(), _columns() - 1
        line = f"{words}  {clean(self.title)}"  # a long path is cut off last
        _write(f"\r{set_cell_size(line, self.width)}")


def _pace(done: int, left: int, seconds: float) -> str:
    """Return the mean rate and the time left; nothing before the first is done."""
    if done <= 0 or seconds <= 0.0:
        return ""
    from cgff_cli.report.terminal import duration

    rate = done / seconds
    unit, each = next(((unit, each) for unit, each in _UNITS if rate * each >= 1.0), _UNITS[-1])
    digits = 0 if rate * each >= 9.95 else 1
    return f"{rate * each:.{digits}f}/{unit}  {duration(max(1.0, round(left / rate)))} left"


def _columns() -> int:
    with suppress(OSError, ValueError):
        return os.get_terminal_size(sys.stderr.fileno()).columns or 80
    return 80


def _write(text: str) -> None:
    with suppress(OSError):  # a terminal that has gone needs no progress
        sys.stderr.write(text)
        sys.stderr.flush()
