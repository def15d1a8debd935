"""What a scene file may say and how it is understood."""

import io
import json
import sys
import time
from itertools import pairwise

import numpy as np
import pytest
import yaml

import cgff_cli
from cgff_cli.scene.physics import component_labels
from cgff_cli.scene.read import from_dict

TRIANGLE = {
    "law": "paper",
    "nodes": {"a": [0, 0, 0], "b": [1, 0, 0], "c": [0, 1, 0]},
    "elements": {
        "ring": {
            "kind": "cable",
            "EA": 100,
            "rest_length": 0.9,
            "pairs": [["a", "b"], ["b", "c"], ["c", "a"]],
        }
    },
}

PRISM = """\
name: Triangular prism, Table IV
law: paper                  # force = EA (l - l0)
nodes:
  b1: [1.80, 0.05, 0.0]
  b2: [-.43, 1e-8, 2e5]
  t1: [+1, 010, 1.]
elements:
  ring:
    kind: cable
    EA: 100.0
    rest_length: [2.98, 1, 3]
    pairs: [[b1, b2], [b2, t1], [t1, b1]]
  posts:
    kind: strut
    EA: [1e3]
    rest_length: 0
    pairs:
      - [b1, t1]
supports: {b1: zxy, b2: z}
loads: {t1: [0, 0, -0.5]}
solver: {tolerance: 1e-12, max_iterations: 50, method: table1}
"""


def scene_with(**changes):
    return from_dict({**TRIANGLE, **changes})


def with_number(text):
    """Return the coordinate a text is read as."""
    scene = cgff_cli.loads(
        f"law: paper\nnodes:\n  a: [{text}, 0]\n  b: [1, 0]\n"
        "elements:\n  e: {kind: strut, EA: 1, rest_length: 1, pairs: [[a, b]]}\n"
    )
    return scene.coordinates[0, 0]


def named(name):
    """Return the node names of a scene that writes one of them so."""
    return cgff_cli.loads(
        f"law: paper\nnodes:\n  {name}: [0, 0]\n  b: [1, 0]\n"
        f"elements:\n  e: {{kind: strut, EA: 1, rest_length: 1, pairs: [[{name}, b]]}}\n"
        f"supports: {{{name}: xy}}\n"
    ).node_names


def test_a_scene_file_becomes_columns():
    scene = cgff_cli.loads(PRISM, "dir/prism.yaml")
    assert (scene.name, scene.law, scene.path) == ("Triangular prism, Table IV", "paper", "dir/prism.yaml")
    assert scene.node_names == ("b1", "b2", "t1")
    assert scene.coordinates.tolist() == [[1.8, 0.05, 0.0], [-0.43, 1e-8, 2e5], [1.0, 10.0, 1.0]]
    ring, posts = scene.groups
    assert (ring.name, ring.kind, posts.name, posts.kind) == ("ring", "cable", "posts", "strut")
    assert ring.pairs.tolist() == [[0, 1], [1, 2], [2, 0]]
    assert ring.EA.tolist() == [100.0, 100.0, 100.0]
    assert ring.rest_length.tolist() == [2.98, 1.0, 3.0]
    assert posts.pairs.tolist() == [[0, 2]]
    assert posts.rest_length.tolist() == [0.0]
    assert scene.supports == {0: "xyz", 1: "z"}
    assert scene.loads == {2: (0.0, 0.0, -0.5)}
    assert scene.solver == {"tolerance": 1e-12, "max_iterations": 50, "method": "table1"}


def test_a_scene_without_a_name_is_called_after_its_file(tmp_path):
    path = tmp_path / "small.net.yaml"
    path.write_text(PRISM.split("\n", 1)[1])
    assert cgff_cli.load(path).name == "small.net"


@pytest.mark.parametrize("word", ["", "~", "null"])
def test_optional_blocks_with_nothing_in_them_count_as_left_out(word):
    lines = [f"{key}: {word}" for key in ("name", "supports", "loads", "solver")]
    scene = cgff_cli.loads(json_as_yaml(TRIANGLE) + "\n".join(lines) + "\n", "triangle.yaml")
    assert (scene.name, scene.supports, scene.loads, scene.solver) == ("triangle", {}, {}, {})


def json_as_yaml(values):
    return "".join(f"{key}: {json.dumps(value)}\n" for key, value in values.items())


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("1e-8", 1e-8),
        ("2e5", 2e5),
        ("-.43", -0.43),
        ("+1", 1.0),
        ("010", 10.0),
        ("1.", 1.0),
        (".5E+2", 50.0),
        ("-0", 0.0),
        ("1e-400", 0.0),
        ("0.1000000000000000055511151231257827", 0.1),
    ],
)
def test_what_an_engineer_writes_as_a_number_is_one(text, number):
    assert with_number(text) == number


