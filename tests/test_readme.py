"""The README and its pages: commands show what they say, tables list what there is, links lead somewhere."""

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
from cgff_cli.analysis.nulls import DENSE, MOST_SOFT
from cgff_cli.analysis.reasons import MOST
from cgff_cli.cli import COMMANDS, main
from cgff_cli.cli.common import ExitCode
from cgff_cli.cli.comparing import RIVALS
from cgff_cli.cli.requirements import ALLOWED, MOST_DIRECTIONS
from cgff_cli.mechanics.connectivity import DENSE_ENTRIES
from cgff_cli.options import OPTIONS
from cgff_cli.report.columns import element_blocks, node_blocks
from cgff_cli.result import FIELDS
from cgff_cli.rivals.registry import REGISTRY
from cgff_cli.rivals.scipy_solvers import MOST_DENSE
from cgff_cli.solvers.solution import COLUMNS
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.study.judge import EVALUATIONS_PER_ITERATION
from cgff_cli.study.scenes import SUMMARY
from cgff_cli.study.shapes import SAME
from cgff_cli.study.starts import REACHES
from tests.pages import PAGES, README, ROOT, WORDS, Block, blocks, code_in, rows, section

SHELL = [block.text for block in blocks("sh")]
CONSOLE = blocks("console")
SCENES = [block for kind in ("yaml", "json") for block in blocks(kind) if not block.text.startswith("- ")]
SET_UP = [text for text in SHELL if "pip install" in text]
MOST_LINES = 300
SCREEN = (24, 80)
WIDE = 110


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


def shown(command: str, columns: int) -> str:
    """Return what a terminal shows of a shell command: words first, then data."""
    ours, theirs = pty.openpty()
    environment = {**os.environ, "NO_COLOR": "1", "TERM": "xterm", "COLUMNS": str(columns)}
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


def differs(block: Block) -> str:
    """Return what a console block says and the program does not, or nothing."""
    line, _, expected = block.text.partition("\n")
    columns = SCREEN[1] if max(map(len, block.text.splitlines())) <= SCREEN[1] else WIDE
    made = masked(shown(line.removeprefix("$ "), columns)).splitlines()
    place, told = 0, [f"{block.place}: of `{line}`"]
    for part in re.split(r"^\.\.\.\n", masked(expected), flags=re.MULTILINE):
        wanted = part.splitlines()
        starts = [i for i in range(place, len(made) + 1) if made[i : i + len(wanted)] == wanted]
        if not starts:
            return "\n".join([*told, "this is not shown:", part, "but this:", *made])
        place = starts[0] + len(wanted)
    if block.text.endswith("...\n") or place == len(made):
        return ""
    return "\n".join([*told, "this is shown as well:", *made[place:]])


def test_a_command_shows_what_the_page_says(folder: Path):
    wrong = [told for block in CONSOLE if (told := differs(block))]
    assert not wrong, "\n\n".join(wrong)


def test_another_figure_would_be_seen(folder: Path):
    first = CONSOLE[0]
    assert "of `$ cgff solve" in differs(
        first._replace(text=first.text.replace("8 iterations", "7 iterations"))
    )
    assert "as well" in differs(first._replace(text=first.text.rpartition("...\n")[0]))


def test_the_readme_takes_five_minutes_and_its_first_screen_shows_a_command_and_its_output():
    lines = README.text.splitlines()
    assert len(lines) <= MOST_LINES
    height, width = SCREEN
    assert max(map(len, lines[:height])) <= width
    assert CONSOLE[0].text in "\n".join([*lines[:height], ""])


def test_one_command_sets_up_and_solves_and_one_sets_up_and_tests():
    job, tests = (text.strip() for text in SET_UP)
    assert "\n" not in job + tests
    assert job.split(" && ") == [
        "python3 -m venv .venv",
        ".venv/bin/python -m pip install .",
        ".venv/bin/" + CONSOLE[0].text.splitlines()[0].removeprefix("$ "),
    ]
    run = tests.split(" && ")
    installed = ".venv-test/bin/python -m pip install -c tests/constraints.txt -e '.[test]'"
    assert run[:2] == ["python3 -m venv .venv-test", installed]
    assert [Path(command.split()[0]).name for command in run[2:]] == ["ruff", "ruff", "mypy", "python"]
    assert run[2:4] == [".venv-test/bin/ruff check .", ".venv-test/bin/ruff format --check ."]
    assert run[5].endswith(" -m pytest")


