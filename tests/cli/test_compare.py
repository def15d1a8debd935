"""`cgff compare`: tables, JSON, CSV, pictures, and the paper's structures without a scene."""

import csv
import io
import json
import sys
from pathlib import Path

import pytest

from cgff_cli.report import plots
from cgff_cli.rivals.registry import REGISTRY
from cgff_cli.scene.scene import Scene
from cgff_cli.study import compare
from tests.cli.conftest import STRUCTURES, Run

ONCE = ("--repeat", "1")


def test_without_a_scene_it_takes_the_papers_structures(run: Run):
    ended = run("compare", "--fdm", *ONCE)
    records = [json.loads(line) for line in ended.stdout.splitlines()]
    assert (ended.exit_code, ended.stderr) == (0, "")
    assert [record["scene"]["name"].split(", ")[1] for record in records] == [
        "Table II",
        "Table III",
        "Table IV",
    ]
    for record in records:
        assert [method["name"] for method in record["methods"]] == ["cgff", "fdm"]
        assert record["methods"][0]["converged"] is True


def test_one_scene_is_one_object_of_several_lines(run: Run):
    text = run("compare", "prism.yaml", "--fdm", "--fsolve", "--lm", *ONCE).stdout
    assert text.startswith('{\n  "schema": "cgff-compare/1",\n')
    record = json.loads(text)
    assert [method["name"] for method in record["methods"]] == ["cgff", "fdm", "fsolve", "lm"]
    assert record["scene"]["path"] == "prism.yaml"


def test_every_method_has_a_flag_and_all_means_those_that_suit(run: Run):
    flags = [f"--{name.removeprefix('cgff-')}" for name in REGISTRY if name != "cgff"]
    by_flags = json.loads(run("compare", "prism.yaml", *flags, *ONCE).stdout)
    assert {method["name"] for method in by_flags["methods"]} == set(REGISTRY)
    by_all = json.loads(run("compare", "bracket.yaml", "--all", *ONCE).stdout)
    assert {method["name"] for method in by_all["methods"]} == set(REGISTRY) - {"fdm", "afdm", "dsvd"}


def test_with_supports_fdm_means_schek(run: Run):
    record = json.loads(run("compare", str(STRUCTURES / "cable-net.yaml"), "--fdm", *ONCE).stdout)
    assert [method["name"] for method in record["methods"]] == ["cgff", "schek"]


def test_a_rival_that_fails_is_a_row_and_no_error(run: Run):
    ended = run("compare", "prism.yaml", "--schek", *ONCE, "--format", "table")
    assert ended.exit_code == 0
    assert "schek   failed" in ended.stdout
    assert "no supports: the force density method needs held nodes" in ended.stdout


def test_the_table_says_what_was_found_how_it_was_aligned_and_how_fast(run: Run):
    page = run("compare", "prism.yaml", "--fdm", "--lm", *ONCE, "--format", "table").stdout
    assert page.startswith("Triangular prism, Table IV  6 nodes, 12 elements, prism.yaml\n")
    assert "nearest affine map" in page
    assert "nearest rigid motion, mirror image allowed" in page
    lines = page.splitlines()
    for axis in "xyz":
        first = next(i for i, line in enumerate(lines) if line.split() == [axis, "cgff", "fdm", "lm"])
        node, *values = lines[first + 1].split()
        assert node == "n1"
        assert len(set(values)) == 1
    assert any(line.split() == ["triangles", "0.577350", "0.577350"] for line in lines)
    assert [line.split()[0] for line in lines if line.startswith("  1e-")] == [
        f"1e-{k:02}" for k in range(2, 13)
    ] * 2


def test_verbose_lists_every_element(run: Run):
    page = run("compare", "prism.yaml", "--lm", *ONCE, "--format", "table", "-v").stdout
    assert page.count("  triangles  ") == 12
    assert page.count("  struts ") == 6


def test_csv_has_a_row_per_scene_and_method(run: Run):
    ended = run("compare", "prism.yaml", "bracket.yaml", "--lm", *ONCE, "--format", "csv")
    rows = list(csv.DictReader(io.StringIO(ended.stdout)))
    assert [(row["scene"], row["name"]) for row in rows] == [
        ("prism.yaml", "cgff"),
        ("prism.yaml", "lm"),
        ("bracket.yaml", "cgff"),
        ("bracket.yaml", "lm"),
    ]
    assert all(float(row["seconds_to_residual_1e-12"]) > 0.0 for row in rows)
    assert rows[0]["iterations_to_shape_1e-02"] in ("3", "4")


