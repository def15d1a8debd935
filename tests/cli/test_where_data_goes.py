"""Data on standard output or in files, words on standard error: the rules of the output flags."""

import csv
import json
from pathlib import Path

import pytest

from tests.cli.conftest import Run


def test_a_pipe_gets_json_and_nothing_else(run: Run):
    ended = run("solve", "prism.yaml")
    assert json.loads(ended.stdout)["verdict"] == "converged"
    assert ended.stderr == ""


def test_the_format_can_be_chosen(run: Run):
    assert run("solve", "prism.yaml", "--format", "csv").stdout.startswith("name,x,y,z\n")
    assert "super-stable" in run("solve", "prism.yaml", "--format", "table").stdout


def test_standard_input_is_a_scene_too(run: Run):
    ended = run("solve", "-", stdin=Path("prism.yaml").read_text())
    assert json.loads(ended.stdout)["scene"]["path"] == "<stdin>"


def test_a_result_file_takes_its_format_from_its_suffix(run: Run):
    assert run("solve", "prism.yaml", "-o", "out.json").stdout == ""
    assert run("solve", "prism.yaml", "-o", "out.csv").stdout == ""
    nodes = json.loads(Path("out.json").read_text())["nodes"]
    rows = list(csv.reader(Path("out.csv").read_text().splitlines()))
    assert {name: [float(x) for x in position] for name, *position in rows[1:]} == nodes


def test_a_dash_is_standard_output(run: Run):
    assert json.loads(run("solve", "prism.yaml", "-o", "-").stdout)["converged"] is True
    assert run("solve", "prism.yaml", "-o", "-", "--format", "csv").stdout.startswith("name,")


def test_a_table_can_be_shown_beside_a_file(run: Run):
    ended = run("solve", "prism.yaml", "-o", "out.json", "--format", "table")
    assert "Triangular prism" in ended.stdout
    assert json.loads(Path("out.json").read_text())["converged"] is True


@pytest.mark.parametrize("name", ["out.txt", "out", "out.yaml"])
def test_another_suffix_is_refused_with_those_allowed(run: Run, name: str):
    ended = run("solve", "prism.yaml", "-o", name)
    assert ended.exit_code == 2
    assert f"-o {name}: the name must end in .json (everything) or .csv (the coordinates)" in ended.stderr
    assert not Path(name).exists()


def test_history_and_elements_have_files_of_their_own(run: Run):
    ended = run("solve", "prism.yaml", "--history", "h.csv", "--elements", "e.json")
    result = json.loads(ended.stdout)
    history = list(csv.DictReader(Path("h.csv").read_text().splitlines()))
    assert [float(row["objective"]) for row in history] == result["history"]["objective"]
    assert json.loads(Path("e.json").read_text()) == result["elements"]


def test_history_and_elements_also_the_other_way_round(run: Run):
    ended = run("solve", "prism.yaml", "--history", "h.json", "--elements", "e.csv")
    result = json.loads(ended.stdout)
    elements = list(csv.DictReader(Path("e.csv").read_text().splitlines()))
    assert json.loads(Path("h.json").read_text()) == result["history"]
    assert [float(row["force"]) for row in elements] == [element["force"] for element in result["elements"]]


def test_many_scenes_go_to_a_folder_made_for_them(run: Run):
    ended = run("solve", "prism.yaml", "bracket.yaml", "--out-dir", "deep/results")
    assert (ended.exit_code, ended.stdout) == (0, "")
    assert sorted(path.name for path in Path("deep/results").iterdir()) == ["bracket.json", "prism.json"]
    assert json.loads(Path("deep/results/prism.json").read_text())["scene"]["path"] == "prism.yaml"


def test_a_folder_of_coordinates(run: Run):
    run("solve", "prism.yaml", "bracket.yaml", "--out-dir", "out", "--format", "csv")
    assert sorted(path.name for path in Path("out").iterdir()) == ["bracket.csv", "prism.csv"]


def test_a_folder_and_a_table_of_what_is_in_it(run: Run):
    ended = run("solve", "prism.yaml", "bracket.yaml", "--out-dir", "out", "--format", "table")
    assert [line.split()[0] for line in ended.stdout.splitlines()] == ["scene", "prism.yaml", "bracket.yaml"]


def test_many_scenes_are_lines_of_json(run: Run):
    lines = run("solve", "prism.yaml", "bracket.yaml").stdout.splitlines()
    assert [json.loads(line)["scene"]["path"] for line in lines] == ["prism.yaml", "bracket.yaml"]


def test_many_scenes_are_rows_of_one_table(run: Run, bad: str):
    ended = run("solve", "prism.yaml", bad, "bracket.yaml", "--format", "table")
    words = [line.split() for line in ended.stdout.splitlines()]
    assert [row[0] for row in words] == ["scene", "prism.yaml", "bad.yaml", "bracket.yaml"]
    assert [row[1] for row in words[1:]] == ["converged", "bad", "converged"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("prism.yaml", "bracket.yaml", "-o", "x.json"), "-o takes one scene; use --out-dir"),
        (("prism.yaml", "bracket.yaml", "--history", "x.csv"), "--history takes one scene"),
        (("prism.yaml", "bracket.yaml", "--elements", "x.csv"), "--elements takes one scene"),
        (("prism.yaml", "bracket.yaml", "--format", "csv"), "--format csv takes one scene"),
        (("prism.yaml", "-o", "x.json", "--out-dir", "d"), "-o or --out-dir, not both"),
        (("prism.yaml", "-o", "x.json", "--format", "csv"), "--format csv and -o x.json disagree"),
        (("prism.yaml", "-o", "x.csv", "--history", "x.csv"), "written over the result of prism.yaml"),
        (("prism.yaml", "-o", "no/such/x.json"), "there is no folder"),
        (("prism.yaml", "--history", "h.txt"), "--history h.txt: the name must end in .json"),
        (("prism.yaml", "--out-dir", "prism.yaml"), "cannot be made a folder"),
        (("prism.yaml", "prism.yaml", "--out-dir", "d"), "a scene is given twice"),
        (("-", "-"), "standard input (-) can be read only once"),
        ((), "Missing argument"),
    ],
)
def test_what_cannot_be_meant_is_refused_before_any_work(run: Run, arguments: tuple[str, ...], words: str):
    before = sorted(Path().iterdir())
    ended = run("solve", *arguments)
    assert ended.exit_code == 2
    assert words in ended.stderr
    assert ended.stdout == ""
    assert sorted(Path().iterdir()) == before


def test_two_scenes_of_one_stem_cannot_share_a_folder(run: Run):
    Path("prism.json").write_text("{}")
    ended = run("solve", "prism.yaml", "prism.json", "--out-dir", "out")
    assert ended.exit_code == 2
    assert "out/prism.json would be written over the result of prism.yaml" in ended.stderr
    assert not Path("out").exists()


def test_a_result_never_replaces_a_scene(run: Run):
    Path("prism.json").write_text("{}")
    ended = run("solve", "prism.json", "--out-dir", ".")
    assert ended.exit_code == 2
    assert "prism.json would be written over the scene prism.json" in ended.stderr
    assert Path("prism.json").read_text() == "{}"
