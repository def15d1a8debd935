"""OBJ lines: a geometry for `prestress`, there and back."""

import pytest

import cgff_cli
from cgff_cli.errors import OptionError, SceneError
from tests.geometries import prism

ASKED = {"law": "paper", "EA": 10.0, "kind": "cable"}


def converted(tmp_path, text, **more):
    (tmp_path / "own.obj").write_text(text)
    return cgff_cli.convert(str(tmp_path / "own.obj"), **{**ASKED, **more})


def test_a_geometry_comes_back_as_it_went_and_prestress_holds_it(tmp_path):
    scene = prism(3)
    (tmp_path / "prism.yaml").write_text(cgff_cli.to_yaml(scene))
    text = cgff_cli.convert(str(tmp_path / "prism.yaml")).written("obj")
    kinds = {"": "cable"} | {group.name: group.kind for group in scene.groups}
    back = converted(tmp_path, text, kind=kinds).scene
    assert back.coordinates.tolist() == scene.coordinates.tolist()
    assert [(own.name, own.kind, own.pairs.tolist()) for own in back.groups] == [
        (own.name, own.kind, own.pairs.tolist()) for own in scene.groups
    ]
    assert back.is_geometry
    assert cgff_cli.prestress(back).feasible


def test_polylines_numbers_from_the_end_continued_lines_and_textures(tmp_path):
    text = "v 0 0 0 1\nv 1 0 0\n# l 1 1\nv 0 1 0\ng a b\nl 1/1 2/2 \\\n 3\no c\nl -1 1\nf 1 2 3\n"
    found = converted(tmp_path, text)
    assert [(own.name, own.pairs.tolist()) for own in found.scene.groups] == [
        ("a b", [[0, 1], [1, 2]]),
        ("c", [[2, 0]]),
    ]
    assert found.lost == ("1 face", "what 1 vertex say beyond x, y, z")


def test_vertices_at_one_point_are_one_node_as_curves_have_ends_of_their_own(tmp_path):
    found = converted(tmp_path, "v 0 0 0\nv 1 0 0\nl 1 2\nv 1 0 0\nv 1 1 0\nl 3 4\nv 9 9 9\n")
    assert found.scene.node_names == ("n1", "n2", "n4")
    assert found.lost == ("1 vertex at the very point of another", "1 node that no element joins: 'n5'")


def test_what_it_does_not_say_is_asked_for(tmp_path):
    text = "v 0 0 0\nv 1 0 0\nv 2 0 0\ng bars\nl 1 2\ng ties\nl 2 3\n"
    for gone, said in (
        ({"law": None}, "says no law: give --law hooke or --law paper"),
        ({"EA": None}, "says no EA of its cables: give --EA"),
        ({"kind": {"bars": "strut"}}, "give --kind cable or --kind GROUP=strut, for 'ties'"),
        (
            {"kind": {"": "cable", "rods": "strut"}},
            "there is no such group in an OBJ file: 'bars' and 'ties'",
        ),
        ({"nodes": "x.csv"}, "--nodes has no place: an OBJ file needs none"),
    ):
        with pytest.raises(OptionError, match=said):
            converted(tmp_path, text, **gone)
    groups = converted(tmp_path, text, strut_EA=3.0, kind={"bars": "strut", "": "cable"}).scene.groups
    assert [(own.kind, own.EA.tolist()) for own in groups] == [("strut", [3.0]), ("cable", [10.0])]


def test_every_mistake_is_told_at_once_at_its_place(tmp_path):
    text = "v 0 0\nv 1 x 0\nv 1 0 0\nl 1\nl 1 0\nl 1 7\nl 2 -9\nl 3 two\n"
    with pytest.raises(SceneError) as caught:
        converted(tmp_path, text)
    assert [str(own).partition("own.obj")[2] for own in caught.value.problems] == [
        ":1:1: a vertex has three coordinates, got 2",
        ":2:5: must be a number such as 2.98 or 1e-8, got 'x'",
        ":4:1: a line joins at least two vertices",
        ":5:5: must be the number of a vertex, from 1, got '0'",
        ":6:5: there is no vertex 7; the file has 3 vertices",
        ":7:5: there are not so many vertices before this line, got '-9'",
        ":8:5: must be the number of a vertex, from 1, got 'two'",
    ]
    with pytest.raises(SceneError, match=r"own\.obj:3:3: node 'n1' is joined to itself"):
        converted(tmp_path, "v 0 0 0\nv 1 0 0\nl 1 1\n")
    with pytest.raises(SceneError, match="there is no element in this file"):
        converted(tmp_path, "v 0 0 0\n")


def test_names_that_the_format_cannot_hold_stay_apart(tmp_path):
    elements = {
        name: {"kind": "cable", "EA": 1.0, "rest_length": 1.0, "pairs": [pair]}
        for name, pair in {"a b": ["p", "q"], "a_b": ["q", "r"]}.items()
    }
    nodes = {"p": [0, 0], "q": [1, 0], "r": [0, 1]}
    (tmp_path / "s.yaml").write_text(
        cgff_cli.to_yaml(cgff_cli.from_dict({"law": "paper", "nodes": nodes, "elements": elements}))
    )
    text = cgff_cli.convert(str(tmp_path / "s.yaml")).written("obj")
    assert [line for line in text.splitlines() if line[0] in "gl"] == ["g a_b", "l 1 2", "g a_b_2", "l 2 3"]


def test_ends_that_nearly_meet_are_one_node_where_that_is_asked(tmp_path):
    text = "v 0 0 0\nv 1 0 0\nv 1.000001 0 0\nv 2 1 0\nv 2 1 1e-6\nv 0 0 0\nl 1 2\nl 3 4\nl 5 6\n"
    assert len(converted(tmp_path, text).scene.node_names) == 5
    found = converted(tmp_path, text, merge=1e-5)
    assert found.scene.node_names == ("n1", "n2", "n4")
    assert found.scene.coordinates.tolist() == [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0]]
    assert found.scene.groups[0].pairs.tolist() == [[0, 1], [1, 2], [2, 0]]
    assert found.lost == ("3 vertices within 1e-05 of another",)
    with pytest.raises(SceneError, match="node 'n1' is joined to itself"):
        converted(tmp_path, text, merge=3.0)
    with pytest.raises(OptionError, match="--merge must be"):
        converted(tmp_path, text, merge=-1.0)
