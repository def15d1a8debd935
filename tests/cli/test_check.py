"""`cgff check` reads and validates, and solves nothing."""

import json
from pathlib import Path

import pytest

from cgff_cli import pipeline
from tests.cli.conftest import Run


def test_a_good_scene_is_one_line(run: Run):
    ended = run("check", "prism.yaml", "bracket.yaml")
    assert (ended.exit_code, ended.stderr) == (0, "")
    assert ended.stdout.splitlines() == [
        "prism.yaml: ok: 6 nodes, 12 elements in 3 groups, 3-D, no supports, law paper",
        "bracket.yaml: ok: 3 nodes, 2 elements in 2 groups, 2-D, 2 supports, 1 load, law hooke",
    ]


def test_nothing_is_solved(run: Run, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delattr(pipeline, "solve")
    assert run("check", "prism.yaml").exit_code == 0


def test_problems_are_lines_that_editors_understand(run: Run, bad: str):
    ended = run("check", bad, "prism.yaml")
    assert ended.exit_code == 3
    assert [line.split(": ")[0] for line in ended.stderr.splitlines()] == ["bad.yaml:1:1", "bad.yaml:3:1"]
    assert ended.stdout.startswith("prism.yaml: ok: ")


def test_json_of_one_scene(run: Run):
    record = json.loads(run("check", "prism.yaml", "--format", "json").stdout)
    assert (record["path"], record["ok"], record["problems"]) == ("prism.yaml", True, [])
    assert (record["nodes"], record["elements"], record["groups"]) == (6, 12, 3)


def test_json_of_many_scenes_is_one_object_per_line(run: Run, bad: str):
    ended = run("check", bad, "prism.yaml", "--format", "json")
    records = [json.loads(line) for line in ended.stdout.splitlines()]
    assert ended.exit_code == 3
    assert [record["ok"] for record in records] == [False, True]
    assert [(p["path"], p["line"], p["column"]) for p in records[0]["problems"]] == [
        ("bad.yaml", 1, 1),
        ("bad.yaml", 3, 1),
    ]
    assert records[0]["problems"][1]["message"].startswith("unknown key 'colour'")


def test_a_file_that_is_not_there_has_no_line(run: Run):
    ended = run("check", "nowhere.yaml", "--format", "json")
    assert ended.exit_code == 3
    assert ended.stderr == "nowhere.yaml: cannot read the scene: no such file\n"
    message = "cannot read the scene: no such file"
    problem = {"path": "nowhere.yaml", "line": None, "column": None, "message": message}
    assert json.loads(ended.stdout)["problems"] == [problem]


def test_standard_input_is_named_in_words(run: Run):
    assert run("check", "-", stdin=Path("prism.yaml").read_text()).stdout.startswith("<stdin>: ok: ")


def test_warnings_are_told_unless_quiet(run: Run):
    scene = Path("prism.yaml").read_text()
    Path("double.yaml").write_text(scene.replace("[n1, n2]", "[n1, n2], [n1, n2]"))
    ended = run("check", "double.yaml", "--format", "json")
    assert json.loads(ended.stdout)["warnings"]
    assert ended.stderr.startswith("cgff: double.yaml: warning: ")
    assert run("check", "double.yaml", "-q").stderr == ""
