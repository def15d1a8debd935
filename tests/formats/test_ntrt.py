"""NASA NTRT YAML: closed forms, structures of structures counted by hand, every mistake in its place."""

from dataclasses import replace
from math import atan2, dist, pi

import numpy as np
import pytest

import cgff_cli
from cgff_cli.errors import OptionError, SceneError
from tests.formats.folder import FILES

ROD = 1e6
PAIR = """\
nodes: {a: [0, 0, 0], b: [3, 4, 0], c: [0, 0, 2]}
pair_groups:
  rod: [[a, b]]
  string: [[b, c], [c, a]]
"""


def converted(name, **more):
    return cgff_cli.convert(str(FILES / name), **{"strut_EA": ROD, **more})


def written(tmp_path, text, name="own.yaml"):
    (tmp_path / name).write_text(text)
    return str(tmp_path / name)


def string_of(parameters):
    return f"builders: {{string: {{class: tgBasicActuatorInfo, parameters: {{{parameters}}}}}}}\n"


def groups(scene):
    return {group.name: (group.kind, len(group.EA)) for group in scene.groups}


@pytest.mark.parametrize(("p", "degrees"), [(3, 30.0), (4, 45.0)])
def test_a_prism_of_p_rods_comes_to_rest_at_a_twist_of_90_less_180_over_p_degrees(p, degrees):
    found = converted(f"{p}prism.yaml")
    assert groups(found.scene) == {
        "rod": ("strut", p),
        "prism string": ("cable", 2 * p),
        "upright string": ("cable", p),
    }
    result = cgff_cli.solve(found.scene)
    assert (result.verdict, result.analysis["stability"]) == ("converged", "stable")
    X = result.nodes
    low, high = (np.array([X[f"{side}{i + 1}"] for i in range(p)]) for side in ("bottom", "top"))
    axis = high.mean(0) - low.mean(0)
    axis /= np.linalg.norm(axis)
    u, v = low - low.mean(0), high - high.mean(0)
    turns = [
        atan2(axis @ np.cross(a, b), a @ b - (axis @ a) * (axis @ b)) * 180 / pi
        for a, b in zip(u, v, strict=True)
    ]
    assert np.abs(turns) == pytest.approx([degrees] * p, abs=0.01)  # coordinates have three decimals
    held = cgff_cli.prestress(_at_rest(found.scene, result))
    assert (held.feasible, held.self_stress_states, held.super_stable) == (True, 1, True)


def _at_rest(scene, result):
    return replace(scene, coordinates=result.coordinates)


def test_six_rods_come_to_rest_with_force_densities_in_the_ratio_of_minus_three_halves():
    result = cgff_cli.solve(converted("superball.yaml").scene)
    assert result.analysis["stability"] == "stable"
    q = {name: own["force_density"] for name, own in result.groups.items()}
    assert q["muscle"] == pytest.approx([q["muscle"][0]] * 2)
    assert np.array(q["rod"]) / q["muscle"][0] == pytest.approx([-1.5, -1.5])


def test_a_string_is_shorter_at_rest_by_pretension_over_stiffness_and_a_rod_as_long_as_it_stands(tmp_path):
    text = PAIR + string_of("stiffness: 50, pretension: 10")
    rod, string = cgff_cli.convert(written(tmp_path, text), strut_EA=7).scene.groups
    assert (rod.EA.tolist(), rod.rest_length.tolist()) == ([7.0], [5.0])
    assert string.EA.tolist() == [50.0, 50.0]
    assert string.rest_length.tolist() == [29**0.5 - 0.2, 2 - 0.2]


def test_builders_take_pairs_by_all_their_tags_rods_first_and_of_others_the_last(tmp_path):
    text = """\
nodes: {a: [0, 0, 0], b: [1, 0, 0], c: [0, 1, 0]}
pair_groups: {string rod: [[a, b]], long string: [[b, c]], string: [[c, a]], thing: [[a, b], [b, c]]}
builders:
  string: {class: tgBasicActuatorInfo, parameters: {stiffness: 1}}
  long string: {class: tgKinematicActuatorInfo, parameters: {stiffness: 2}}
"""
    found = cgff_cli.convert(written(tmp_path, text), strut_EA=9)
    told = {own.name: (own.kind, own.EA.tolist()) for own in found.scene.groups}
    assert told == {
        "string rod": ("strut", [9.0]),
        "long string": ("cable", [2.0]),
        "string": ("cable", [1.0]),
    }
    assert found.lost == ("2 pairs tagged 'thing', for which there is no builder",)


