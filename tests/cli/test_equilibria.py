"""`cgff equilibria`: what a person reads, what a program reads, and how it ends."""

import csv
import json
from pathlib import Path

import pytest

from cgff_cli.study.landscape import COLUMNS_OF_EQUILIBRIA
from tests.cli.conftest import Run

SLACK = """\
law: paper
nodes: {a: [0, 0], b: [0.5, 0], c: [0, 0.5]}
elements: {cables: {kind: cable, EA: 1, rest_length: 1, pairs: [[a, b], [b, c]]}}
"""


def test_a_person_reads_the_verdict_first_and_then_a_table(run: Run):
    ended = run("equilibria", "bracket.yaml", "--format", "table")
    lines = ended.stdout.splitlines()
    assert ended.exit_code == 0
    assert "verdict" in lines[2]
    assert "2 stable equilibria of 1 kind in 200 starts" in " ".join(ended.stdout.split())
    assert [line.split()[:2] for line in lines[-2:]] == [["1", "7.58503"]] * 2


def test_many_shapes_are_summed_up_by_kind_unless_all_are_wanted(run: Run):
    chain = [
        "law: hooke",
        "nodes: {"
        + ", ".join(f"f{i}: [{2 * i}, 0], t{i}: [{2 * i + 1}, 0.5]" for i in range(5))
        + ", f5: [10, 0]}",
        "elements: {bars: {kind: strut, EA: 100, rest_length: 1.1180339887498949, pairs: ["
        + ", ".join(f"[f{i}, t{i}], [t{i}, f{i + 1}]" for i in range(5))
        + "]}}",
        "supports: {" + ", ".join(f"f{i}: xy" for i in range(6)) + "}",
    ]
    Path("chain.yaml").write_text("\n".join(chain))
    short = run("equilibria", "chain.yaml", "--starts", "400", "--format", "table").stdout
    full = run("equilibria", "chain.yaml", "--starts", "400", "--format", "table", "-v").stdout
    assert "32 stable equilibria of" in " ".join(short.split())
    assert "shapes" in short
    assert len(full.splitlines()) - len(short.splitlines()) == 32 - 10  # ups and downs, but for two mirrors


def test_a_program_reads_the_same_from_json_and_csv(run: Run):
    told = json.loads(run("equilibria", "bracket.yaml", "--format", "json").stdout)
    rows = list(csv.DictReader(run("equilibria", "bracket.yaml", "--format", "csv").stdout.splitlines()))
    assert told["schema"] == "cgff-equilibria/1"
    assert [tuple(row) for row in rows] == [COLUMNS_OF_EQUILIBRIA] * 2
    assert [float(row["energy"]) for row in rows] == [own["energy"] for own in told["equilibria"]]
    assert [list(own["nodes"]) for own in told["equilibria"]] == [["foot", "head", "tip"]] * 2
    assert told["equilibria"][0]["nodes"]["foot"] == [0.0, 0.0]


def test_none_found_is_told_and_written_and_ends_with_4(run: Run):
    Path("slack.yaml").write_text(SLACK)
    ended = run("equilibria", "slack.yaml", "--starts", "5", "-o", "found.json")
    assert (ended.exit_code, ended.stderr) == (4, "cgff: slack.yaml: no stable equilibrium in 5 starts\n")
    told = json.loads(Path("found.json").read_text())
    assert (told["neutral"], told["equilibria"], told["kinds"]) == (5, [], 0)
    assert json.loads(run("equilibria", "slack.yaml", "--starts", "5", "--all").stdout)["kinds"] > 0


def test_the_scene_is_never_written_over(run: Run):
    ended = run("equilibria", "prism.yaml", "-o", "prism.yaml")
    assert ended.exit_code == 2
    assert Path("prism.yaml").read_text().startswith("# ")


@pytest.mark.parametrize(
    "flags", [("--starts", "0"), ("--seed", "-1"), ("--jobs", "0"), ("--starts", "many")]
)
def test_a_number_out_of_range_is_wrong_usage(run: Run, flags: tuple[str, str]):
    ended = run("equilibria", "prism.yaml", *flags)
    assert (ended.exit_code, ended.stdout) == (2, "")


def test_a_bad_scene_is_reported_with_its_places(run: Run, bad: str):
    ended = run("equilibria", bad)
    assert ended.exit_code == 3
    assert ended.stderr.startswith("bad.yaml:")


def test_standard_input_is_a_scene(run: Run):
    told = json.loads(run("equilibria", "-", "--starts", "3", stdin=Path("prism.yaml").read_text()).stdout)
    assert (told["scene"]["path"], told["starts"]) == ("<stdin>", 3)
