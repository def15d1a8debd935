"""BYU TensegritySim YAML: stiffness is EA under law `paper`; what a scene cannot say is refused by name."""

import pytest

import cgff_cli
from cgff_cli.errors import SceneError
from tests.formats.folder import FILES


def converted(tmp_path, text):
    (tmp_path / "own.yaml").write_text(text)
    return cgff_cli.convert(str(tmp_path / "own.yaml"))


def test_a_square_on_crossed_bars_has_cables_of_95_percent_and_supports_where_it_is_pinned():
    found = cgff_cli.convert(str(FILES / "xframe.yaml"))
    scene = found.scene
    strings, bars = scene.groups
    assert (scene.law, scene.dimension) == ("paper", 2)
    assert (strings.kind, strings.EA.tolist(), strings.rest_length.tolist()) == (
        "cable",
        [100.0] * 4,
        [0.95] * 4,
    )
    assert (bars.kind, bars.EA.tolist(), bars.rest_length.tolist()) == ("strut", [1e4] * 2, [2**0.5] * 2)
    assert {scene.node_names[row]: axes for row, axes in scene.supports.items()} == {"a": "xy", "d": "y"}
    assert found.lost == ("control: which strings change their length, and when",)


def test_the_crossed_square_carries_bar_forces_of_minus_the_root_of_two_times_its_strings():
    result = cgff_cli.solve(cgff_cli.convert(str(FILES / "xframe.yaml")).scene)
    q = {name: own["force_density"] for name, own in result.groups.items()}
    assert q["bars"] == pytest.approx([-q["strings"][0]] * 2)


def test_a_pretension_gives_the_rest_length_too(tmp_path):
    text = (FILES / "xframe.yaml").read_text().replace("initial_length_ratio: 0.95", "pretension: 20")
    assert converted(tmp_path, text).scene.groups[0].rest_length.tolist() == [0.8] * 4


def test_one_node_in_the_plane_makes_all_plane_and_that_is_said(tmp_path):
    found = converted(tmp_path, (FILES / "xframe.yaml").read_text().replace("b: [0, 1]", "b: [0, 1, 7]"))
    assert found.scene.dimension == 2
    assert "the third coordinate of 1 node: others have two" in found.lost


WRONG = """\
nodes: {a: [0, 0, 0], b: [0, 1, 0], c: [1, 0, 0]}
connections:
  strings:
    - long: [a, b, c]
    - [a, z]
    - [b, b]
    - 7
  wires: [[a, b]]
  ties: [[a, b]]
builders:
  strings: {stiffness: -1, type: rope}
  ties: {stiffness: 1, type: string, pretension: 1}
pin:
  q: [True, True, True]
  a: [True, maybe, False]
surface: {cylinder: {radius: 3}}
"""


def test_every_mistake_is_told_at_once_at_its_place(tmp_path):
    with pytest.raises(SceneError) as caught:
        converted(tmp_path, WRONG)
    assert [str(own).partition("own.yaml")[2] for own in caught.value.problems] == [
        ":4:13: connections.strings[0].long: a string over 3 nodes "
        "has one force all along, which a scene cannot say",
        ":5:11: connections.strings[1][1]: node 'z' is not defined; defined: 'a', 'b', 'c'",
        ":6:7: connections.strings[2]: must join two different nodes",
        ":7:7: connections.strings[3]: must be two node names such as [a, b], got 7",
        ":8:3: connections: 'wires' has no builder of its name",
        ":9:10: connections.ties[0]: pretension 1 over stiffness 1 shortens it by 1, and it is 1 long: "
        "no rest length is left",
        ":11:24: builders.strings.stiffness: must be > 0, got -1",
        ":11:34: builders.strings.type: must be bar or string, got rope",
        ":14:3: pin: node 'q' is not defined; defined: 'a', 'b', 'c'",
        ":15:6: pin.a: must be three booleans such as [True, True, False], got a list of 3",
        ":16:1: surface: a structure wrapped round a cylinder cannot be converted",
    ]


def test_a_rest_length_is_said_once(tmp_path):
    text = (FILES / "xframe.yaml").read_text().replace("0.95}", "0.95, pretension: 3}")
    with pytest.raises(SceneError, match="both say the rest length; give one"):
        converted(tmp_path, text)
