"""A CSV of edges beside a CSV of nodes."""

import pytest

import cgff_cli
from cgff_cli.errors import OptionError, SceneError

NODES = "name,x,y\na,0,0\nb,1,0\nc,0,1\nidle,5,5\n"


def converted(tmp_path, edges, nodes=NODES, **more):
    (tmp_path / "edges.csv").write_text(edges)
    (tmp_path / "nodes.csv").write_text(nodes)
    asked = {"law": "hooke", "nodes": str(tmp_path / "nodes.csv"), **more}
    return cgff_cli.convert(str(tmp_path / "edges.csv"), **asked)


def test_two_columns_are_a_geometry_once_law_stiffness_and_kind_are_told(tmp_path):
    found = converted(tmp_path, "start,end\na,b\nb,c\n", EA=5.0, kind="cable")
    (group,) = found.scene.groups
    assert (group.name, group.pairs.tolist(), group.EA.tolist()) == ("elements", [[0, 1], [1, 2]], [5.0, 5.0])
    assert found.scene.is_geometry
    assert found.lost == ("1 node that no element joins: 'idle'",)
    assert [path.rpartition("/")[2] for path in found.scene.files] == ["edges.csv", "nodes.csv"]


def test_more_columns_say_more_and_nothing_is_asked(tmp_path):
    table = "end,start,group,kind,EA,rest_length,colour\nb,a,g,cable,1,0.5,red\nc,b,h,strut,2,1.5,blue\n"
    found = converted(tmp_path, table)
    assert [
        (own.name, own.kind, own.EA.tolist(), own.rest_length.tolist()) for own in found.scene.groups
    ] == [
        ("g", "cable", [1.0], [0.5]),
        ("h", "strut", [2.0], [1.5]),
    ]
    assert "the columns 'colour'" in found.lost


def test_the_tables_of_a_scene_are_such_tables(tmp_path):
    from cgff_cli.scene.tables_out import element_table, node_table

    scene = cgff_cli.load(cgff_cli.shipped("prism"))
    found = converted(tmp_path, "".join(element_table(scene)), "".join(node_table(scene)), law="paper")
    assert (
        cgff_cli.to_yaml(found.scene).partition("nodes:")[2] == cgff_cli.to_yaml(scene).partition("nodes:")[2]
    )


def test_every_mistake_of_both_tables_is_told_at_once(tmp_path):
    with pytest.raises(SceneError) as caught:
        converted(tmp_path, "start,end,kind\na,z,cable\na,b,rope\na\n", NODES.replace("5,5", "5,x"), EA=1.0)
    assert [str(own).rpartition("/")[2] for own in caught.value.problems] == [
        "edges.csv:3:5: kind: must be cable or strut, got 'rope'",
        "edges.csv:4:1: this row has 1 cells, the header has 3",
        "nodes.csv:5:8: y: must be a number such as 2.98 or 1e-8, got x",
    ]
    with pytest.raises(SceneError, match=r"edges\.csv:2:3: node 'z' is not defined"):
        converted(tmp_path, "start,end\na,z\n", EA=1.0, kind="cable")
    with pytest.raises(SceneError, match=r"edges\.csv:2:1: node 'a' is joined to itself"):
        converted(tmp_path, "start,end\na,a\n", EA=1.0, kind="cable")
    with pytest.raises(
        SceneError, match=r"edges\.csv:1:1: the first line must name the columns, missing: start"
    ):
        converted(tmp_path, "a,b\nb,c\n", EA=1.0, kind="cable")
    with pytest.raises(OptionError, match="this list of edges needs its nodes: give --nodes"):
        cgff_cli.convert(str(tmp_path / "edges.csv"), law="hooke")


def test_a_group_of_both_kinds_is_two_groups(tmp_path):
    table = "start,end,group,kind\na,b,g,cable\nb,c,g,strut\nc,a,g (strut),cable\n"
    groups = converted(tmp_path, table, EA=1.0).scene.groups
    assert [(own.name, own.kind) for own in groups] == [
        ("g", "cable"),
        ("g (strut)", "strut"),
        ("g (strut) (cable)", "cable"),
    ]