@pytest.mark.parametrize(
    "name", ["no", "on", "y", "1", "1:30", "010", "1e3", "null", "true", ".nan", "0x1F", "top-1", "Ü1"]
)
def test_any_plain_word_can_name_a_node(name):
    assert named(name) == (name, "b")


@pytest.mark.parametrize(
    "name", ["<<", "a b", "a: b", "#1", "[1]", "'", "- x", """ "x" """, "!!float", "*x", "塔"]
)
def test_any_quoted_text_can_name_a_node(name):
    assert named(json.dumps(name, ensure_ascii=False)) == (name, "b")


def test_names_are_plain_str_so_that_nothing_of_the_reader_leaks():
    scene = cgff_cli.loads(PRISM)
    texts = [scene.name, scene.law, *scene.node_names, *(group.name for group in scene.groups)]
    texts += [
        *(group.kind for group in scene.groups),
        *scene.supports.values(),
        *scene.solver,
        scene.solver["method"],
    ]
    assert {type(text) for text in texts} == {str}


def test_an_alias_repeats_a_value():
    group = "{kind: cable, EA: *stiff, rest_length: *lengths, pairs: [[b1, b2], [b2, t1], [t1, b1]]}"
    text = PRISM.replace("[2.98, 1, 3]", "&lengths [2.98, 1, 3]").replace("100.0", "&stiff [1, 2, 3]")
    text = text.replace("  posts:", f"  again: {group}\n  posts:")
    again = cgff_cli.loads(text).groups[1]
    assert again.EA.tolist() == [1, 2, 3]
    assert again.rest_length.tolist() == [2.98, 1, 3]


@pytest.mark.parametrize("loader", ["CSafeLoader", "SafeLoader"])
def test_json_yaml_and_python_say_the_same(loader, monkeypatch, assert_same):
    if loader == "SafeLoader":
        monkeypatch.delattr(yaml, "CSafeLoader", raising=False)
    values = {
        **TRIANGLE,
        "supports": {"a": "xyz"},
        "loads": {"b": [0, 0, 1e-8]},
        "solver": {"tolerance": 1e-8},
    }
    from_json = cgff_cli.loads(json.dumps(values))
    assert_same(from_json, cgff_cli.loads(json_as_yaml(values)))
    assert_same(from_json, from_dict(values), but=("name",))


def test_json_of_every_layout_reads_alike(assert_same):
    compact = json.dumps(TRIANGLE, separators=(",", ":"))
    tabbed = json.dumps(TRIANGLE, indent="\t")
    assert_same(cgff_cli.loads(compact), cgff_cli.loads(tabbed))


def test_a_flow_mapping_that_is_not_json_is_yaml():
    text = (
        "{law: paper, nodes: {a: [0, 0], b: [1, 0]}, "
        "elements: {e: {kind: strut, EA: 1, rest_length: 1, pairs: [[a, b]]}}}"
    )
    assert cgff_cli.loads(text).node_names == ("a", "b")


def test_whole_numbers_in_json_pairs_are_names():
    values = {
        "law": "hooke",
        "nodes": {"1": [0, 0], "2": [1, 0]},
        "elements": {"bar": {"kind": "strut", "EA": 1, "rest_length": 1, "pairs": [[1, 2]]}},
    }
    assert cgff_cli.loads(json.dumps(values)).groups[0].pairs.tolist() == [[0, 1]]
    assert from_dict(values).groups[0].pairs.tolist() == [[0, 1]]


def test_numpy_values_are_welcome_from_python(assert_same):
    values = {
        **TRIANGLE,
        "nodes": {name: np.array(point, dtype=np.float32) for name, point in TRIANGLE["nodes"].items()},
        "elements": {
            "ring": {
                "kind": np.str_("cable"),
                "EA": np.int64(100),
                "rest_length": np.full(3, 0.9),
                "pairs": (("a", "b"), ("b", "c"), ("c", "a")),
            }
        },
        "solver": {"max_iterations": np.int64(7)},
    }
    assert_same(from_dict(values), scene_with(solver={"max_iterations": 7}))


