"""Exit codes, and the words that go with them on standard error."""

import json
from itertools import pairwise
from pathlib import Path

import pytest

from cgff_cli import pipeline
from cgff_cli.analysis import equilibrium
from cgff_cli.cli.common import ExitCode, worst
from cgff_cli.report import progress
from tests.cli.conftest import Run


def test_converged_is_0_and_silent(run: Run):
    ended = run("solve", "prism.yaml", "-o", "out.json")
    assert (ended.exit_code, ended.stdout, ended.stderr) == (0, "", "")


def test_not_converged_is_4_and_still_writes(run: Run):
    ended = run("solve", "prism.yaml", "--max-iterations", "2")
    result = json.loads(ended.stdout)
    assert ended.exit_code == 4
    assert (result["verdict"], result["converged"]) == ("max_iterations", False)
    assert ended.stderr == f"cgff: prism.yaml: max_iterations: {result['message']}\n"


def test_not_converged_is_told_even_when_quiet(run: Run):
    ended = run("solve", "prism.yaml", "--max-iterations", "2", "-q")
    assert "prism.yaml: max_iterations:" in ended.stderr


def test_a_bad_scene_is_3_with_every_problem_on_a_line(run: Run, bad: str):
    ended = run("solve", bad)
    assert ended.exit_code == 3
    assert ended.stdout == ""
    lines = ended.stderr.splitlines()
    assert len(lines) == 2
    assert lines[0].startswith("bad.yaml:1:1: missing key 'elements'")
    assert lines[1].startswith("bad.yaml:3:1: unknown key 'colour'")


def test_a_missing_file_is_a_bad_scene(run: Run):
    ended = run("solve", "nowhere.yaml")
    assert ended.exit_code == 3
    assert ended.stderr.startswith("nowhere.yaml: cannot read the scene: ")


def test_a_bad_scene_stops_only_itself(run: Run, bad: str):
    ended = run("solve", bad, "prism.yaml", "--out-dir", "out")
    assert ended.exit_code == 3
    assert [path.name for path in Path("out").glob("[!.]*")] == ["prism.json"]


def test_a_bad_scene_outweighs_one_that_did_not_converge(run: Run, bad: str):
    assert run("solve", "prism.yaml", bad, "--max-iterations", "2", "--out-dir", "out").exit_code == 3
    assert run("solve", bad, "prism.yaml", "--max-iterations", "2", "--out-dir", "out").exit_code == 3


def test_the_worst_exit_code_wins():
    names = ("OK", "UNMET", "NOT_CONVERGED", "SCENE", "ERROR", "INTERRUPTED")
    ranked = [ExitCode[name] for name in names]
    for milder, graver in pairwise(ranked):
        assert worst(milder, graver) is worst(graver, milder) is graver


@pytest.mark.parametrize(
    ("flag", "value", "words"),
    [
        ("--tolerance", "2", "tolerance must be a number between 0 and 1"),
        ("--tolerance", "nan", "tolerance must be a number between 0 and 1"),
        ("--tolerance", "tight", "got 'tight'"),
        ("--max-iterations", "2.5", "max_iterations must be a whole number"),
        ("--seed", "-1", "seed must be a whole number"),
        ("--method", "cgf", "'cgff'"),
        ("--cg-beta", "fr", "'FR'"),
        ("--colour", "red", "--colour"),
    ],
)
def test_a_bad_option_is_2_and_says_what_is_allowed(run: Run, flag: str, value: str, words: str):
    ended = run("solve", "prism.yaml", flag, value)
    assert ended.exit_code == 2
    assert words in ended.stderr


def test_a_flag_wins_over_the_file_and_the_file_over_the_default(run: Run):
    with Path("prism.yaml").open("a") as scene:
        scene.write("solver: {tolerance: 1e-6, seed: 7}\n")
    options = json.loads(run("solve", "prism.yaml", "--seed", "9").stdout)["options"]
    assert (options["tolerance"], options["seed"], options["max_iterations"]) == (1e-6, 9, 2000)


def test_an_unknown_command_is_2_and_names_the_nearest(run: Run):
    assert "did you mean 'solve'?" in run("slove", "prism.yaml").stderr
    assert "did you mean 'cgff solve prism.yaml'?" in run("prism.yaml").stderr
    assert run("prism.yaml").exit_code == 2


