"""A geometry: a scene whose groups have no rest lengths."""

import pytest
from click.testing import CliRunner

import cgff_cli
from cgff_cli.cli import main
from cgff_cli.scene.tables_out import element_table, node_table
from cgff_cli.structure import from_scene

TRIANGLE = """law: hooke
nodes: {a: [0, 0], b: [4, 0], c: [0, 3]}
elements:
  ring: {kind: cable, EA: 10, pairs: [[a, b], [b, c]]}
  bar: {kind: strut, EA: 20, pairs: [[c, a]]}
"""
REFUSED = (
    "elements: without rest_length this is a geometry, and has no forces; "
    "`cgff prestress` finds rest lengths that hold it"
)


def written(tmp_path, text=TRIANGLE):
    path = tmp_path / "shape.yaml"
    path.write_text(text)
    return str(path)


def test_a_scene_without_any_rest_length_is_a_geometry():
    scene = cgff_cli.loads(TRIANGLE)
    assert scene.is_geometry
    assert not cgff_cli.loads(TRIANGLE.replace("EA: ", "rest_length: 1, EA: ")).is_geometry


def test_rest_lengths_in_some_groups_only_are_a_mistake():
    with pytest.raises(cgff_cli.SceneError) as caught:
        cgff_cli.loads(TRIANGLE.replace("EA: 20", "EA: 20, rest_length: 3"))
    assert str(caught.value) == (
        "<text>:4:3: elements.ring: missing key 'rest_length', or 'pretension' in its place"
    )


def test_a_misspelt_rest_length_is_no_geometry():
    with pytest.raises(cgff_cli.SceneError) as caught:
        cgff_cli.loads(TRIANGLE.replace("EA: ", "rest_lenght: 1, EA: "))
    assert "did you mean 'rest_length'?" in str(caught.value)


@pytest.mark.parametrize("command", ["solve", "compare", "bench"])
def test_what_needs_forces_refuses_a_geometry_at_its_place(command, tmp_path):
    path = written(tmp_path)
    result = CliRunner().invoke(main, [command, path])
    assert (result.exit_code, result.stderr) == (3, f"{path}:3:1: {REFUSED}\n")


def test_check_takes_a_geometry_and_says_so(tmp_path):
    result = CliRunner().invoke(main, ["check", written(tmp_path)])
    assert result.exit_code == 0
    assert result.stdout.endswith("law hooke, a geometry without rest lengths\n")


def test_a_geometry_is_written_as_one_and_reads_back(tmp_path):
    scene = cgff_cli.loads(TRIANGLE)
    for name, table in (("n.csv", node_table), ("e.csv", element_table)):
        (tmp_path / name).write_text("".join(table(scene)))
    by_tables = cgff_cli.loads("law: hooke\nnodes: n.csv\nelements: e.csv\n", base=tmp_path)
    for again in (cgff_cli.loads(cgff_cli.to_yaml(scene)), by_tables):
        assert again.is_geometry
        assert [group.EA.tolist() for group in again.groups] == [[10.0, 10.0], [20.0]]


def test_with_rest_lengths_a_geometry_is_a_scene_like_any_other():
    scene = cgff_cli.loads(TRIANGLE).with_rest_lengths([3.9, 4.9, 3.1])
    assert not scene.is_geometry
    assert from_scene(scene).rest_lengths.tolist() == [3.9, 4.9, 3.1]
    with pytest.raises(cgff_cli.OptionError, match=r"must have the shape \(3,\), got \(2,\)"):
        scene.with_rest_lengths([1.0, 2.0])
