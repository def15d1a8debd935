"""One live line on standard error while a solve takes its time."""

import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from time import perf_counter
from types import TracebackType
from typing import Any

DELAY = 0.5
"""Seconds of silence: a solve that ends sooner shows nothing and never imports rich."""

_REDRAW = 0.1


class Progress:
    """An observer of a solve, to be used in a `with` block, which wipes the line when it ends.

    The line is drawn by carriage returns alone, which every terminal knows and NO_COLOR allows.
    """

    def __init__(self, title: str, delay: float = DELAY):
        self.title = title
        self.begun = perf_counter()
        self.drawn = self.begun + delay - _REDRAW
        self.width = 0

    def __enter__(self) -> "Progress":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.width:
            _write(f"\r{' ' * self.width}\r")

    def __call__(self, row: Mapping[str, Any]) -> None:
        """Show a row of the history, ten times a second at most."""
        self.show(f"iteration {row['iteration']}  residual {row['residual_max']:.2e}")

    def show(self, words: str) -> None:
        """Show words on what is going on, ten times a second at most."""
        now = perf_counter()
        if now - self.drawn < _REDRAW:
            return
        from rich.cells import set_cell_size

        from cgff_cli.report.terminal import clean, duration

        self.drawn, self.width = now, _columns() - 1
        line = f"{words}  {duration(now - self.begun)}  {clean(self.title)}"  # a long path is cut off last
        _write(f"\r{set_cell_size(line, self.width)}")


def _columns() -> int:
    with suppress(OSError, ValueError):
        return os.get_terminal_size(sys.stderr.fileno()).columns or 80
    return 80


def _write(text: str) -> None:
    with suppress(OSError):  # a terminal that has gone needs no progress
        sys.stderr.write(text)
        sys.stderr.flush()
