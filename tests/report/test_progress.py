"""The live line: silent at first, one line while it lasts, gone afterwards."""

import subprocess
import sys
from collections.abc import Callable
from types import SimpleNamespace

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


def test_a_count_is_told_with_its_rate_and_the_time_left(clock: list[float], drawn: Drawn):
    with Progress("") as show:
        show.count(0, 1000, "scenes")
        clock[0] += 2.0
        show.count(120, 1000, "scenes")
    first, second, *_ = drawn()
    assert first.rstrip() == "0 of 1000 scenes"
    assert second.rstrip() == "120 of 1000 scenes  60/s  15 s left"


def test_what_was_there_before_is_counted_but_is_no_work(clock: list[float], drawn: Drawn):
    with Progress("") as show:
        clock[0] += 10.0
        show.count(905, 1000, "scenes", before=900)
    assert drawn()[0].rstrip() == "905 of 1000 scenes  30/min  3.17 min left"


@pytest.mark.parametrize(
    ("done", "seconds", "told"),
    [
        (1, 1e-6, "1000000/s  1 s left"),
        (5, 2.0, "2.5/s  38 s left"),
        (1, 1200.0, "3.0/h  33 h left"),
        (99, 9.9, "10/s  1 s left"),
    ],
)
def test_rates_and_times_are_told_in_units_a_person_reads(
    clock: list[float], drawn: Drawn, done: int, seconds: float, told: str
):
    with Progress("") as show:
        clock[0] += seconds
        show.count(done, 100, "scenes")
    assert drawn()[0].rstrip() == f"{done} of 100 scenes  {told}"


def test_a_slow_solve_among_many_is_seen_beside_the_count(clock: list[float], drawn: Drawn):
    with Progress("") as show:
        show.count(1, 3, "scenes")
        clock[0] += progress.DELAY - 0.01
        show(ROW)
        clock[0] += 0.02
        show(ROW)
    assert [line.split("  ")[0] for line in drawn()] == ["1 of 3 scenes"] * 2 + ["", ""]
    assert "iteration 12" in drawn()[1]


def test_what_is_written_meanwhile_finds_the_line_empty(clock: list[float], drawn: Drawn):
    with Progress("") as show:
        show.count(1, 3, "scenes")
        show.wipe()
        show.count(2, 3, "scenes")
    assert [line.split("  ")[0] for line in drawn()] == ["1 of 3 scenes", "", "", "2 of 3 scenes", "", ""]


def test_rich_is_imported_only_when_there_is_something_to_show():
    program = (
        "import sys\nfrom cgff_cli.report.progress import Progress\n"
        "with Progress('x') as show: show({'iteration': 0, 'residual_max': 1.0})\n"
        "sys.exit('rich' in sys.modules)"
    )
    assert subprocess.run([sys.executable, "-c", program]).returncode == 0


def test_a_slow_solve_shows_how_its_residual_falls(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(progress, "sys", SimpleNamespace(stderr=SimpleNamespace(encoding="utf-8")))
    line, shown = Progress("x", delay=100.0), []
    for iteration in range(200):
        line({"iteration": iteration, "residual_max": 10.0 ** (-iteration / 20.0)})
        shown.append(line._fall())
    assert shown[0] == shown[10] == ""
    assert shown[30].startswith("  █")
    assert shown[-1].endswith("▁")
    assert max(map(len, shown)) <= 2 + progress.CURVE
    line({"iteration": 0, "residual_max": 1.0})
    assert line._fall() == ""
