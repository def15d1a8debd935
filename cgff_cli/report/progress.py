"""One live line on standard error while a solve takes its time."""

from collections.abc import Mapping
from time import perf_counter
from types import TracebackType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from rich.live import Live

DELAY = 0.5
"""Seconds of silence: a solve that ends sooner shows nothing and never imports rich."""

_REDRAW = 0.1


class Progress:
    """An observer of a solve, to be used in a `with` block, which wipes the line when it ends."""

    def __init__(self, title: str, delay: float = DELAY):
        self.title = title
        self.begun = perf_counter()
        self.drawn = self.begun + delay - _REDRAW
        self.live: Live | None = None

    def __enter__(self) -> "Progress":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.live is not None:
            self.live.stop()

    def __call__(self, row: Mapping[str, Any]) -> None:
        """Show a row of the history, ten times a second at most."""
        self.show(f"iteration {row['iteration']}  residual {row['residual_max']:.2e}")

    def show(self, words: str) -> None:
        """Show words on what is going on, ten times a second at most."""
        now = perf_counter()
        if now - self.drawn < _REDRAW:
            return
        self.drawn = now
        if self.live is None:
            self.live = _started()
        self.live.update(self._line(words, now), refresh=True)

    def _line(self, words: str, now: float) -> Any:
        from rich.text import Text

        from cgff_cli.report.terminal import clean, duration

        return Text.assemble(  # a long path comes last, where it is cut off without harm
            (f"{words}  {duration(now - self.begun)}  ", "dim"),
            (clean(self.title), "bold"),
            no_wrap=True,
            overflow="ellipsis",
        )


def _started() -> "Live":
    from rich.console import Console
    from rich.live import Live

    live = Live(
        console=Console(stderr=True),
        auto_refresh=False,
        transient=True,
        redirect_stdout=False,
        redirect_stderr=False,
    )
    live.start()
    return live
