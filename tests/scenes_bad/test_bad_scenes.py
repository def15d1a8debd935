"""Every broken scene beside this file is refused with exactly the lines of expected.txt.

expected.txt holds one block per scene: "== FILE", then the lines. CSV files are tables of the scenes
they are named after.
"""

from pathlib import Path

import pytest
import yaml
from click.testing import CliRunner

import cgff_cli
from cgff_cli.cli import main

HERE = Path(__file__).parent


def expected_lines() -> dict[str, list[str]]:
    blocks = (HERE / "expected.txt").read_text(encoding="utf-8").removeprefix("== ").split("\n== ")
    return {name: [line for line in lines if line] for name, *lines in (b.split("\n") for b in blocks)}


EXPECTED = expected_lines()
SCENES = sorted(path.name for path in HERE.iterdir() if path.suffix in (".yaml", ".json"))


@pytest.fixture(autouse=True)
def beside_the_scenes(monkeypatch):
    monkeypatch.chdir(HERE)


def test_every_scene_has_its_lines():
    assert sorted(EXPECTED) == SCENES
    assert all(EXPECTED.values())


@pytest.mark.parametrize("name", SCENES)
def test_the_reader_reports_exactly(name):
    with pytest.raises(cgff_cli.SceneError) as caught:
        cgff_cli.load(name)
    assert str(caught.value).split("\n") == EXPECTED[name]


@pytest.mark.parametrize("name", SCENES)
def test_check_prints_exactly_and_exits_with_3(name):
    result = CliRunner().invoke(main, ["check", name])
    assert result.exit_code == 3
    assert result.stderr.splitlines() == EXPECTED[name]
    assert result.stdout == ""


@pytest.mark.parametrize("name", SCENES)
def test_without_libyaml_the_words_are_the_same(name, monkeypatch):
    monkeypatch.delattr(yaml, "CSafeLoader", raising=False)
    with pytest.raises(cgff_cli.SceneError) as caught:
        cgff_cli.load(name)
    assert str(caught.value).split("\n") == EXPECTED[name]


def test_a_json_scene_on_standard_input_is_located_as_well():
    text = (HERE / "json-true.json").read_bytes()
    result = CliRunner().invoke(main, ["check", "-"], input=text)
    assert result.exit_code == 3
    assert result.stderr.splitlines() == [EXPECTED["json-true.json"][0].replace("json-true.json", "<stdin>")]


@pytest.mark.parametrize(
    ("path", "reason"),
    [
        ("nowhere.yaml", "no such file"),
        (".", "it is a directory"),
        ("empty.yaml/inside.yaml", "not a directory"),
    ],
)
def test_a_file_that_cannot_be_read_is_a_problem_without_a_place(path, reason):
    with pytest.raises(cgff_cli.SceneError) as caught:
        cgff_cli.load(path)
    assert str(caught.value) == f"{path}: cannot read the scene: {reason}"


def test_a_path_no_system_takes_is_a_problem_like_any_other():
    with pytest.raises(cgff_cli.SceneError, match="cannot read the scene"):
        cgff_cli.load("nul\0.yaml")
