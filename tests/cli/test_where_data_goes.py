"""Data on standard output or in files, words on standard error: the rules of the output flags."""

import csv
import json
import re
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from cgff_cli.cli import COMMANDS, main
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


ON_ONE_SCENE = {
    "solve": (),
    "compare": ("--fdm", "--repeat", "1"),
    "bench": ("--fdm", "--repeat", "1"),
    "analyse": (),
    "equilibria": ("--starts", "4"),
}
"""Command whose data a file named .json can hold -> flags that make it quick."""


@pytest.mark.parametrize("name", ON_ONE_SCENE)
def test_a_page_can_be_shown_beside_a_file_of_the_data(run: Run, name: str):
    plain = run(name, "prism.yaml", *ON_ONE_SCENE[name], "--format", "table")
    both = run(name, "prism.yaml", *ON_ONE_SCENE[name], "--format", "table", "-o", "out.json")
    assert both.exit_code == plain.exit_code
    assert _without_times(both.stdout) == _without_times(plain.stdout) != ""
    assert json.loads(Path("out.json").read_text())["schema"].startswith("cgff-")


def _without_times(page: str) -> str:
    """Return a page without durations and the blanks that line up with them."""
    return " ".join(re.sub(r"[\d.]+ m?s\b", "TIME", page).split())


def test_a_command_that_can_show_a_page_beside_a_file_is_tried_above(run: Run):
    pages = set()
    for name in COMMANDS:
        told = {own.opts[0]: own for own in main.get_command(None, name).params}  # type: ignore
        if "-o" in told and "table" in getattr(getattr(told.get("--format"), "type", None), "choices", ()):
            pages.add(name)
    assert pages == {*ON_ONE_SCENE, "prestress"}  # that one writes a scene, beside whatever page


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
    assert sorted(path.name for path in Path("deep/results").glob("[!.]*")) == ["bracket.json", "prism.json"]
    assert json.loads(Path("deep/results/prism.json").read_text())["scene"]["path"] == "prism.yaml"


def test_a_folder_of_coordinates(run: Run):
    run("solve", "prism.yaml", "bracket.yaml", "--out-dir", "out", "--format", "csv")
    assert sorted(path.name for path in Path("out").glob("[!.]*")) == ["bracket.csv", "prism.csv"]


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
        (("prism.yaml", "--history", "h.txt"), "--history h.txt: the name must end in .json"),
        (("prism.yaml", "--summary", "s.json"), "the name must end in .csv or .jsonl"),
        (("prism.yaml", "-o", "x.csv", "--summary", "x.csv"), "written over the result of prism.yaml"),
        (("--files-from", "nowhere"), "--files-from nowhere: cannot be read: No such file"),
        (("prism.yaml", "prism.yaml", "--out-dir", "d"), "a scene is given twice"),
        (("-", "-"), "standard input (-) can be read only once"),
        ((), "'SCENE"),
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


@pytest.mark.parametrize(
    "arguments",
    [
        ("solve", "prism.yaml", "-o", "no/x.json"),
        ("solve", "prism.yaml", "--summary", "no/x.csv"),
        ("solve", "prism.yaml", "--out-dir", "prism.yaml"),
        ("compare", "prism.yaml", "-o", "no/x.json"),
        ("bench", "prism.yaml", "-o", "no/x.json"),
        ("new", "prism", "-o", "no/x.yaml"),
        ("new", "prism", "--tables", "-o", "no/x.yaml"),
    ],
)
def test_what_the_system_refuses_to_write_is_1_before_any_work(run: Run, arguments: tuple[str, ...]):
    before = sorted(Path().iterdir())
    ended = run(*arguments)
    assert (ended.exit_code, ended.stdout) == (1, "")
    assert "cannot be" in ended.stderr
    assert sorted(Path().iterdir()) == before


TABLED = ("net.yaml", "net.nodes.csv", "net.elements.csv")
"""A scene with its tables."""


@pytest.fixture
def tabled(run: Run) -> dict[str, bytes]:
    """Write a scene with tables and return its files."""
    assert run("new", "net", "--side", "4", "--tables", "-o", "net.yaml").exit_code == 0
    return {name: Path(name).read_bytes() for name in TABLED}


@pytest.mark.parametrize(
    "arguments",
    [
        ("solve", "net.yaml", "-o", "net.nodes.csv"),
        ("solve", "net.yaml", "--elements", "net.elements.csv"),
        ("solve", "net.yaml", "--history", "./net.nodes.csv"),
        ("solve", "net.yaml", "--summary", "net.nodes.csv"),
        ("solve", "net.yaml", "-o", "hard.json"),
        ("solve", "net.yaml", "-o", "soft.csv"),
        ("solve", "prism.yaml", "net.yaml", "--summary", "soft.csv"),
        ("solve", "net.nodes.yaml", "net.yaml", "--format", "csv", "--out-dir", "."),
        ("compare", "net.yaml", "--fdm", "-o", "net.nodes.csv"),
        pytest.param(
            ("compare", "net.yaml", "--fdm", "--plot", "soft.png"), marks=pytest.mark.needs_matplotlib
        ),
        ("bench", "net.yaml", "--fdm", "-o", "net.nodes.csv"),
        ("bench", "net.yaml", "--fdm", "-o", "hard.json"),
    ],
)
def test_no_output_replaces_a_file_that_a_scene_is_read_from(
    run: Run, tabled: dict[str, bytes], arguments: tuple[str, ...]
):
    Path("hard.json").hardlink_to("net.yaml")
    Path("soft.csv").symlink_to("net.nodes.csv")
    Path("soft.png").symlink_to("net.elements.csv")
    Path("net.nodes.yaml").write_bytes(Path("prism.yaml").read_bytes())
    ended = run(*arguments)
    assert (ended.exit_code, ended.stdout) == (2, "")
    assert "would be written over" in ended.stderr
    assert {name: Path(name).read_bytes() for name in TABLED} == tabled