def test_python_values_are_refused_like_those_of_a_file():
    with pytest.raises(cgff_cli.SceneError) as caught:
        scene_with(nodes={"a": [0, 0, float("nan")], "b": [True, None, 10**400], "c": [0, 0, object()]})
    assert str(caught.value).split("\n") == [
        "<python>: nodes.a[2]: must be a finite number, got nan",
        "<python>: nodes.b[0]: must be a number, got True",
        "<python>: nodes.b[1]: must be a number, got nothing",
        "<python>: nodes.b[2]: must not exceed 1e30 in size, got a huge number",
        "<python>: nodes.c[2]: must be a number, got a value of type object",
    ]


def test_a_load_of_no_numbers_is_refused_where_no_node_tells_the_dimension_too():
    with pytest.raises(cgff_cli.SceneError) as caught:
        scene_with(nodes=3, loads={"a": []})
    assert str(caught.value).split("\n")[0] == (
        "<python>: loads.a: must be a list of 2 or 3 numbers, got an empty list"
    )


def test_a_python_list_that_holds_itself_is_refused():
    ring = []
    ring.append(ring)
    with pytest.raises(cgff_cli.SceneError, match="nested deeper than 40 levels"):
        scene_with(loads=ring)


def test_a_byte_order_mark_and_windows_line_ends_do_not_matter(tmp_path, assert_same):
    path = tmp_path / "windows.yaml"
    path.write_bytes(b"\xef\xbb\xbf" + PRISM.replace("\n", "\r\n").encode())
    assert_same(cgff_cli.load(path), cgff_cli.loads(PRISM))
    assert_same(cgff_cli.loads("\ufeff" + PRISM), cgff_cli.loads(PRISM))
    assert cgff_cli.loads("\ufeff" + json.dumps(TRIANGLE), "triangle.json").name == "triangle"


def test_a_dash_reads_standard_input(monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(json_as_yaml(TRIANGLE).encode())))
    scene = cgff_cli.load("-")
    assert (scene.path, scene.name) == ("<stdin>", "stdin")


def test_a_plane_scene_has_two_axes():
    scene = cgff_cli.loads(
        "law: hooke\nnodes: {a: [0, 0], b: [1, 0]}\nsupports: {a: yx}\n"
        "elements: {e: {kind: strut, EA: 1, rest_length: 1, pairs: [[a, b]]}}\n"
    )
    assert scene.dimension == 2
    assert scene.supports == {0: "xy"}


def test_tiny_coordinates_are_harmless_and_stay():
    assert with_number("1e-200") == 1e-200


@pytest.mark.parametrize(
    ("changes", "warning"),
    [
        (
            {
                "elements": {
                    **TRIANGLE["elements"],
                    "tie": {"kind": "strut", "EA": 1, "rest_length": 1, "pairs": [["b", "a"]]},
                }
            },
            "1 pair of nodes is joined by more than one element: a-b (in ring, tie)",
        ),
        (
            {"nodes": {**TRIANGLE["nodes"], "d": [9, 9, 9]}, "supports": {"d": "x"}},
            "no element joins 'd'",
        ),
        (
            {"supports": {"a": "xyz", "b": "xyz", "c": "xyz"}},
            "every direction of every node is held, so nothing can move",
        ),
        (
            {"gravity": [0, 0, -9.81]},
            "gravity is a direction, its size 9.81 counts for nothing: weight is a force per rest length, "
            "not a mass",
        ),
        (
            {
                "nodes": {**TRIANGLE["nodes"], "d": [9, 9, 9], "e": [8, 8, 8]},
                "elements": {
                    **TRIANGLE["elements"],
                    "far": {"kind": "strut", "EA": 1, "rest_length": 1, "pairs": [["d", "e"]]},
                },
            },
            "no element joins the 2 parts of this structure; the smallest: 'd', 'e'",
        ),
    ],
)
def test_what_is_legal_but_seldom_meant_draws_a_warning(changes, warning):
    assert scene_with().warnings == ()
    assert scene_with(gravity=[0, 0, -2]).warnings == ()
    assert scene_with(**changes).warnings == (warning,)


def test_parts_are_numbered_by_their_first_node_however_many_there_are():
    few = np.array([[5, 3], [4, 1], [3, 2]])
    assert component_labels(7, few).tolist() == [0, 1, 2, 2, 1, 2, 3]
    many = np.tile(few, (2000, 1))
    assert component_labels(7, many).tolist() == [0, 1, 2, 2, 1, 2, 3]