def test_structures_of_structures_count_and_stand_as_by_hand():
    scene = converted("spine.yaml").scene
    # three prisms of 6 nodes, 3 rods, 6 + 3 strings, and 3 ties between each two neighbours
    assert len(scene.node_names) == 18
    assert groups(scene) == {
        "rod": ("strut", 9),
        "prism string": ("cable", 18),
        "upright string": ("cable", 9),
        "tie string": ("cable", 6),
    }
    X = dict(zip(scene.node_names, scene.coordinates, strict=True))
    assert X["low.bottom1"].tolist() == [5, 0, 0]
    assert X["top.bottom1"].tolist() == [6, 24, 0]  # twice the offset, and a translation
    # turned by 60 degrees about y: x = 5 cos 60, z = -5 sin 60; half as large about its centre; 12 up
    assert X["mid.bottom1"] == pytest.approx([1.25, 14, -2.5 * 3**0.5 / 2], abs=1e-3)
    ties = scene.groups[-1]
    names = [(scene.node_names[a], scene.node_names[b]) for a, b in ties.pairs]
    assert names[0] == ("low.top1", "mid.bottom1")
    assert names[3] == ("mid.top1", "top.bottom1")
    assert ties.rest_length[0] == pytest.approx(dist(X["low.top1"], X["mid.bottom1"]) - 0.8)
    assert [path.rpartition("/")[2] for path in scene.files] == ["spine.yaml", "3prism.yaml"]


def test_a_grandchild_is_named_by_its_path_or_alone_where_no_other_has_its_name(tmp_path):
    written(tmp_path, "nodes: {p: [0, 0, 0], q: [1, 0, 0]}\npair_groups: {string: [[p, q]]}\n", "leaf.yaml")
    written(tmp_path, "nodes: {r: [0, 1, 0]}\nsubstructures: {leaf: {path: leaf.yaml}}\n", "limb.yaml")
    text = """\
substructures: {a/b: {path: limb.yaml, offset: [0, 0, 3]}}
bond_groups:
  a/b/node_node: {string: [[r, leaf.p]]}
pair_groups: {string: [[a.leaf.p, b.leaf.p], [b.r, b.leaf.q]]}
"""
    scene = cgff_cli.convert(written(tmp_path, text)).scene
    names = {
        frozenset(scene.node_names[row] for row in pair) for group in scene.groups for pair in group.pairs
    }
    assert {frozenset(("a.r", "b.leaf.p")), frozenset(("b.r", "b.leaf.q"))} < names
    assert len(names) == 5
    with pytest.raises(SceneError) as caught:
        cgff_cli.convert(written(tmp_path, text.replace("[a.leaf.p,", "[r,")))
    assert "node 'r' may be each of 'a.r', 'b.r'; write which" in str(caught.value)


def test_rotation_about_no_point_is_about_the_centre_of_the_structure(tmp_path):
    written(tmp_path, "nodes: {p: [0, 0, 0], q: [2, 0, 0]}\npair_groups: {string: [[p, q]]}\n", "bar.yaml")
    text = "substructures: {s: {path: bar.yaml, rotation: {axis: [0, 0, 2], angle: 90}}}\n"
    assert cgff_cli.convert(written(tmp_path, text)).scene.coordinates == pytest.approx(
        np.array([[1, -1, 0], [1, 1, 0]])
    )


def test_rods_have_no_stiffness_in_the_file_so_it_is_asked_for():
    with pytest.raises(OptionError, match=r"^rods are rigid in NTRT: give their stiffness by --strut-EA"):
        cgff_cli.convert(str(FILES / "3prism.yaml"))


def test_rods_that_share_a_node_are_said_to_be_welded_there(tmp_path):
    text = PAIR.replace("rod: [[a, b]]", "rod: [[a, b], [a, c]]").replace(", [c, a]", "")
    found = cgff_cli.convert(written(tmp_path, text), strut_EA=1)
    assert found.lost == ("the welds of rods that share a node, pinned here: 'a'",)


WRONG = """\
nodes:
  a: [0, 0, 0]
  b: [1, 0, x]
  c: [1, 0]
  d.e: [0, 1, 0]
pair_groups:
  string:
    - [a, f]
    - [a, a]
    - [a, b, c]
    - oops
builders:
  ball: {class: tgSphereInfo}
  rod: {parameters: {radius: 1}}
  string: {class: tgBasicActuatorInfo, parameters: {stifness: 5, pretension: -1}}
substructures:
  s/t: {path: nowhere.yaml, rotation: {axis: [0, 0, 0], angle: 9}, shift: [1, 1, 1]}
  u: {scale: 2}
bond_groups:
  string:
    s/t/node_edge:
      - [a, b/c]
    s/node_node: [[a, a]]
    s/t/knot: [[a, a]]
colour: red
nodes: {}
"""


