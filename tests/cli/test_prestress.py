"""`cgff prestress`: where the scene, the page and the record go, and how it ends."""

import json

import pytest
from click.testing import CliRunner

import cgff_cli
from cgff_cli.cli import main
from tests.geometries import geometry, prism, truss, x_module


@pytest.fixture
def shape(tmp_path):
    """Return what writes a geometry to a file."""

    def write(scene, name="shape.yaml"):
        path = tmp_path / name
        path.write_text(cgff_cli.to_yaml(scene))
        return str(path)

    return write


def run(*arguments, **more):
    return CliRunner().invoke(main, ["prestress", *arguments], **more)


CONCAVE = x_module(((0, 0), (1, 0), (0.3, 0.3), (0, 1)))


def test_the_scene_goes_to_standard_output_and_is_in_balance_where_it_begins(shape):
    result = run(shape(prism(3)))
    assert (result.exit_code, result.stderr) == (0, "")
    assert result.stdout.startswith("# in balance with these rest lengths, stable, super-stable, 1 mechanism")
    solved = cgff_cli.solve(cgff_cli.loads(result.stdout))
    assert (solved.verdict, solved.counts["iterations"]) == ("converged", 0)


def test_with_a_file_standard_output_is_left_to_what_is_asked_for(shape, tmp_path):
    path, target = shape(prism(3)), tmp_path / "scene.yaml"
    result = run(path, "-o", str(target))
    assert (result.exit_code, result.stdout) == (0, "")
    assert not cgff_cli.load(target).is_geometry
    record = json.loads(run(path, "-o", str(target), "--format", "json").stdout)
    assert (record["schema"], record["feasible"], record["group_states"]) == ("cgff-prestress/1", True, None)
    assert len(record["forces"]) == len(record["rest_lengths"]) == 12
    page = run(path, "--format", "table").stdout
    assert page.splitlines()[2].startswith("  verdict      in balance with these rest lengths, stable")


def test_standard_input_is_a_scene_and_rest_lengths_that_it_has_are_ignored():
    text = cgff_cli.to_yaml(cgff_cli.new("prism"))
    assert (
        run("-", input=text).stdout == run("-", input=text.replace("rest_length: 1", "rest_length: 2")).stdout
    )


def test_the_impossible_ends_with_5_writes_nothing_and_says_why(shape, tmp_path):
    path, target = shape(CONCAVE), tmp_path / "scene.yaml"
    result = run(path, "-o", str(target))
    assert (result.exit_code, result.stdout, target.exists()) == (5, "", False)
    assert result.stderr.startswith(f"cgff: {path}: impossible: no self-stress has the right signs in all 6")
    record = json.loads(run(path, "--format", "json").stdout)
    assert (record["feasible"], record["forces"], len(record["never"])) == (False, None, 6)
    assert set(record["certificate"]) == {"n0", "n1", "n2", "n3"}


def test_idle_elements_too_many_to_name_are_counted_by_group(shape):
    page = run(shape(cgff_cli.new("net")), "--by-group", "--equal", "force", "--format", "table").stdout
    assert " ".join(page.split()).endswith(" idle all 144 elements")
    square = x_module()
    tail = [(1, 4), *((4 + i, 5 + i) for i in range(10))]
    tailed = geometry(
        [*square.coordinates.tolist(), *([2.0 + i, 0.5] for i in range(11))],
        {own.name: (own.kind, own.pairs.tolist()) for own in square.groups} | {"tail": ("cable", tail)},
    )
    page = run(shape(tailed), "--format", "table").stdout
    assert " ".join(page.split()).endswith(" idle 11 of 17 elements: 11 of 11 in 'tail'")


def test_an_unstable_self_stress_is_written_with_a_warning(shape):
    result = run(shape(prism(7, ring=2)))
    assert result.exit_code == 0
    assert "warning: unstable: this self-stress balances but holds nothing" in result.stderr
    assert result.stdout.startswith("# in balance with these rest lengths, unstable, 9 mechanisms\n")


def test_flags_are_those_of_the_function(shape):
    path = shape(prism(4))
    text = run(path, "--by-group", "--force", "struts=-3").stdout
    assert cgff_cli.loads(text).with_rest_lengths([1.0] * 16).element_count == 16
    found = cgff_cli.prestress(path, by_group=True, force={"struts": 3.0})
    assert cgff_cli.to_yaml(found.scene) in text
    text = run(path, "--by-symmetry", "--equal", "force", "--tolerance", "1e-6", "--format", "json").stdout
    options = json.loads(text)["options"]
    assert (options["by_symmetry"], options["equal"], options["tolerance"]) == (True, "force", 1e-6)


@pytest.mark.parametrize(
    ("flags", "told"),
    [
        (["--force", "struts"], "must be GROUP=VALUE, as in struts=-20, got 'struts'"),
        (["--force", "strut=3"], "unknown group 'strut'; did you mean 'struts'?"),
        (["--tolerance", "2"], "tolerance must be a number between 0 and 1, got 2.0"),
        (["--by-group", "--by-symmetry"], "members share values by group or by symmetry, not by both"),
        (["--force", "struts=-2", "--force", "top=3"], "one force alone sets the level of a self-stress"),
        (["--force", "struts=-2", "--force", "struts=-3"], "--force struts is given twice"),
        (["-o", "-", "--format", "json"], "-o - writes the scene to standard output, and so --format json"),
        (["--equal", "force"], "an equal force needs members that share it"),
        (["-o", "scene.json"], "-o scene.json: the name of a scene must end in .yaml or .yml"),
    ],
)
def test_wrong_usage_ends_with_2(shape, flags, told):
    result = run(shape(prism(3)), *flags)
    assert (result.exit_code, result.stdout) == (2, "")
    assert told in result.stderr


def test_no_file_that_was_read_is_written_over(shape):
    path = shape(prism(3))
    result = run(path, "-o", path)
    assert (result.exit_code, "would be written over" in result.stderr) == (2, True)


def test_an_element_without_length_is_told_at_its_place(shape):
    path = shape(x_module(((0, 0), (0, 0), (1, 1), (0, 1))))
    result = run(path)
    line = cgff_cli.to_yaml(cgff_cli.load(path)).splitlines().index("elements:") + 1
    told = "elements: 'ring: n0-n1' has no length, so that its force has no direction"
    assert (result.exit_code, result.stderr) == (3, f"{path}:{line}:1: {told}\n")


def test_loads_and_supports_stay_in_the_scene(shape):
    again = cgff_cli.loads(run(shape(truss(3, 2.0))).stdout)
    assert (len(again.loads), again.supports) == (3, {0: "xy", 1: "xy"})


def test_the_motion_that_proves_names_no_node_that_stays(shape):
    pushed_up = {
        "law": "paper",
        "nodes": {"l": [0, 0], "m": [1, -0.2], "r": [2, 0]},
        "elements": {"c": {"kind": "cable", "EA": 1000, "pairs": [["l", "m"], ["m", "r"]]}},
        "supports": {"l": "xy", "r": "xy"},
        "loads": {"m": [0.5, 1]},
    }
    result = run(shape(cgff_cli.from_dict(pushed_up)), "--format", "json")
    assert "it moves 'm' the most" in result.stderr
    assert json.loads(result.stdout)["certificate"] == {"l": [0.0, 0.0], "m": [0.0, -1.0], "r": [0.0, 0.0]}
    assert "-0.0" not in result.stdout