def test_other_shell_lines_run(folder: Path):
    others = [text for text in SHELL if text not in SET_UP]
    assert others
    for text in others:
        assert subprocess.run(["bash", "-ec", text], capture_output=True, check=True).stderr == b""


def test_the_first_scene_is_the_shipped_prism_but_for_comments():
    shipped = (ROOT / "structures" / "prism.yaml").read_text()
    uncommented = re.sub(r" +#.*$", "", SCENES[0].text, flags=re.MULTILINE)
    assert uncommented == re.sub(r"^#.*\n", "", shipped, flags=re.MULTILINE)


def test_every_scene_shown_solves_without_a_warning(folder: Path):
    ends = {scene.place: solved(scene.text) for scene in SCENES}
    assert not [
        (place, end.message, end.warnings) for place, end in ends.items() if not end.converged or end.warnings
    ]


def test_the_csv_tables_and_the_json_say_the_same(folder: Path):
    texts = [scene.text for scene in SCENES]
    by_tables, by_json = (solved(text) for text in texts if ".csv" in text or text.startswith("{"))
    assert by_tables.nodes == by_json.nodes


def solved(text: str) -> cgff_cli.Result:
    """Return the result of a scene, beside the CSV tables shown."""
    tables = [table.text for table in blocks("csv")]
    for name, table in zip(re.findall(r"[\w-]+\.csv", text), tables, strict=False):
        Path(name).write_text(table)
    return cgff_cli.solve(cgff_cli.loads(text))


def test_the_python_shown_gives_what_it_shows(folder: Path):
    runner = doctest.DocTestRunner(verbose=False)
    for block in blocks("python"):
        name, _, line = block.place.partition(":")
        runner.run(doctest.DocTestParser().get_doctest(block.text, {}, name, name, int(line)))
    assert runner.tries > 5
    assert runner.failures == 0


def test_every_command_is_listed_and_no_other():
    assert {code_in(row[0])[0].split()[1] for row in rows("Commands")} == set(COMMANDS)


def test_the_exit_codes_are_those_of_the_program():
    assert [int(code) for code, _ in rows("Exit codes")] == sorted(ExitCode)
    assert f"{ALLOWED.removesuffix('X')}0.02" in section("Exit codes")
    assert f"up to {MOST_DIRECTIONS} free directions" in section("Exit codes")


def test_the_solve_options_are_those_of_the_program():
    table = [option_row(name) for name in OPTIONS]
    assert [" | ".join(row) for row in rows("Solve options")] == table, "\n| ".join(table)


def option_row(name: str) -> str:
    """Return an option's row in the table."""
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
    told = " ".join(section("Analysis").split())
    assert f"more than {MOST} free directions" in told
    assert f"more than {DENSE_ENTRIES // 1000} 000 entries" in told
    assert f"more than {MOST_SOFT} of them, and rows and columns are more than {DENSE}" in told


def test_the_columns_of_csv_tables_are_those_of_the_program():
    columns = {row[0]: code_in(row[2]) for row in rows("CSV")}
    assert columns["summary"] == list(SUMMARY)
    result = cgff_cli.solve(ROOT / "structures" / "prism.yaml")
    assert columns["coordinates"] == list(next(node_blocks(result)))
    assert list(next(element_blocks(result))) == list(result.elements[0])


def test_the_fields_of_a_prestress_are_those_of_the_program():
    found = cgff_cli.prestress(cgff_cli.new("prism"))
    table = rows("Prestress fields")
    assert {name for row in table for name in code_in(row[0])} == set(found.to_dict())
    (groups,) = (code_in(row[1]) for row in table if row[0] == "`groups`")
    assert groups == list(found.groups["struts"])
    assert f"Above {DENSE} columns" in section("Prestress")


def test_the_fields_of_a_comparison_are_those_of_the_program():
    compared = cgff_cli.compare(ROOT / "structures" / "prism.yaml", ["lm"], repeat=1).to_dict()
    table = rows("Comparisons")
    method = compared["methods"][0]
    assert [name for row in table for name in code_in(row[0])] == list(method)
    meaning = {row[0].strip("`"): code_in(row[1]) for row in table}
    for curve in ("curve", "shape_curve"):
        assert list(method[curve][0]) == meaning[curve]
    assert set(compared) - {"methods"} <= set(code_in(section("Comparisons").partition("|")[0]))


