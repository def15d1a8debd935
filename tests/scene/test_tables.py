"""Nodes and elements from CSV files beside the scene."""

import time

import pytest

import cgff_cli

INLINE = """\
law: hooke
nodes:
  a: [0, 0.5, 1e-3]
  b: [1, 0, 0]
  c: [0, 1, 0]
elements:
  ring: {kind: cable, EA: [1, 2], rest_length: [0.5, 0.75], pairs: [[a, b], [c, a]]}
  bar: {kind: strut, EA: 3, rest_length: 1, pairs: [[b, c]]}
supports: {a: xyz}
"""
NODES = "name,x,y,z\na,0,0.5,1e-3\nb,1,0,0\nc,0,1,0\n"
ELEMENTS = """\
start,end,group,kind,EA,rest_length
a,b,ring,cable,1,0.5
b,c,bar,strut,3,1
c,a,ring,cable,2,0.75
"""
SCENE = "law: hooke\nnodes: nodes.csv\nelements: tables/elements.CSV\nsupports: {a: xyz}\n"


@pytest.fixture
def scene_of(tmp_path):
    def write(nodes=NODES, elements=ELEMENTS, scene=SCENE):
        (tmp_path / "tables").mkdir(exist_ok=True)
        (tmp_path / "nodes.csv").write_bytes(nodes.encode())
        (tmp_path / "tables" / "elements.CSV").write_bytes(elements.encode())
        path = tmp_path / "scene.yaml"
        path.write_text(scene)
        return cgff_cli.load(path)

    return write


def test_tables_say_the_same_as_a_scene_file(scene_of, assert_same):
    assert_same(scene_of(), cgff_cli.loads(INLINE, "scene.yaml"))


def test_columns_may_stand_in_any_order(scene_of, assert_same):
    swapped = "\n".join(",".join(reversed(line.split(","))) for line in ELEMENTS.splitlines())
    assert_same(scene_of(elements=swapped), scene_of())


@pytest.mark.parametrize(
    "disguise",
    [
        lambda text: "\ufeff" + text,
        lambda text: text.replace("\n", "\r\n"),
        lambda text: "\n  \n" + text.replace("\n", "\n\n"),
        lambda text: text.replace(",", " , "),
        lambda text: "\n".join(
            ",".join(f'"{cell}"' for cell in line.split(",")) for line in text.splitlines()
        ),
        lambda text: text.rstrip("\n"),
    ],
    ids=["byte order mark", "windows", "blank lines", "spaces", "quotes", "no last line end"],
)
def test_what_spreadsheets_add_does_not_matter(disguise, scene_of, assert_same):
    assert_same(scene_of(nodes=disguise(NODES), elements=disguise(ELEMENTS)), scene_of())


def test_a_table_without_z_is_a_plane_scene(scene_of):
    scene = scene_of(nodes="y,name,x\n5,a,0\n0,b,1\n1,c,0\n", scene=SCENE.replace("xyz", "xy"))
    assert scene.coordinates.tolist() == [[0, 5], [1, 0], [0, 1]]


def test_a_comma_in_quotes_belongs_to_the_name_and_counts_in_columns(scene_of):
    nodes = NODES.replace("a,", '"a,1",')
    elements = ELEMENTS.replace("a,b", '"a,1",b').replace("c,a", 'c,"a,1"')
    scene = scene_of(nodes, elements, SCENE.replace("a: xyz", '"a,1": xyz'))
    assert scene.node_names == ("a,1", "b", "c")
    with pytest.raises(cgff_cli.SceneError, match=r"nodes\.csv:2:9: y: must be a number such as 2.98"):
        scene_of(nodes.replace("0.5", "half"), elements)


def test_a_group_is_of_one_kind(scene_of):
    with pytest.raises(cgff_cli.SceneError) as caught:
        scene_of(elements=ELEMENTS.replace("ring,cable,2", "ring,strut,2"))
    assert str(caught.value).endswith("elements.CSV:4:10: group 'ring' is of kind cable above, here strut")


def test_one_wrong_cell_among_many_is_found_in_time(scene_of):
    count = 30_000
    nodes = "name,x,y\n" + "".join(f"n{i},{i},0\n" for i in range(count))
    elements = "start,end,group,kind,EA,rest_length\n" + "".join(
        f"n{i},n{i + 1},chain,cable,1,1\n" for i in range(count - 1)
    )
    scene = SCENE.replace("supports: {a: xyz}\n", "")
    start = time.perf_counter()
    assert scene_of(nodes, elements, scene).element_count == count - 1
    with pytest.raises(cgff_cli.SceneError) as caught:
        scene_of(nodes.replace("n20000,20000", "n20000,1_0"), elements, scene)
    assert str(caught.value).endswith("nodes.csv:20002:8: x: must be a number such as 2.98 or 1e-8, got 1_0")
    assert time.perf_counter() - start < 5.0
