"""`cgff solve` on many scenes: the same on any number of processes, and going on where a run stopped."""

import json
import re
from pathlib import Path

import pytest

from cgff_cli import pipeline
from cgff_cli.cli.solving import JOURNAL
from tests.cli.conftest import Run

MANY = ("prism.yaml", "bracket.yaml", "flat.yaml", "bad.yaml", "prism2.yaml")
RESUMED = (*MANY, "--out-dir", "out", "--resume", "--summary", "s.csv")


@pytest.fixture(autouse=True)
def scenes(run: Run, bad: str) -> None:
    prism = Path("prism.yaml").read_text()
    Path("prism2.yaml").write_text(prism.replace("1.8", "1.7"))
    Path("flat.yaml").write_text(f"{prism}solver: {{max_iterations: 2}}\n")


def without_times(text: str) -> str:
    return re.sub(r'"seconds": [^}]+|,[^,\n]+$', "", text, flags=re.MULTILINE)


def everything(run: Run, folder: str, *flags: str) -> list[object]:
    """Return all that a run tells, in whatever way, but for times."""
    summary = f"{folder}.csv"
    ended = run("solve", *MANY, "--out-dir", folder, "--summary", summary, "--format", "jsonl", *flags)
    files = {path.name: without_times(path.read_text()) for path in Path(folder).glob("[!.]*")}
    told = without_times(ended.stdout), without_times(Path(summary).read_text())
    return [ended.exit_code, ended.stderr, files, *told]


def test_nothing_depends_on_the_number_of_processes(run: Run):
    alone = everything(run, "one")
    assert alone[0] == 3
    assert len(alone[2]) == 4
    assert everything(run, "two", "--jobs", "2") == alone


def test_more_processes_than_scenes_are_as_many_as_there_are(run: Run):
    assert run("solve", "prism.yaml", "--jobs", "8").stdout.startswith("{\n")


def test_requirements_are_judged_by_other_processes_too(run: Run):
    ended = run("solve", "prism.yaml", "bracket.yaml", "--jobs", "2", "--require", "super-stable", "-q")
    assert ended.exit_code == 5
    assert ended.stderr.startswith("cgff: bracket.yaml: super-stable is required, but it is stable by")


def test_results_are_left_alone_where_nothing_changed(run: Run, solved: list[str]):
    before = run("solve", *RESUMED)
    rows = Path("s.csv").read_text()
    assert (before.exit_code, solved) == (3, ["prism.yaml", "bracket.yaml", "flat.yaml", "prism2.yaml"])
    times = {path: path.stat().st_mtime_ns for path in Path("out").iterdir()}
    solved.clear()
    again = run("solve", *RESUMED)
    assert solved == []
    assert (again.exit_code, again.stderr) == (before.exit_code, before.stderr)
    assert "cgff: flat.yaml: max_iterations: " in again.stderr
    assert Path("s.csv").read_text() == rows
    assert {path: path.stat().st_mtime_ns for path in Path("out").iterdir()} == times


def test_lines_of_scenes_left_alone_are_those_of_their_files(run: Run):
    before = run("solve", "prism.yaml", "bracket.yaml", "--out-dir", "out", "--resume", "--format", "jsonl")
    again = run("solve", "prism.yaml", "bracket.yaml", "--out-dir", "out", "--resume", "--format", "jsonl")
    assert again.stdout == before.stdout


@pytest.mark.parametrize(
    ("flags", "anew"),
    [
        ((), ["prism.yaml"]),
        (("--tolerance", "1e-9"), ["prism.yaml", "bracket.yaml", "flat.yaml", "prism2.yaml"]),
        (("--require", "stable"), ["prism.yaml", "bracket.yaml", "flat.yaml", "prism2.yaml"]),
        (("--format", "csv"), ["prism.yaml", "bracket.yaml", "flat.yaml", "prism2.yaml"]),
    ],
)
def test_what_changed_or_is_asked_for_otherwise_is_solved_again(
    run: Run, solved: list[str], flags: tuple[str, ...], anew: list[str]
):
    run("solve", *RESUMED)
    Path("prism.yaml").write_text(Path("prism.yaml").read_text().replace("7.007", "7.008"))
    solved.clear()
    run("solve", *RESUMED, *flags)
    assert solved == anew


def test_a_table_that_changed_or_a_result_that_is_gone_counts(run: Run, solved: list[str]):
    run("new", "net", "--side", "3", "--tables", "-o", "net.yaml")
    arguments = ("net.yaml", "prism.yaml", "--out-dir", "out", "--resume")
    run("solve", *arguments)
    Path("out/prism.json").unlink()
    nodes = Path("net.nodes.csv")
    nodes.write_text(nodes.read_text().replace("\n", " \n", 1))
    solved.clear()
    run("solve", *arguments)
    assert solved == ["net.yaml", "prism.yaml"]


def test_an_interrupted_run_goes_on_where_it_stopped(
    run: Run, solved: list[str], monkeypatch: pytest.MonkeyPatch
):
    counted = pipeline.solve

    def stopped(scene, **options):
        if scene.path == "flat.yaml":
            raise KeyboardInterrupt
        return counted(scene, **options)

    monkeypatch.setattr(pipeline, "solve", stopped)
    assert run("solve", *RESUMED).exit_code == 130
    assert sorted(path.name for path in Path("out").iterdir()) == [JOURNAL, "bracket.json", "prism.json"]
    monkeypatch.setattr(pipeline, "solve", counted)
    solved.clear()
    assert run("solve", *RESUMED).exit_code == 3
    assert solved == ["flat.yaml", "prism2.yaml"]
    verdicts = [line.split(",")[:3] for line in Path("s.csv").read_text().splitlines()[1:]]
    assert [(scene, verdict) for scene, _, verdict in verdicts][2:4] == [
        ("flat.yaml", "max_iterations"),
        ("bad.yaml", "bad_scene"),
    ]


def test_a_last_line_that_was_cut_off_costs_its_own_scene_alone(run: Run, solved: list[str]):
    run("solve", *RESUMED)
    journal = Path("out", JOURNAL)
    journal.write_text(journal.read_text()[:-20])
    solved.clear()
    run("solve", *RESUMED)
    assert solved == ["prism2.yaml"]
    assert json.loads(Path("out/prism2.json").read_text())["converged"] is True


def test_a_table_of_no_possible_name_is_a_mistake_of_its_scene_alone(run: Run):
    Path("null.yaml").write_text('law: paper\nnodes: "a\\0.csv"\nelements: {}\n')
    for flags in ([], ["--resume"], ["--jobs", "2"]):
        ended = run("solve", "null.yaml", "prism.yaml", "--out-dir", "out", *flags)
        assert ended.exit_code == 3
        assert ended.stderr.startswith("null.yaml:2:8: nodes: cannot read")
        assert "error" not in ended.stderr


@pytest.mark.parametrize("arguments", [("prism.yaml", "--resume"), ("-", "--out-dir", "d", "--resume")])
def test_only_a_folder_of_results_of_files_can_be_gone_on_with(run: Run, arguments: tuple[str, ...]):
    ended = run("solve", *arguments, stdin="")
    assert (ended.exit_code, ended.stdout) == (2, "")
    assert "--resume needs --out-dir DIR" in ended.stderr
