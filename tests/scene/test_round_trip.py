"""A written scene reads back as the same scene, whatever its names and numbers."""

import math

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

import cgff_cli
from cgff_cli.scene.scene import Group, Scene
from cgff_cli.scene.write import to_yaml

SIZES = st.floats(min_value=1e-30, max_value=1e30)
NUMBERS = st.floats(min_value=-1e30, max_value=1e30)
TEXTS = st.text(
    st.characters(exclude_categories=["Cc", "Cs", "Zl", "Zp"], exclude_characters="\ufeff\ufffe\uffff"),
    min_size=1,
    max_size=12,
)
NAMES = TEXTS | st.sampled_from(
    ["null", "no", "<<", "~", "1", "1e3", "a: b", "- a", "#", "top.1", "x y", "'", '"', "\\"]
)


@st.composite
def scenes(draw):
    dimension = draw(st.sampled_from([2, 3]))
    names = draw(st.lists(NAMES, min_size=2, max_size=6, unique=True))
    n = len(names)
    coordinates = [[draw(NUMBERS) for _ in range(dimension)] for _ in range(n)]
    group_names = draw(st.lists(NAMES, min_size=1, max_size=3, unique=True))
    law = draw(st.sampled_from(["paper", "hooke"]))
    groups = tuple(draw(group(name, n, law)) for name in group_names)
    axes = "xyz"[:dimension]
    return Scene(
        name=draw(NAMES),
        law=law,
        node_names=tuple(names),
        coordinates=np.array(coordinates),
        groups=groups,
        supports=dict.fromkeys(range(n), axes) if draw(st.booleans()) else {0: axes, n - 1: axes[-1]},
        loads={row: tuple(draw(NUMBERS) for _ in range(dimension)) for row in draw(st.sets(st.just(0)))},
        solver=draw(st.sampled_from([{}, {"tolerance": 1e-8, "max_iterations": 7, "cg_beta": "PR+"}])),
    )


@st.composite
def group(draw, name, n, law):
    # every node has an element: a chain through all of them
    pairs = [(row, row + 1) for row in range(n - 1)]
    count = len(pairs)
    lengths = SIZES if law == "hooke" else SIZES | st.just(0.0)
    one = draw(st.booleans())
    columns = [
        np.full(count, draw(values)) if one else np.array([draw(values) for _ in pairs])
        for values in (SIZES, lengths)
    ]
    return Group(name, draw(st.sampled_from(["cable", "strut"])), np.array(pairs), *columns)


@settings(max_examples=300, deadline=None)
@given(scene=scenes())
def test_a_written_scene_reads_back_the_same(assert_same, scene):
    assert_same(cgff_cli.loads(to_yaml(scene)), scene)


@settings(max_examples=100, deadline=None)
@given(scene=scenes())
def test_what_is_written_is_yaml_to_others_too(scene):
    values = yaml.load(to_yaml(scene), Loader=yaml.BaseLoader)
    assert tuple(values["nodes"]) == scene.node_names
    assert [group["kind"] for group in values["elements"].values()] == [group.kind for group in scene.groups]


def test_a_written_scene_is_nice_to_read():
    text = """\
name: Triangular prism, Table IV
law: paper
nodes:
  b1: [1.8, 0.05, -0.0]
  2: [0.1, 1e-08, 200000.0]
  "a: b": [1.0, 10.0, 1.0]
elements:
  ring:
    kind: cable
    EA: 100.0
    rest_length: [2.98, 1.0, 3.0]
    pairs: [[b1, 2], [2, "a: b"], ["a: b", b1]]
supports:
  b1: xyz
loads:
  2: [0.0, 0.0, -0.5]
solver:
  tolerance: 1e-12
  method: table1
"""
    assert to_yaml(cgff_cli.loads(text)) == text


def test_long_lists_are_broken_into_lines(assert_same):
    names = [f"node-{i}" for i in range(60)]
    pairs = np.array([(i, i + 1) for i in range(59)])
    chain = Group("chain", "cable", pairs, np.linspace(1, 2, 59), np.full(59, math.pi))
    scene = Scene("chain", "paper", tuple(names), np.zeros((60, 2)), (chain,))
    text = to_yaml(scene)
    assert max(map(len, text.splitlines())) <= 100
    assert_same(cgff_cli.loads(text), scene)


def test_writing_a_scene_read_from_tables_keeps_everything(tmp_path, assert_same):
    (tmp_path / "n.csv").write_text("name,x,y\na,0,0\nb,1,0\n")
    (tmp_path / "e.csv").write_text("start,end,group,kind,EA,rest_length\na,b,bar,strut,0.1,0.3\n")
    (tmp_path / "scene.yaml").write_text("law: hooke\nnodes: n.csv\nelements: e.csv\n")
    scene = cgff_cli.load(tmp_path / "scene.yaml")
    assert_same(cgff_cli.loads(to_yaml(scene)), scene)


@pytest.mark.parametrize("name", ["prism", "hexagon", "x-module", "octahedron", "bracket", "cable-net"])
def test_every_structure_of_the_project_survives(name, assert_same):
    from tests.shapes import STRUCTURES

    scene = cgff_cli.load(STRUCTURES / f"{name}.yaml")
    assert_same(cgff_cli.loads(to_yaml(scene)), scene)