def test_the_tables_of_standard_input_are_not_replaced_either(run: Run, tabled: dict[str, bytes]):
    ended = run("solve", "-", "-o", "net.nodes.csv", stdin=Path("net.yaml").read_text())
    assert ended.exit_code == 2
    assert "net.nodes.csv would be written over a file of <stdin>" in ended.stderr
    assert Path("net.nodes.csv").read_bytes() == tabled["net.nodes.csv"]


def test_json_lines_are_asked_for_by_name(run: Run):
    for scenes in (["prism.yaml"], ["prism.yaml", "bracket.yaml"]):
        lines = run("solve", *scenes, "--format", "jsonl").stdout.splitlines()
        assert [json.loads(line)["scene"]["path"] for line in lines] == scenes
    assert json.loads(run("check", "prism.yaml", "--format", "jsonl").stdout.rstrip("\n"))["ok"] is True
    assert run("check", "prism.yaml", "--format", "jsonl").stdout.count("\n") == 1


def test_json_lines_stand_beside_a_folder(run: Run):
    ended = run("solve", "prism.yaml", "--format", "jsonl", "--out-dir", "out")
    assert json.loads(ended.stdout) == json.loads(Path("out/prism.json").read_text())


SUMMARY = (
    "scene,case,verdict,stability,iterations,residual_relative,energy,max_strain,slack_count,"
    "smallest_stiffness,seconds"
)


def test_a_summary_is_a_row_per_scene_a_bad_one_too(run: Run, bad: str):
    ended = run("solve", "prism.yaml", bad, "bracket.yaml", "--summary", "s.csv")
    assert ended.exit_code == 3
    assert Path("s.csv").read_text().splitlines()[0] == SUMMARY
    prism, broken, bracket = csv.DictReader(Path("s.csv").read_text().splitlines())
    assert (prism["scene"], prism["case"], prism["verdict"]) == ("prism.yaml", "", "converged")
    assert (broken["scene"], broken["verdict"], broken["energy"]) == ("bad.yaml", "bad_scene", "")
    result = json.loads(ended.stdout.splitlines()[1])
    assert float(bracket["energy"]) == result["energy"]
    strains = [abs(row["length"] / row["rest_length"] - 1) for row in result["elements"] if not row["slack"]]
    assert float(bracket["max_strain"]) == pytest.approx(max(strains), rel=1e-9)


def test_a_summary_may_be_json_lines(run: Run, bad: str):
    run("solve", "prism.yaml", bad, "--summary", "s.jsonl")
    rows = [json.loads(line) for line in Path("s.jsonl").read_text().splitlines()]
    assert [list(row) for row in rows] == [SUMMARY.split(",")] * 2
    assert [row["slack_count"] for row in rows] == [0, None]


@pytest.mark.parametrize("command", ["solve", "check"])
def test_scenes_can_be_listed_in_a_file(run: Run, command: str):
    Path("list").write_text("\nprism.yaml\n  \nbracket.yaml\n")
    direct = run(command, "prism.yaml", "bracket.yaml", "--format", "json").stdout.splitlines()
    for ended in (
        run(command, "--files-from", "list", "--format", "json"),
        run(command, "--format", "json", "--files-from", "-", stdin="prism.yaml\r\nbracket.yaml"),
        run(command, "prism.yaml", "--format", "json", "--files-from", "-", stdin="bracket.yaml\n"),
    ):
        assert ended.exit_code == 0, ended.stderr
        assert len(ended.stdout.splitlines()) == len(direct) == 2


def test_a_list_without_a_scene_is_wrong_usage(run: Run):
    assert run("solve", "--files-from", "-", stdin="\n").exit_code == 2


def test_a_list_of_scenes_is_not_replaced_either(run: Run):
    Path("list.csv").write_text("prism.yaml\n")
    ended = run("solve", "--files-from", "list.csv", "--summary", "list.csv")
    assert ended.exit_code == 2
    assert "list.csv would be written over the list of scenes" in ended.stderr
    assert Path("list.csv").read_text() == "prism.yaml\n"


@pytest.mark.parametrize("arguments", [("solve", "-", "--files-from", "-"), ("check", "-", "-")])
def test_standard_input_is_read_once_only(run: Run, arguments: tuple[str, ...]):
    ended = run(*arguments, stdin="prism.yaml\n")
    assert (ended.exit_code, ended.stdout) == (2, "")
    assert "can be read only once" in ended.stderr


def test_a_folder_in_memory_is_a_folder_like_any_other(run: Run):
    with TemporaryDirectory(dir="/dev/shm") as folder:
        scene, twin = Path(folder, "prism.yaml"), Path(folder, "prism.json")
        scene.write_bytes(Path("prism.yaml").read_bytes())
        twin.hardlink_to(scene)
        assert run("solve", str(scene), "-o", str(twin)).exit_code == 2
        assert scene.read_bytes() == Path("prism.yaml").read_bytes()