@pytest.mark.parametrize("extra", [0, 6000])
def test_loads_must_balance_on_a_free_part_of_any_size(extra):
    chain = [f"n{i}" for i in range(extra)]
    values = {
        **TRIANGLE,
        "nodes": {**TRIANGLE["nodes"], **{name: [i, 1, 1] for i, name in enumerate(chain)}},
        "supports": dict.fromkeys(chain[:1], "xyz"),
    }
    pairs = [*TRIANGLE["elements"]["ring"]["pairs"], *map(list, pairwise(chain))]
    values["elements"] = {"ring": {**TRIANGLE["elements"]["ring"], "pairs": pairs}}
    from_dict({**values, "loads": {"a": [0, 0, 0.1], "b": [0, 0, 0.2], "c": [0, 0, -0.3]}})
    with pytest.raises(
        cgff_cli.SceneError, match=r"along z on the part with nodes 'a', 'b', 'c' add up to 0.01,"
    ):
        from_dict({**values, "loads": {"a": [0, 0, 0.1], "b": [0, 0, 0.2], "c": [0, 0, -0.29]}})


def test_a_support_along_the_load_balances_it():
    assert scene_with(loads={"b": [0, 0, -1]}, supports={"a": "z"}).loads == {1: (0.0, 0.0, -1.0)}


@pytest.mark.parametrize("indent", [None, 1])
def test_a_mistake_in_json_is_found_where_it_stands_behind_whatever(indent):
    values = {
        **TRIANGLE,
        "name": 'brackets ]}{[ and \\" in "quotes"',
        "supports": {"a": "x", "b": "y"},
        "loads": {"a": [1, 0, 0], "b": [-1e0, True, 10**40]},
    }
    text = json.dumps(values, indent=indent)
    with pytest.raises(cgff_cli.SceneError) as caught:
        cgff_cli.loads(text, "scene.json")
    found = [(problem.line, problem.column, problem.message) for problem in caught.value.problems]
    places = [text.index("true"), text.index("1" + 40 * "0")]
    lines = [text.count("\n", 0, at) + 1 for at in places]
    assert found == [
        (line, at - text.rfind("\n", 0, at), message)
        for line, at, message in zip(
            lines,
            places,
            [
                "loads.b[1]: must be a number such as 2.98 or 1e-8, got true",
                "loads.b[2]: must not exceed 1e30 in size, got 1" + 40 * "0",
            ],
            strict=True,
        )
    ]


def test_one_mistake_in_a_large_json_scene_takes_about_as_long_as_reading_it():
    nodes = {f"n{i}": [i / 3, i / 7, 1.0] for i in range(50_000)}
    nodes["n40000"] = [None, 0, 0]
    pairs = [[f"n{i}", f"n{i + 1}"] for i in range(49_999)]
    ring = {"kind": "cable", "EA": 1.0, "rest_length": 1.5, "pairs": pairs}
    text = json.dumps({"law": "hooke", "nodes": nodes, "elements": {"ring": ring}})
    start = time.process_time()
    with pytest.raises(cgff_cli.SceneError) as caught:
        cgff_cli.loads(text, "scene.json")
    assert time.process_time() - start < 2.0
    column = text.index("null") + 1
    message = "nodes.n40000[0]: must be a number such as 2.98 or 1e-8, got null"
    assert str(caught.value) == f"scene.json:1:{column}: {message}"


def test_many_mistakes_in_json_are_found_in_one_walk():
    nodes = {f"n{i}": ["1", i, 1.0] for i in range(5000)}
    pairs = [[f"n{i}", f"m{i + 1}"] for i in range(4999)]
    ring = {"kind": "cable", "EA": -1.0, "rest_length": [-1.5] * 4999, "pairs": pairs}
    text = json.dumps({"law": "hooke", "nodes": nodes, "elements": {"ring": ring}})
    start = time.process_time()
    with pytest.raises(cgff_cli.SceneError, match="more problems, the last one here"):
        cgff_cli.loads(text, "scene.json")
    assert time.process_time() - start < 3.0


def test_a_large_json_scene_reads_in_about_a_second():
    nodes = {f"n{i}": [i / 3, i / 7, 1.0] for i in range(50_000)}
    names = list(nodes)
    pairs = [[names[i], names[i + step]] for step in (1, 2) for i in range(50_000 - step)]
    ring = {"kind": "cable", "EA": 1.0, "rest_length": [1.5] * len(pairs), "pairs": pairs}
    text = json.dumps({"law": "hooke", "nodes": nodes, "elements": {"ring": ring}})
    start = time.perf_counter()
    scene = cgff_cli.loads(text)
    assert time.perf_counter() - start < 3.0
    assert scene.element_count == 99_997
