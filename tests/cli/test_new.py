"""`cgff new`: to standard output or a file, tables beside large scenes, and what is refused."""

from pathlib import Path

import pytest
from click.testing import CliRunner

import cgff_cli
from cgff_cli.cli import main
from cgff_cli.scene.families import FAMILIES
from cgff_cli.scene.new import find
from tests.cli.conftest import Run


def test_the_scene_goes_to_standard_output(run: Run):
    ended = run("new", "prism", "--sides", "4")
    assert ended.exit_code == 0
    assert ended.stderr == ""
    assert ended.stdout.startswith("# Prism of 4 sides.\n# Made by: cgff new prism --sides 4\n#\n# Answer: ")
    assert len(cgff_cli.loads(ended.stdout).node_names) == 8


def test_a_new_scene_can_be_solved_from_a_pipe(run: Run):
    scene = run("new", "octahedron", "--noise", "0.1", "--seed", "3").stdout
    assert run("solve", "-", "--format", "json", stdin=scene).exit_code == 0


def test_python_and_the_command_make_the_same_scene(run: Run):
    run("new", "net", "--side", "6", "--EA", "50", "--jitter", "0.01", "--seed", "2", "-o", "net.yaml")
    made = cgff_cli.new("net", side=6, EA=50, jitter=0.01, seed=2)
    read = cgff_cli.load("net.yaml")
    assert (read.coordinates == made.coordinates).all()
    assert (read.groups[1].rest_length == made.groups[1].rest_length).all()


def test_a_small_scene_is_one_file_and_a_large_one_keeps_tables_beside_it(run: Run):
    assert run("new", "tower", "--stages", "10", "-o", "small.yaml").exit_code == 0
    assert run("new", "tower", "--stages", "200", "-o", "large.yml").exit_code == 0
    assert sorted(path.name for path in Path().glob("[sl]*")) == [
        "large.elements.csv",
        "large.nodes.csv",
        "large.yml",
        "small.yaml",
    ]
    assert "\nnodes: large.nodes.csv\nelements: large.elements.csv\n" in Path("large.yml").read_text()
    assert cgff_cli.load("large.yml").element_count == 2403


def test_a_large_scene_is_one_file_on_standard_output_and_where_tables_are_refused(run: Run):
    large = ("new", "tower", "--stages", "200")
    assert run(*large, "--no-tables", "-o", "large.yaml").exit_code == 0
    assert Path("large.yaml").read_text().count("\n") == run(*large).stdout.count("\n") > 600
    assert not list(Path().glob("*.csv"))


def test_tables_may_be_asked_for_and_refused(run: Run):
    assert run("new", "net", "--tables", "-o", "net.yaml").exit_code == 0
    assert Path("net.nodes.csv").exists()
    tabled = cgff_cli.load("net.yaml")
    assert run("new", "net", "--no-tables", "-o", "whole.yaml").exit_code == 0
    whole = cgff_cli.load("whole.yaml")
    assert not Path("whole.nodes.csv").exists()
    assert tabled.node_names == whole.node_names
    assert (tabled.coordinates == whole.coordinates).all()
    assert tabled.supports == whole.supports
    for one, other in zip(tabled.groups, whole.groups, strict=True):
        assert (one.name, one.kind) == (other.name, other.kind)
        assert (one.pairs == other.pairs).all()
        assert (one.rest_length == other.rest_length).all()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["prysm"], "no such family 'prysm'; did you mean 'prism'?"),
        (["prism", "--sides", "2"], "sides must be a whole number from 3 to 1000000, got 2"),
        (["prism", "--sides", "1e400"], "sides must be a whole number from 3 to 1000000, got inf"),
        (["prism", "--radius", "1_0x"], "radius must be a number > 0, got '1_0x'"),
        (["prism", "--strut", "1"], "strut must be longer than 1.93185 for a radius of 1, got 1"),
        (["prism", "--tables"], "--tables needs -o FILE.yaml, beside which the tables are written"),
        (["prism", "-o", "prism.csv"], "the name of a scene must end in .yaml or .yml"),
        (["polyhedron", "--kind", "sphere"], "'sphere'"),
    ],
)
def test_what_cannot_be_is_wrong_usage(run: Run, arguments: list[str], words: str):
    ended = run("new", *arguments)
    assert ended.exit_code == 2
    assert ended.stdout == ""
    assert words in ended.stderr
    assert not list(Path().glob("*.csv"))


@pytest.mark.parametrize("name", FAMILIES)
def test_the_help_of_a_family_names_all_its_parameters_and_ends_with_examples(run: Run, name: str):
    text = run("new", name, "--help").stdout
    family = find(name)
    for parameter in (family.own | family.common).values():
        assert f"  {parameter.flag} " in text
    assert text.rstrip().splitlines()[-len(family.examples) - 1 :] == [
        "  Examples:",
        *(f"    {example}" for example in family.examples),
    ]


@pytest.mark.parametrize("name", FAMILIES)
def test_the_examples_of_a_family_run(run: Run, name: str):
    for example in find(name).examples:
        if "700" not in example and "1000" not in example:
            first = example.split(" | ")[0].split()[1:]
            assert CliRunner().invoke(main, first).exit_code == 0, example


def test_the_families_are_listed(run: Run):
    text = " ".join(run("new", "--help").stdout.split())
    for name, words in FAMILIES.items():
        assert f" {name} {words}" in text
