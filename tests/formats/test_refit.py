"""A result's shape and forces in other elements: it balances as it stands, whatever they are made of."""

import json
from pathlib import Path

import pytest

import cgff_cli
from cgff_cli.formats.convert import convert
from tests.shapes import STRUCTURES

FORM = """\
law: paper
nodes: {a: [0, 0, 0], b: [4, 0, 1], c: [4, 4, 0], d: [0, 4, 1], m: [1, 1, 1], n: [3, 2, 0.5]}
elements:
  ropes: {kind: cable, EA: 5, rest_length: 0, pairs: [[a, m], [d, m], [m, n], [b, n], [c, n]]}
  spare: {kind: cable, EA: 5, rest_length: 9, pairs: [[a, c]]}
supports: {a: xyz, b: xyz, c: xyz, d: xyz}
"""


@pytest.fixture
def form(tmp_path: Path) -> Path:
    """A net found by force densities, with a cable that is slack, as a result in a file."""
    return written(cgff_cli.solve(cgff_cli.loads(FORM), tolerance=1e-13), tmp_path)


def written(result: cgff_cli.Result, folder: Path) -> Path:
    path = folder / "form.json"
    path.write_text(json.dumps(result.to_dict()))
    return path


@pytest.mark.parametrize(("law", "EA"), [("hooke", 30000.0), ("hooke", 1.0), ("paper", 1e4)])
def test_the_shape_stays_and_the_forces_are_those_of_the_result(form: Path, law: str, EA: float):
    before = json.loads(form.read_text())
    scene = convert(str(form), law=law, EA=EA).scene
    again = cgff_cli.solve(cgff_cli.loads(cgff_cli.to_yaml(scene)))
    assert again.counts["iterations"] == 0
    assert again.nodes == before["nodes"]
    assert {own["EA"] for own in again.elements} == {EA}
    forces = [own["force"] for own in before["elements"]]
    assert [own["force"] for own in again.elements] == pytest.approx(forces, rel=1e-9, abs=1e-9)
    assert again.elements[-1]["rest_length"] == pytest.approx(32**0.5)  # of a slack cable: where it stands


def test_struts_may_have_an_ea_of_their_own_and_without_one_elements_keep_theirs(tmp_path: Path):
    path = written(cgff_cli.solve(cgff_cli.load(STRUCTURES / "prism.yaml"), tolerance=1e-13), tmp_path)
    other = convert(str(path), strut_EA=1e5).scene
    solved = cgff_cli.solve(other)
    assert solved.counts["iterations"] == 0
    assert [group.EA[0] == 1e5 for group in other.groups] == [group.kind == "strut" for group in other.groups]


def test_what_has_no_place_or_no_rest_length_is_told(form: Path, tmp_path: Path):
    with pytest.raises(cgff_cli.OptionError, match=r"gives an element of 'ropes' its force, .*larger --EA"):
        convert(str(form), EA=5.0)
    with pytest.raises(cgff_cli.OptionError, match="--kind has no place: a result needs none"):
        convert(str(form), law="hooke", EA=3.0, kind="cable")
    (tmp_path / "form.yaml").write_text(FORM)
    with pytest.raises(cgff_cli.OptionError, match="--EA has no place: a scene or a result needs none"):
        convert(str(tmp_path / "form.yaml"), EA=3.0)