def test_every_mistake_is_told_at_once_at_its_place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    written(tmp_path, WRONG)
    with pytest.raises(SceneError) as caught:
        cgff_cli.convert("own.yaml", strut_EA=1)
    text = str(caught.value)
    for line in (
        "own.yaml:3:13: nodes.b[2]: must be a number such as 2.98 or 1e-8, got x",
        "own.yaml:4:6: nodes.c: must be a list of 3 numbers",
        "own.yaml:5:3: nodes: the name 'd.e' may not contain . or /",
        "own.yaml:8:11: pair_groups.string[0][1]: node 'f' is not defined",
        "own.yaml:9:7: pair_groups.string[1]: node 'a' is joined to itself",
        "own.yaml:10:7: pair_groups.string[2]: must be two node names, got 3",
        "own.yaml:11:7: pair_groups.string[3]: must be two node names such as [a, b], got oops",
        "own.yaml:13:17: builders.ball.class: no builder of class 'tgSphereInfo' can be converted",
        "own.yaml:14:3: builders.rod: missing key 'class'",
        "own.yaml:15:53: builders.string.parameters: unknown parameter 'stifness'; did you mean",
        "own.yaml:15:78: builders.string.parameters.pretension: must be >= 0, got -1",
        "own.yaml:17:15: substructures.'s/t'.path: cannot read 'nowhere.yaml': no such file",
        "own.yaml:17:46: substructures.'s/t'.rotation.axis: must not be zero in all directions",
        "own.yaml:17:68: substructures.'s/t': unknown key 'shift'",
        "own.yaml:18:3: substructures: substructure 'u' has no path",
        "own.yaml:21:5: bond_groups.string: node_edge: a node tied into the middle of a string",
        "own.yaml:23:5: bond_groups.string: a bond joins two or more structures",
        "own.yaml:24:5: bond_groups.string: must end in /node_node, got 's/t/knot'",
        "own.yaml:25:1: unknown key 'colour'",
        "own.yaml:26:1: duplicate key 'nodes'; first on line 1",
    ):
        assert line in text, (line, text)
    assert len(caught.value.problems) == 20, text


def test_what_is_wrong_in_a_substructure_is_placed_in_its_own_file(tmp_path):
    written(tmp_path, "nodes: {p: [0, 0]}\n", "leaf.yaml")
    top = written(tmp_path, "substructures: {a/b: {path: leaf.yaml}}\n")
    with pytest.raises(SceneError) as caught:
        cgff_cli.convert(top)
    assert [str(own).rpartition("/")[2] for own in caught.value.problems] == [
        "leaf.yaml:1:12: nodes.p: must be a list of 3 numbers in this 3-D scene, got a list of 2"
    ]


def test_a_string_that_pretension_leaves_no_length_is_refused_at_its_pair(tmp_path):
    text = PAIR + string_of("stiffness: 1, pretension: 3")
    with pytest.raises(SceneError) as caught:
        cgff_cli.convert(written(tmp_path, text), strut_EA=1)
    assert str(caught.value).endswith(
        "own.yaml:4:20: pair_groups.string[1]: pretension 3 over stiffness 1 shortens it by 3, "
        "and it is 2 long: no rest length is left"
    )


def test_files_that_hold_themselves_or_multiply_beyond_measure_are_refused(tmp_path):
    own = written(tmp_path, "substructures: {a: {path: own.yaml}}\n")
    with pytest.raises(SceneError, match="holds itself"):
        cgff_cli.convert(own)
    written(tmp_path, "nodes: {p: [0, 0, 0]}\n", "0.yaml")
    for level in range(1, 10):
        names = "/".join(f"s{i}" for i in range(20))
        written(tmp_path, f"substructures: {{{names}: {{path: {level - 1}.yaml}}}}\n", f"{level}.yaml")
    with pytest.raises(SceneError, match="stand for more than 300000 structures, nodes and pairs"):
        cgff_cli.convert(written(tmp_path, "substructures: {a: {path: 9.yaml}}\n"))


@pytest.mark.parametrize("tags", ["a", "b", "a/b", "b string", "a/b b a"])
def test_a_bond_has_the_names_of_what_it_joins_as_tags_too(tmp_path, tags):
    written(tmp_path, "nodes: {p: [0, 0, 0], q: [1, 0, 0]}\npair_groups: {string: [[p, q]]}\n", "bar.yaml")
    text = f"""\
substructures: {{a/b: {{path: bar.yaml, offset: [0, 1, 0]}}}}
bond_groups: {{string: {{a/b/node_node: [[p, p]]}}}}
builders: {{{tags}: {{class: tgBasicActuatorInfo, parameters: {{stiffness: 7}}}}}}
"""
    (group,) = cgff_cli.convert(written(tmp_path, text)).scene.groups
    assert group.EA.tolist() == [1000.0, 1000.0, 7.0]
