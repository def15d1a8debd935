"""A scene written with its tables beside it reads back as the same scene."""

import pytest
from hypothesis import HealthCheck, assume, given, settings

import cgff_cli
from cgff_cli.scene.tables_out import element_table, node_table
from cgff_cli.scene.write import to_yaml
from tests.scene.test_round_trip import scenes
from tests.shapes import STRUCTURES


def read_back(scene, folder):
    (folder / "s.nodes.csv").write_text("".join(node_table(scene)), encoding="utf-8")
    (folder / "s.elements.csv").write_text("".join(element_table(scene)), encoding="utf-8")
    return cgff_cli.loads(to_yaml(scene, "", ("s.nodes.csv", "s.elements.csv")), base=folder)


@settings(max_examples=200, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(scene=scenes())
def test_any_scene_whose_names_end_in_no_blanks(assert_same, tmp_path, scene):
    names = [*scene.node_names, *(group.name for group in scene.groups)]
    assume(all(name == name.strip() for name in names))  # cells lose the blanks around them
    assert_same(read_back(scene, tmp_path), scene)


@pytest.mark.parametrize("name", ["prism", "x-module", "cable-net"])
def test_the_structures_of_the_project(assert_same, tmp_path, name):
    scene = cgff_cli.load(STRUCTURES / f"{name}.yaml")
    assert_same(read_back(scene, tmp_path), scene)


def test_names_with_commas_and_quotes_stand_in_quotes(tmp_path, assert_same):
    scene = cgff_cli.loads(
        'law: paper\nnodes: {"a,1": [0, 0], "b\\"2": [1, 0]}\n'
        'elements: {"x, y": {kind: strut, EA: 1, rest_length: 1, pairs: [["a,1", "b\\"2"]]}}\n'
    )
    assert "".join(node_table(scene)) == 'name,x,y\n"a,1",0.0,0.0\n"b""2",1.0,0.0\n'
    assert_same(read_back(scene, tmp_path), scene)