def test_the_fields_of_equilibria_are_those_of_the_program():
    found = cgff_cli.equilibria(ROOT / "structures" / "prism.yaml", starts=2).to_dict()
    table = rows("Equilibria of a scene")
    assert [name for row in table for name in code_in(row[0])] == list(found)
    meaning = {row[0].strip("`"): code_in(row[1]) for row in table}
    assert list(found["equilibria"][0]) == meaning["equilibria"]
    told = section("Equilibria")
    assert f"by {REACHES[0]} and {REACHES[1]} of the size" in told
    assert f"to {SAME:.0e}".replace("e-0", "e-") in told


def test_the_methods_of_a_comparison_are_those_of_the_program():
    table = rows("Comparison")
    assert {name for row in table for name in code_in(row[1])} == set(REGISTRY)
    flags = {row[0].strip("`"): code_in(row[1]) for row in table if row[0]}
    assert flags == {f"--{flag}": [name] if name != "all" else [] for flag, (name, _) in RIVALS.items()}
    assert f"up to {MOST_DENSE} unknowns" in section("Comparison")
    assert f"take {EVALUATIONS_PER_ITERATION} evaluations for each" in section("Comparison")


def test_the_verdicts_are_those_of_the_program():
    assert [code_in(row[0])[0] for row in rows("Verdicts")] == list(Verdict)


def test_the_size_from_which_matrices_are_sparse_is_that_of_the_program():
    assert f"up to {DENSE_ENTRIES // 1000} 000 entries in rho" in section("Preconditioners")


def test_every_flag_named_exists():
    context = click.Context(main)
    commands = [main, *(main.get_command(context, name) for name in COMMANDS)]
    options = [option for command in commands if command for option in command.params]
    flags = {flag for option in options for flag in (*option.opts, *option.secondary_opts)} | {"--help"}
    own = re.sub(r"`(?:python|hyperfine) [^`]+`", "", WORDS)
    console = [block.text.partition("\n")[0] for block in CONSOLE]
    named = {flag for text in (own, *console) for flag in re.findall(r"(?<![\w-])--[a-z][\w-]*", text)}
    assert {"--tolerance", "--out-dir", "--all"} <= named
    assert not named - flags


def test_every_study_named_exists_and_has_the_flags_it_is_given():
    studies = [code.split() for code in code_in(WORDS) if code.startswith("python tests/")]
    assert len(studies) > 20
    for _, script, *arguments in studies:
        source = (ROOT / script).read_text()
        missing = [word for word in arguments if word.startswith("--") and f'"{word}"' not in source]
        assert not missing, (script, missing)


def test_every_figure_names_its_command():
    commands = [code_in(row[-1]) for row in rows("Measured")]
    assert commands
    for (command,) in commands:
        assert command.startswith(("python tests/studies/", "cgff bench ", "hyperfine -N "))


def test_every_file_named_exists():
    named = r"\b(?:tests|structures|cgff_cli)/[\w./-]+\.(?:py|yaml|json|txt|md|sh)\b"
    missing = [(page.name, path) for page in PAGES for path in re.findall(named, page.text)]
    assert not [(name, path) for name, path in missing if not (ROOT / path).is_file()]


def test_every_link_leads_to_a_page_and_a_heading():
    headings = {page.path: {anchor(heading) for heading in page.headings} for page in PAGES}
    for page in PAGES:
        for path, heading in re.findall(r"\]\(([^)#\s]*)#?([^)\s]*)\)", page.words):
            target = (page.path.parent / path).resolve() if path else page.path
            assert target in headings, (page.name, path)
            assert not heading or heading in headings[target], (page.name, path, heading)


def anchor(heading: str) -> str:
    """Return the name by which links find a heading."""
    return re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def test_the_readme_names_every_other_page():
    linked = [name for row in rows("Where to read on") for name in re.findall(r"\]\(([^)]+)\)", row[0])]
    assert sorted(linked) == sorted(page.name for page in PAGES if page is not README)


def test_table_1_converges_on_none_of_the_structures_that_begin_elsewhere():
    for path in sorted((ROOT / "structures").glob("*.yaml")):
        begun = cgff_cli.solve(path, max_iterations=0)
        if not begun.converged and begun.residual["relative"] > 1e-3:
            assert cgff_cli.solve(path, method="table1").verdict == "step_vanished", path
