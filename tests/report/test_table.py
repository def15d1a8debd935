"""The page for the terminal: says what was found, in words, and harms no name."""

import re

import pytest

from cgff_cli import loads, solve
from cgff_cli.report.summary import summary_page
from cgff_cli.report.table import FEW, analysis_words, result_page
from cgff_cli.report.terminal import numbers, rendered
from cgff_cli.result import Result
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.study.scenes import summary_row
from tests.report.conftest import MakeResult


def result_text(result: Result, terminal: bool, full: bool = False) -> str:
    return rendered(result_page(result, full), terminal)


def _chain(count: int) -> Result:
    pairs = ", ".join(f"[n{i}, n{i + 1}]" for i in range(count))
    nodes = ", ".join(f"n{i}: [{i}, 0]" for i in range(count + 1))
    return solve(
        loads(
            f"law: paper\nnodes: {{{nodes}}}\nsupports: {{n0: xy, n{count}: xy}}\n"
            f"elements: {{chain: {{kind: cable, EA: 1.0, rest_length: 0.9, pairs: [{pairs}]}}}}\n"
        ),
        max_iterations=1,
    )


def test_the_page_begins_with_the_name_and_the_verdict(triangle: Result):
    assert result_text(triangle, terminal=False).splitlines()[0] == "triangle  converged"


@pytest.mark.parametrize("verdict", Verdict)
def test_every_verdict_is_said_in_words(altered: MakeResult, verdict: Verdict):
    first = result_text(altered(verdict=verdict), terminal=False).splitlines()[0]
    assert "_" not in first
    assert len(first) > len("triangle  ")


def test_few_elements_are_all_listed(triangle: Result):
    page = result_text(triangle, terminal=False)
    for element in triangle.elements:
        assert re.search(
            rf"{element['group']} .* {re.escape(element['end'])} .* {element['length']:.4f}", page
        )


def test_many_elements_are_summed_up_by_group_unless_asked_for():
    result = _chain(FEW + 1)
    page = result_text(result, terminal=False)
    assert re.search(rf"chain +cable +{FEW + 1} ", page)
    assert "n7" not in page
    assert (
        len(re.findall(r"^  chain ", result_text(result, terminal=False, full=True), re.MULTILINE)) == FEW + 1
    )


def test_names_are_never_taken_for_markup(altered: MakeResult):
    assert "[red]alarm[/red] :bomb:" in result_text(altered(name="[red]alarm[/red] :bomb:"), terminal=False)


def test_names_cannot_command_the_terminal(altered: MakeResult):
    assert "\\x1b[2J" in result_text(altered(name="\x1b[2J"), terminal=False)


def test_a_pipe_wraps_nothing_and_has_no_colour(altered: MakeResult):
    page = result_text(altered(message="long " * 100), terminal=False)
    assert max(map(len, page.splitlines())) > 400
    assert "\x1b" not in page


@pytest.mark.parametrize("width", [60, 80, 120])
def test_a_terminal_wraps_words_at_its_width(
    altered: MakeResult, monkeypatch: pytest.MonkeyPatch, width: int
):
    monkeypatch.setenv("COLUMNS", str(width))
    monkeypatch.setenv("NO_COLOR", "1")
    page = re.sub(r"\x1b\[[0-9;]*m", "", result_text(altered(message="long " * 100), terminal=True))
    assert max(len(line) for line in page.splitlines() if "long" in line) <= width


def test_a_narrow_terminal_gets_the_columns_of_a_table_in_blocks(
    triangle: Result, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setenv("COLUMNS", "40")
    monkeypatch.setenv("NO_COLOR", "1")
    lines = result_text(triangle, terminal=True).splitlines()
    titles = [line.split()[4:] for line in lines if line.startswith("  element ")]
    assert titles == [["length"], ["force"], ["force", "density"]]
    monkeypatch.setenv("COLUMNS", "60")
    assert max(map(len, result_text(triangle, terminal=True).splitlines())) <= 60


def test_a_terminal_gets_colour_unless_no_color_is_set(triangle: Result, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("TERM", "xterm-256color")
    monkeypatch.delenv("NO_COLOR", raising=False)
    assert "\x1b[1;32mconverged" in result_text(triangle, terminal=True)
    monkeypatch.setenv("NO_COLOR", "1")
    assert "\x1b[1;32m" not in result_text(triangle, terminal=True)


def test_slack_cables_are_marked():
    result = solve(
        loads(
            "law: paper\nnodes: {a: [0, 0], b: [1, 0]}\nsupports: {a: xy, b: xy}\n"
            "elements: {c: {kind: cable, EA: 1.0, rest_length: 2.0, pairs: [[a, b]]}}\n"
        )
    )
    assert re.search(r"^  c .* slack$", result_text(result, terminal=False), re.MULTILINE)


@pytest.mark.parametrize(
    ("analysis", "words"),
    [
        (
            {"self_stress_states": 1, "mechanisms": 0, "stability": "stable", "super_stable": True},
            "1 state of self-stress, no mechanisms, stable, super-stable",
        ),
        (
            {"self_stress_states": 2, "mechanisms": 1, "stability": "unstable", "super_stable": False},
            "2 states of self-stress, 1 mechanism, unstable",
        ),
        ({"self_stress_states": None, "mechanisms": None, "stability": None}, "not computed"),
        (
            {"prestressed": False, "slack_cables": ["c: a-b"], "slack_count": 1},
            "no prestress, 1 slack cable (c: a-b)",
        ),
        (
            {"slack_cables": [f"c{i}" for i in range(9)], "slack_count": 50},
            "50 slack cables (c0, c1, c2, c3, c4, c5 and 44 more)",
        ),
    ],
)
def test_the_analysis_is_said_in_words(analysis: dict[str, object], words: str):
    assert analysis_words(analysis) == words


@pytest.mark.parametrize(
    ("values", "texts"),
    [
        ([1.5, -12.25], ["1.5000", "-12.2500"]),
        ([0.0], ["0"]),
        ([1.0, -1e-17], ["1.00000", "0.00000"]),
        ([2e9, 1.0], ["2.00000e+09", "1.00000e+00"]),
        ([float("nan"), 1.0], ["nan", "1.00000"]),
    ],
)
def test_a_column_has_one_number_of_decimals(values: list[float], texts: list[str]):
    assert numbers(values) == texts


def test_the_summary_has_a_row_per_scene_also_for_bad_ones(triangle: Result):
    rows = [summary_row("[b].yaml", triangle), {"scene": "bad.yaml", "verdict": "bad scene"}]
    lines = rendered(summary_page(rows), terminal=False).splitlines()
    assert lines[1].split()[:2] == ["[b].yaml", "converged"]
    assert lines[2].split() == ["bad.yaml", "bad", "scene", "-", "-", "-", "-", "-"]
