"""The live line: silent at first, one line while it lasts, gone afterwards."""

import subprocess
import sys
from collections.abc import Callable

import pytest

from cgff_cli.report import progress
from cgff_cli.report.progress import Progress

Drawn = Callable[[], list[str]]

ROW = {"iteration": 12, "residual_max": 1.5e-3}


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Return a clock that shows its first entry."""
    now = [100.0]
    monkeypatch.setattr(progress, "perf_counter", lambda: now[0])
    return now


@pytest.fixture
def drawn(monkeypatch: pytest.MonkeyPatch) -> Callable[[], list[str]]:
    """Return what gives the lines drawn so far."""
    written: list[str] = []
    monkeypatch.setattr(progress, "_write", written.append)
    monkeypatch.setattr(progress, "_columns", lambda: 80)
    return lambda: "".join(written).split("\r")[1:]


def test_a_short_solve_shows_nothing(clock: list[float], drawn: Drawn):
    with Progress("prism.yaml") as show:
        clock[0] += progress.DELAY - 0.01
        show(ROW)
    assert drawn() == []


def test_a_long_solve_shows_where_it_is_and_cleans_up(clock: list[float], drawn: Drawn):
    with Progress("[red].yaml") as show:
        clock[0] += 0.6
        show(ROW)
    line, *wiped = drawn()
    assert line == f"{'iteration 12  residual 1.50e-03  600 ms  [red].yaml':79}"
    assert wiped == [" " * 79, ""]


def test_the_line_is_wiped_also_when_the_solve_fails(clock: list[float], drawn: Drawn):
    def solve() -> None:
        with Progress("prism.yaml") as show:
            clock[0] += 0.6
            show(ROW)
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        solve()
    assert drawn()[1:] == [" " * 79, ""]


def test_the_line_is_redrawn_ten_times_a_second_at_most(clock: list[float], drawn: Drawn):
    with Progress("prism.yaml") as show:
        clock[0] += 1.0
        for _ in range(1000):
            clock[0] += 0.001
            show(ROW)
    assert 8 <= len(drawn()) - 2 <= 11


def test_rich_is_imported_only_when_there_is_something_to_show():
    program = (
        "import sys\nfrom cgff_cli.report.progress import Progress\n"
        "with Progress('x') as show: show({'iteration': 0, 'residual_max': 1.0})\n"
        "sys.exit('rich' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program]).returncode == 0