def test_an_unexpected_error_is_one_line(run: Run, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(pipeline, "solve", _broken)
    ended = run("solve", "prism.yaml")
    assert ended.exit_code == 1
    assert ended.stderr == "cgff: unexpected error: ZeroDivisionError: by zero; run again with --traceback\n"


@pytest.mark.parametrize("order", [("--traceback", "solve"), ("solve", "--traceback")])
def test_a_traceback_is_shown_on_request(run: Run, monkeypatch: pytest.MonkeyPatch, order: tuple[str, str]):
    monkeypatch.setattr(pipeline, "solve", _broken)
    ended = run(*order, "prism.yaml")
    assert ended.exit_code == 1
    assert "Traceback" in ended.stderr
    assert "in _broken" in ended.stderr


def test_an_unexpected_error_stops_only_its_scene(run: Run, monkeypatch: pytest.MonkeyPatch):
    solve = pipeline.solve
    monkeypatch.setattr(
        pipeline, "solve", lambda scene, **_: _broken() if scene.path == "prism.yaml" else solve(scene)
    )
    ended = run("solve", "prism.yaml", "bracket.yaml")
    assert ended.exit_code == 1
    assert json.loads(ended.stdout)["scene"]["path"] == "bracket.yaml"


def test_an_interrupt_outside_the_solver_is_130(run: Run, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(pipeline, "solve", _interrupted)
    ended = run("solve", "prism.yaml", "bracket.yaml")
    assert (ended.exit_code, ended.stdout, ended.stderr) == (130, "", "cgff: interrupted\n")


def test_an_interrupted_analysis_is_130_and_leaves_the_solution(run: Run, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(equilibrium, "Ranks", _interrupted)
    ended = run("solve", "prism.yaml", "bracket.yaml", "--out-dir", "out", "-q")
    assert ended.exit_code == 130
    assert [path.name for path in Path("out").glob("[!.]*")] == ["prism.json"]
    result = json.loads(Path("out/prism.json").read_text())
    assert (result["verdict"], result["analysis"]["stable"]) == ("converged", None)
    assert result["analysis"]["slack_count"] == 0
    assert result["analysis"]["reason"]["stable"] == "not computed: the analysis was interrupted"
    assert result["message"].endswith("; its analysis was interrupted")
    assert ended.stderr == f"cgff: prism.yaml: converged: {result['message']}\n"


def test_an_unstable_equilibrium_is_told_unless_quiet(run: Run, unstable: str):
    arguments = ("solve", unstable, "--objective", "residual", "--tolerance", "1e-8")
    ended = run(*arguments)
    result = json.loads(ended.stdout)
    assert (ended.exit_code, result["verdict"], result["analysis"]["stable"]) == (0, "converged", False)
    (said,) = result["warnings"]
    assert said.startswith("unstable: ")
    assert ended.stderr == f"cgff: unstable.yaml: warning: {said}\n"
    assert run(*arguments, "-q").stderr == ""


def test_warnings_are_told_unless_quiet(run: Run):
    scene = Path("prism.yaml").read_text()
    Path("double.yaml").write_text(scene.replace("[n1, n2]", "[n1, n2], [n1, n2]"))
    assert "cgff: double.yaml: warning: " in run("solve", "double.yaml", "-o", "out.json").stderr
    assert "warning" not in run("solve", "double.yaml", "-o", "out.json", "-q").stderr


def test_progress_is_for_terminals_only(run: Run, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delattr(progress, "Progress")
    assert run("solve", "prism.yaml").exit_code == 0


@pytest.mark.parametrize("arguments", [("-v", "solve"), ("solve", "-v"), ("-v", "solve", "-v")])
def test_verbose_tells_how_every_run_ended(run: Run, arguments: tuple[str, ...]):
    ended = run(*arguments, "prism.yaml", "-o", "out.json")
    assert ended.stderr.startswith("cgff: prism.yaml: converged: ")


def _broken(*_: object, **__: object) -> None:
    raise ZeroDivisionError("by zero")


def _interrupted(*_: object, **__: object) -> None:
    raise KeyboardInterrupt


def test_an_interrupt_leaves_the_summary_of_what_was_done(run: Run, monkeypatch: pytest.MonkeyPatch):
    solve = pipeline.solve
    monkeypatch.setattr(
        pipeline, "solve", lambda scene, **_: _interrupted() if scene.path == "bracket.yaml" else solve(scene)
    )
    assert run("solve", "prism.yaml", "bracket.yaml", "--summary", "s.csv").exit_code == 130
    assert Path("s.csv").read_text().splitlines()[1].startswith("prism.yaml,,converged,")
