"""A written scene reads back as the same scene, whatever its names and numbers."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

import cgff_cli
from cgff_cli.scene.fields import Plain
from cgff_cli.scene.read import from_dict
from cgff_cli.scene.scene import Group, Scene
from cgff_cli.scene.tables_out import element_table, node_table
from cgff_cli.scene.write import to_yaml
from tests.shapes import STRUCTURES

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
WORDS = st.text(st.sampled_from("abcXYZ019-_"), min_size=1, max_size=6).filter(
    lambda word: word not in ("dead", "all")
)
OWN = st.recursive(
    st.none() | st.booleans() | st.integers(-(10**20), 10**20) | NUMBERS | NAMES | st.just(""),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(NAMES, inner, max_size=3),
    max_leaves=8,
)


@st.composite
def actions(draw, n, dimension):
    """Gravity, load cases and combinations of a scene all of whose nodes are held."""
    force = st.tuples(*[NUMBERS] * dimension)
    cases = draw(
        st.dictionaries(WORDS, st.dictionaries(st.integers(0, n - 1), force, max_size=n), max_size=3)
    )
    factors = st.dictionaries(st.sampled_from(["dead", *cases]), NUMBERS, min_size=1)
    names = WORDS.filter(lambda name: name not in cases)
    return {
        "gravity": draw(st.none() | force.filter(any)),
        "load_cases": cases,
        "combinations": draw(st.dictionaries(names, factors, max_size=2)),
    }


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
    held = draw(st.booleans())
    return Scene(
        name=draw(NAMES),
        law=law,
        node_names=tuple(names),
        coordinates=np.array(coordinates),
        groups=groups,
        supports=dict.fromkeys(range(n), axes) if held else {0: axes, n - 1: axes[-1]},
        loads={row: tuple(draw(NUMBERS) for _ in range(dimension)) for row in draw(st.sets(st.just(0)))},
        solver=draw(st.sampled_from([{}, {"tolerance": 1e-8, "max_iterations": 7, "cg_beta": "PR+"}])),
        **(draw(actions(n, dimension)) if held else {}),
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
    weights = st.just(0.0) | SIZES
    weight = draw(st.none() | st.lists(weights, min_size=count, max_size=count).map(np.array))
    return Group(name, draw(st.sampled_from(["cable", "strut"])), np.array(pairs), *columns, weight=weight)


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


@pytest.mark.parametrize("path", sorted(STRUCTURES.glob("*.yaml")), ids=lambda path: path.stem)
def test_every_structure_of_the_project_survives(path, assert_same):
    scene = cgff_cli.load(path)
    assert_same(cgff_cli.loads(to_yaml(scene)), scene)


def meant(value):
    """Return a value of one's own as JSON would read it: what stands without quotes is no text."""
    if isinstance(value, Plain):
        return json.loads(value)
    if isinstance(value, dict):
        return {str(key): meant(own) for key, own in value.items()}
    return list(map(meant, value)) if isinstance(value, list) else value


@settings(max_examples=200, deadline=None)
@given(value=OWN, inside=OWN)
def test_keys_of_ones_own_stay_what_they_were(value, inside):
    bar = {"kind": "strut", "EA": 1.0, "rest_length": 1.0, "pairs": [["a", "b"]], "x-in": inside}
    nodes = {"a": [0.0, 0.0], "b": [1.0, 0.0]}
    scene = from_dict({"law": "paper", "nodes": nodes, "elements": {"bar": bar}, "x-own": value})
    again = cgff_cli.loads(to_yaml(scene))
    for own, given_value in ((again.own["x-own"], value), (again.groups[0].own["x-in"], inside)):
        read = meant(own)
        assert (read, repr(read)) == (given_value, repr(given_value))
    assert to_yaml(again) == to_yaml(scene)


def test_own_keys_hold_anchors_that_the_rest_of_a_scene_uses():
    text = """\
x-steel: &steel 100
x-sets:
  - &pair [a, b]
law: paper
nodes: {a: [0, 0], b: [1, 0]}
elements: {bar: {kind: cable, EA: *steel, pretension: 5, pairs: [*pair], x-grade: 's235: "e"'}}
supports: {a: xy, b: xy}
"""
    scene = cgff_cli.loads(text)
    assert scene.axial_stiffness.tolist() == [100.0]
    again = cgff_cli.loads(to_yaml(scene))
    assert again.own == {"x-steel": "100", "x-sets": [["a", "b"]]} == scene.own
    assert again.groups[0].own == {"x-grade": 's235: "e"'}