def test_a_method_without_answer_has_empty_cells(run: Run):
    text = run("compare", "prism.yaml", "--schek", *ONCE, "--format", "csv").stdout
    row = list(csv.DictReader(io.StringIO(text)))[1]
    assert (row["verdict"], row["energy"], row["seconds_to_residual_1e-02"]) == ("failed", "", "")


@pytest.mark.parametrize("name", ["out.json", "out.csv"])
def test_the_files_name_decides(run: Run, name: str):
    ended = run("compare", "prism.yaml", "bracket.yaml", "--lm", *ONCE, "-o", name)
    assert (ended.exit_code, ended.stdout) == (0, "")
    text = Path(name).read_text()
    if name.endswith(".json"):
        assert [record["scene"]["path"] for record in json.loads(text)] == ["prism.yaml", "bracket.yaml"]
    else:
        assert text.startswith("scene,name,verdict,")


def test_a_bad_scene_stops_only_itself(run: Run, bad: str):
    ended = run("compare", bad, "prism.yaml", "--lm", *ONCE)
    assert ended.exit_code == 3
    assert ended.stderr.startswith("bad.yaml:1:1: ")
    assert json.loads(ended.stdout)["scene"]["path"] == "prism.yaml"


def test_cgff_without_an_answer_is_exit_code_4(run: Run):
    ended = run("compare", "prism.yaml", "--lm", *ONCE, "--max-iterations", "2")
    assert ended.exit_code == 4
    assert ended.stderr.startswith("cgff: prism.yaml: max_iterations: ")
    assert json.loads(ended.stdout)["methods"][0]["converged"] is False


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("-o", "out.txt"), "the name must end in .json"),
        (("-o", "out.csv", "--format", "json"), "--format json and -o out.csv disagree"),
        (("--plot", "prism.yaml"), "the name must end in .png or .svg"),
        (("--repeat", "0"), "--repeat"),
        (("--newton",), "--newton"),
    ],
)
def test_wrong_usage_is_refused_before_anything_is_solved(run: Run, arguments: tuple[str, ...], words: str):
    ended = run("compare", "prism.yaml", "--lm", *arguments)
    assert ended.exit_code == 2
    assert words in ended.stderr


def test_no_output_replaces_a_scene(run: Run):
    Path("scene.json").write_text("{}")
    ended = run("compare", "scene.json", "--lm", "-o", "scene.json")
    assert ended.exit_code == 2
    assert Path("scene.json").read_text() == "{}"


def test_a_picture_needs_matplotlib_and_says_so(run: Run, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(plots, "find_spec", lambda name: None)
    ended = run("compare", "prism.yaml", "--lm", "--plot", "out.png")
    assert (ended.exit_code, ended.stdout) == (2, "")
    assert ended.stderr == (
        "cgff: --plot needs matplotlib, which is not installed: pip install 'cgff-cli[plot]'\n"
    )


@pytest.mark.needs_matplotlib
@pytest.mark.parametrize(("name", "begins"), [("out.png", b"\x89PNG"), ("out.svg", b"<?xml")])
def test_a_picture_is_written(run: Run, name: str, begins: bytes):
    ended = run("compare", "prism.yaml", "bracket.yaml", "--lm", "--schek", *ONCE, "--plot", name)
    assert ended.exit_code == 0, ended.stderr
    assert Path(name).read_bytes().startswith(begins)
    assert "matplotlib.pyplot" not in sys.modules


def test_ctrl_c_leaves_the_scenes_already_compared(run: Run, monkeypatch: pytest.MonkeyPatch):
    real = compare.compare

    def interrupted(scene: Scene, **options: object):
        if scene.path == "bracket.yaml":
            raise KeyboardInterrupt
        return real(scene, **options)

    monkeypatch.setattr(compare, "compare", interrupted)
    ended = run("compare", "prism.yaml", "bracket.yaml", "prism.yaml", "--lm", *ONCE, "-o", "out.json")
    assert (ended.exit_code, ended.stderr) == (130, "cgff: bracket.yaml: interrupted\n")
    assert json.loads(Path("out.json").read_text())["scene"]["path"] == "prism.yaml"
    ended = run("compare", "bracket.yaml", "prism.yaml", "--lm", *ONCE, "-o", "none.json")
    assert ended.exit_code == 130
    assert not Path("none.json").exists()
