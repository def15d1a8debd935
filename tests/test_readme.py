"""The README: its commands run and show what it shows, its tables list what there is."""

import doctest
import os
import pty
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

import cgff_cli
from cgff_cli.analysis.equilibrium import SMALL
from cgff_cli.cli import COMMANDS, main
from cgff_cli.cli.common import ExitCode
from cgff_cli.cli.comparing import RIVALS
from cgff_cli.cli.requirements import ALLOWED, MOST_DIRECTIONS
from cgff_cli.mechanics.connectivity import DENSE_ENTRIES
from cgff_cli.options import OPTIONS
from cgff_cli.result import FIELDS
from cgff_cli.rivals.registry import REGISTRY
from cgff_cli.rivals.scipy_solvers import MOST_DENSE
from cgff_cli.solvers.solution import COLUMNS
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.study.runs import EVALUATIONS_PER_ITERATION

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(\w+)\n(.*?)^```$", README, re.MULTILINE | re.DOTALL)
TEXT = re.sub(r"^```.*?^```$", "", README, flags=re.MULTILINE | re.DOTALL)
SHELL = [text for kind, text in BLOCKS if kind == "sh"]
CONSOLE = [text for kind, text in BLOCKS if kind == "console"]
SCENES = [text for kind, text in BLOCKS if kind in ("yaml", "json") and not text.startswith("- ")]
SET_UP = [text for text in SHELL if "pip install" in text]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Stand in a folder with the structures of the clone and a command `cgff`."""
    (tmp_path / "structures").symlink_to(ROOT / "structures")
    command = tmp_path / "bin" / "cgff"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m cgff_cli "$@"\n')
    command.chmod(0o755)
    monkeypatch.setenv("PATH", f"{command.parent}{os.pathsep}{os.environ['PATH']}")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def shown(command: str) -> str:
    """Return what a terminal of 110 columns shows of a shell command: words first, then data."""
    ours, theirs = pty.openpty()
    environment = {**os.environ, "NO_COLOR": "1", "TERM": "xterm", "COLUMNS": "110"}
    running = subprocess.Popen(
        ["bash", "-c", command],
        stdout=theirs,
        stderr=subprocess.PIPE,
        stdin=subprocess.DEVNULL,
        env=environment,
    )
    os.close(theirs)
    data = b"".join(_pieces(ours))
    os.close(ours)
    _, words = running.communicate(timeout=60)
    return re.sub(r"\x1b\[[\d;]*m|\r", "", (words + data).decode())


def _pieces(terminal: int) -> Iterator[bytes]:
    while True:
        try:
            piece = os.read(terminal, 4096)
        except OSError:  # the command has closed its end
            return
        if not piece:
            return
        yield piece


def masked(text: str) -> str:
    """Return a text without durations and the digits of rounding errors, which differ by machine."""
    text = re.sub(r" *\b[\d.]+ (ms|s)$", " TIME", text, flags=re.MULTILINE)
    text = re.sub(r" +time$", " time", text, flags=re.MULTILINE)
    return re.sub(r"\b\d\.\d+e-1\d", "ROUNDING", text)


def rows(heading: str) -> list[list[str]]:
    """Return the cells of the first table below a heading."""
    table = re.search(r"^\|.*?(?=\n\n)", README[README.index(f"# {heading}\n") :], re.MULTILINE | re.DOTALL)
    assert table
    lines = [line.strip("|").replace(r"\|", "\0").split("|") for line in table[0].splitlines()]
    return [[cell.replace("\0", "|").strip() for cell in line] for line in lines[2:]]


def code_in(*cells: str) -> list[str]:
    """Return what stands between backticks."""
    return [word for cell in cells for word in re.findall(r"`([^`]+)`", cell)]


@pytest.mark.parametrize("block", CONSOLE)
def test_a_command_shows_what_the_readme_says(folder: Path, block: str):
    line, _, expected = block.partition("\n")
    made = masked(shown(line.removeprefix("$ "))).splitlines()
    place = 0
    for part in re.split(r"^\.\.\.\n", masked(expected), flags=re.MULTILINE):
        wanted = part.splitlines()
        starts = [i for i in range(place, len(made) + 1) if made[i : i + len(wanted)] == wanted]
        assert starts, "\n".join([f"of `{line}` this is not shown:", part, "but this:", *made])
        place = starts[0] + len(wanted)
    if not block.endswith("...\n"):
        assert place == len(made)


def test_one_command_sets_up_and_solves_and_one_sets_up_and_tests():
    job, tests = (text.strip() for text in SET_UP)
    assert "\n" not in job + tests
    assert job.split(" && ") == [
        "python3 -m venv .venv",
        ".venv/bin/python -m pip install .",
        ".venv/bin/" + CONSOLE[0].splitlines()[0].removeprefix("$ "),
    ]
    run = tests.split(" && ")
    installed = ".venv-test/bin/python -m pip install -c tests/constraints.txt -e '.[test]'"
    assert run[:2] == ["python3 -m venv .venv-test", installed]
    assert [Path(command.split()[0]).name for command in run[2:]] == ["ruff", "ruff", "mypy", "python"]
    assert run[2:4] == [".venv-test/bin/ruff check .", ".venv-test/bin/ruff format --check ."]
    assert run[5].endswith(" -m pytest")


def test_other_shell_lines_run(folder: Path):
    others = [text for text in SHELL if text not in SET_UP and "hyperfine" not in text]
    assert others
    for text in others:
        assert subprocess.run(["bash", "-ec", text], capture_output=True, check=True).stderr == b""


def test_the_first_scene_is_the_shipped_prism_without_its_comments():
    shipped = (ROOT / "structures" / "prism.yaml").read_text()
    assert SCENES[0] == re.sub(r"^#.*\n", "", shipped, flags=re.MULTILINE)


@pytest.mark.parametrize("text", SCENES)
def test_every_scene_shown_solves(folder: Path, text: str):
    result = solved(text)
    assert result.converged
    assert result.warnings == ()


def test_the_csv_tables_and_the_json_say_the_same(folder: Path):
    by_tables, by_json = (solved(text) for text in SCENES if ".csv" in text or text.startswith("{"))
    assert by_tables.nodes == by_json.nodes


def solved(text: str) -> cgff_cli.Result:
    """Return the result of a scene, beside the CSV tables shown."""
    tables = [table for kind, table in BLOCKS if kind == "csv"]
    for name, table in zip(re.findall(r"[\w-]+\.csv", text), tables, strict=False):
        Path(name).write_text(table)
    return cgff_cli.solve(cgff_cli.loads(text))


def test_the_python_shown_gives_what_it_shows(folder: Path):
    (text,) = [text for kind, text in BLOCKS if kind == "python"]
    runner = doctest.DocTestRunner(verbose=False)
    runner.run(doctest.DocTestParser().get_doctest(text, {}, "README", "README.md", 0))
    assert runner.tries > 5
    assert runner.failures == 0


def test_every_command_is_listed_and_no_other():
    assert {code_in(row[0])[0].split()[1] for row in rows("Commands")} == set(COMMANDS)


def test_the_exit_codes_are_those_of_the_program():
    assert [int(code) for code, _ in rows("Exit codes")] == sorted(ExitCode)
    assert f"{ALLOWED.removesuffix('X')}0.02" in TEXT
    assert f"up to {MOST_DIRECTIONS} free directions" in TEXT


def test_the_solve_options_are_those_of_the_program():
    table = [option_row(name) for name in OPTIONS]
    assert [" | ".join(row) for row in rows("Solve options")] == table, "\n| ".join(table)


def option_row(name: str) -> str:
    """Return an option's row in the README."""
    option = OPTIONS[name]
    rules = option.metadata
    if rules["type"] is str:
        value = ", ".join(f"`{allowed}`" for allowed in rules["allowed"])
    elif rules["type"] is int:
        value = "whole number >= 0"
    else:
        value = "number > 0" if rules["below"] == float("inf") else f"number > 0, < {rules['below']:g}"
    return f"`--{name.replace('_', '-')}` | {value} | `{option.default}` | {rules['help']}"


def test_the_fields_of_a_result_are_those_of_the_program():
    table = rows("Results")
    assert [name for row in table for name in code_in(row[0])] == list(FIELDS)
    meaning = {name: code_in(row[1]) for row in table for name in code_in(row[0])}
    result = cgff_cli.solve(ROOT / "structures" / "prism.yaml")
    for field in ("scene", "counts", "timing"):
        assert list(getattr(result, field)) == meaning[field]
    assert set(result.residual) == set(meaning["residual"])
    assert list(result.elements[0]) == meaning["elements"]
    assert list(result.groups["struts"]) == meaning["groups"]
    assert list(COLUMNS) == meaning["history"]


def test_the_fields_of_the_analysis_are_those_of_the_program():
    result = cgff_cli.solve(ROOT / "structures" / "prism.yaml")
    assert {name for row in rows("Analysis") for name in code_in(row[0])} == set(result.analysis)
    assert f"more than {SMALL}\nfree directions or {DENSE_ENTRIES // 1000} 000 entries" in TEXT


def test_the_methods_of_a_comparison_are_those_of_the_program():
    table = rows("Comparison")
    assert {name for row in table for name in code_in(row[1])} == set(REGISTRY)
    flags = {row[0].strip("`"): code_in(row[1]) for row in table if row[0]}
    assert flags == {f"--{flag}": [name] if name != "all" else [] for flag, (name, _) in RIVALS.items()}
    assert f"up to {MOST_DENSE} unknowns" in TEXT
    assert f"take {EVALUATIONS_PER_ITERATION} evaluations for each" in TEXT


def test_the_verdicts_are_those_of_the_program():
    assert [code_in(row[0])[0] for row in rows("Verdicts")] == list(Verdict)


def test_the_size_from_which_matrices_are_sparse_is_that_of_the_program():
    assert f"up to {DENSE_ENTRIES // 1000} 000 entries in rho" in TEXT


def test_every_flag_named_exists():
    context = click.Context(main)
    commands = [main, *(main.get_command(context, name) for name in COMMANDS)]
    options = [option for command in commands if command for option in command.params]
    flags = {flag for option in options for flag in (*option.opts, *option.secondary_opts)}
    flags |= {"--help", *(flag for row in rows("Measured") for flag in re.findall(r"--[\w-]+", row[-1]))}
    console = [text.partition("\n")[0] for text in CONSOLE]
    named = {flag for text in (TEXT, *console) for flag in re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", text)}
    assert {"--tolerance", "--out-dir"} <= named <= flags


def test_every_figure_names_a_command_that_exists():
    commands = [code_in(row[-1]) for row in rows("Measured")]
    assert commands
    for (command,) in commands:
        word, script, *arguments = command.split()
        if word == "python":
            source = (ROOT / script).read_text()
            for flag in [word for word in arguments if word.startswith("--")]:
                assert f'"{flag}"' in source
        else:
            assert command.startswith(("cgff solve structures/", "cgff bench ", "hyperfine -N "))


def test_every_file_named_exists():
    for path in re.findall(r"\b(?:tests|structures)/[\w./-]+\.(?:py|yaml)\b", README):
        assert (ROOT / path).is_file(), path


def test_table_1_converges_on_none_of_the_structures():
    for path in sorted((ROOT / "structures").glob("*.yaml")):
        assert cgff_cli.solve(path, method="table1").verdict == "step_vanished"