@settings(max_examples=100, deadline=None)
@given(
    law=st.sampled_from(["paper", "hooke"]),
    shares=st.lists(st.integers(-9, 9).map(lambda own: own / 10), min_size=1, max_size=5),
    EA=st.floats(1e-6, 1e6),
)
def test_pretension_stays_pretension(law, shares, EA):
    lengths = np.arange(1.0, len(shares) + 1.0)
    forces = [
        float(EA * own * (l if law == "paper" else 1.0)) for own, l in zip(shares, lengths, strict=True)
    ]
    x = [0.0, *np.cumsum(lengths).tolist()]
    pairs = [[f"n{i}", f"n{i + 1}"] for i in range(len(shares))]
    struts = {"kind": "strut", "EA": EA, "pretension": forces, "pairs": pairs}
    nodes = {f"n{i}": [own, 0.0] for i, own in enumerate(x)}
    scene = from_dict({"law": law, "nodes": nodes, "elements": {"struts": struts}})
    again = cgff_cli.loads(to_yaml(scene)).groups[0]
    assert again.pretension.tolist() == forces
    assert again.rest_length.tolist() == scene.groups[0].rest_length.tolist()
    l0 = again.rest_length
    stiffness = EA if law == "paper" else EA / l0
    assert stiffness * (lengths - l0) == pytest.approx(forces, rel=1e-12, abs=1e-12 * EA * lengths.max())


def test_weights_and_rest_lengths_of_pretensions_survive_as_tables(tmp_path, assert_same):
    text = """\
law: hooke
nodes: {a: [0, 0], b: [3, 4], c: [6, 0]}
elements:
  rope: {kind: cable, EA: 100, pretension: [3, 0], weight: [0.1, 0], pairs: [[a, b], [b, c]]}
  bar: {kind: strut, EA: 100, rest_length: 6, pairs: [[a, c]]}
supports: {a: xy, b: xy, c: xy}
gravity: [0.5, -2]
load_cases: {snow: {b: [0, -1]}, none: {}}
combinations: {uls: {dead: 1.35, snow: 1.5}}
x-note: "1"
"""
    scene = cgff_cli.loads(text)
    (tmp_path / "n.csv").write_text("".join(node_table(scene)))
    (tmp_path / "e.csv").write_text("".join(element_table(scene)))
    (tmp_path / "scene.yaml").write_text(to_yaml(scene, tables=("n.csv", "e.csv")))
    again = cgff_cli.load(tmp_path / "scene.yaml")
    weights = [group.weight.tolist() for group in again.groups]
    assert weights == [[0.1, 0.0], [0.0]]
    bare = [replace(group, pretension=None, weight=None) for group in scene.groups]
    assert_same(
        replace(again, groups=tuple(replace(group, weight=None) for group in again.groups)),
        replace(scene, groups=tuple(bare), name="scene"),
        but=("name",),
    )


def test_tables_of_supports_and_loads_become_part_of_a_written_scene(tmp_path, assert_same):
    (tmp_path / "s.csv").write_text("axes,name,who\nyx,a,me\n y ,b,you\n")
    (tmp_path / "l.csv").write_text("name,x,y\nb,0.5,-1\n")
    (tmp_path / "w.csv").write_text("y,name,x\n1,b,0\n")
    (tmp_path / "scene.yaml").write_text(
        "law: paper\nnodes: {a: [0, 0], b: [1, 0]}\n"
        "elements: {bar: {kind: strut, EA: 1, rest_length: 1, pairs: [[a, b]]}}\n"
        "supports: s.csv\nloads: l.csv\nload_cases: {wind: w.csv}\n"
    )
    scene = cgff_cli.load(tmp_path / "scene.yaml")
    assert scene.supports == {0: "xy", 1: "y"}
    assert (scene.loads, scene.load_cases) == ({1: (0.5, -1.0)}, {"wind": {1: (0.0, 1.0)}})
    assert scene.notes == (f"{tmp_path / 's.csv'}: not used: 1 column, who",)
    assert_same(cgff_cli.loads(to_yaml(scene)), scene)
