"""`cgff analyse`: scenes, results and geometries; formats, exit codes, words."""

import json
from dataclasses import replace
from pathlib import Path

import pytest

import cgff_cli
from cgff_cli import pipeline
from cgff_cli.as_given import MODES
from tests.cli.conftest import Run

GEOMETRY = """\
law: hooke
nodes: {a: [0, 0], b: [4, 0], c: [0, 3]}
elements:
  ring: {kind: cable, EA: 10, pairs: [[a, b], [b, c]]}
  bar: {kind: strut, EA: 20, pairs: [[c, a]]}
"""
COLUMN = """\
law: paper
nodes: {foot: [0, 0], head: [0, 2], left: [-1, 2], right: [1, 2]}
elements:
  column: {kind: strut, EA: 1000, rest_length: 2.003, pairs: [[foot, head]]}
  springs: {kind: strut, EA: 3, rest_length: 1, pairs: [[left, head], [right, head]]}
supports: {foot: xy, left: xy, right: xy}
loads: {head: [0, -3]}
"""
FIELDS = [
    *("schema", "tool", "scene", "balanced", "message", "warnings", "residual", "groups", "analysis"),
    "sensitivity",
]


@pytest.fixture
def solved(run: Run) -> str:
    """Solve the prism and return the path of its result."""
    assert run("solve", "prism.yaml", "-o", "prism.json").exit_code == 0
    return "prism.json"


def test_a_result_is_judged_at_its_coordinates_as_in_the_solve(run: Run, solved: str):
    ended = run("analyse", solved)
    found, result = json.loads(ended.stdout), json.loads(Path(solved).read_text())
    assert (ended.exit_code, ended.stderr) == (0, "")
    assert list(found) == FIELDS
    assert (found["schema"], found["scene"]["name"]) == ("cgff-analysis/1", result["scene"]["name"])
    assert found["groups"]["struts"]["count"] == 3
    for name in ("stable", "super_stable", "self_stress_states", "mechanisms", "nullity_D", "parts"):
        assert found["analysis"][name] == result["analysis"][name]
    assert found["analysis"]["smallest_stiffness"] == pytest.approx(result["analysis"]["smallest_stiffness"])


def test_nothing_is_solved(run: Run, solved: str, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.delattr(pipeline, "solve")
    assert run("analyse", solved).exit_code == 0


def test_a_scene_out_of_balance_is_4_and_analysed_all_the_same(run: Run):
    ended = run("analyse", "prism.yaml")
    found = json.loads(ended.stdout)
    assert ended.exit_code == 4
    assert ended.stderr.splitlines()[-1] == f"cgff: prism.yaml: {found['message']}"
    assert len(found["warnings"]) == len(ended.stderr.splitlines()) - 1 == 1
    assert found["warnings"][0].startswith("strain: ")
    assert (found["balanced"], found["analysis"]["mechanisms"]) == (False, 2)


def test_a_tolerance_may_call_printed_coordinates_balanced(run: Run, solved: str):
    result = json.loads(Path(solved).read_text())
    for name, point in result["nodes"].items():
        result["nodes"][name] = [round(x, 7) for x in point]
    Path("printed.json").write_text(json.dumps(result))
    assert run("analyse", "printed.json").exit_code == 4
    ended = run("analyse", "printed.json", "--tolerance", "1e-4")
    found = json.loads(ended.stdout)["analysis"]
    assert ended.exit_code == 0
    assert (found["self_stress_states"], found["mechanisms"], found["stable"]) == (1, 1, True)


def test_what_a_solve_calls_balanced_is_so_far_from_the_origin_and_at_the_rounding_floor(run: Run):
    scene = cgff_cli.load("prism.yaml")
    Path("far.yaml").write_text(cgff_cli.to_yaml(replace(scene, coordinates=scene.coordinates + 1e6)))
    Path("floor.yaml").write_text(cgff_cli.to_yaml(cgff_cli.new("tower", stages=60)))
    for name, options in (("far", ()), ("floor", ("--tolerance", "1e-16"))):
        assert run("solve", f"{name}.yaml", "-o", f"{name}.json", *options).exit_code == 0
        ended = run("analyse", f"{name}.json")
        found = json.loads(ended.stdout)
        assert (ended.exit_code, found["balanced"]) == (0, True), found["message"]
        assert found["analysis"]["stability"] == "stable"
        assert found["analysis"]["self_stress_states"] == {"far": 1, "floor": 180}[name]


def test_a_geometry_has_states_and_mechanisms_and_reasons(run: Run):
    ended = run("analyse", "-", stdin=GEOMETRY)
    found = json.loads(ended.stdout)
    assert (ended.exit_code, ended.stderr) == (0, "")
    assert (found["balanced"], found["residual"], found["groups"]["ring"]["force"]) == (None, None, None)
    assert found["groups"]["ring"]["length"] == [4.0, 5.0]
    told = found["analysis"]
    assert (told["self_stress_states"], told["mechanisms"], told["stable"]) == (0, 0, None)
    assert "geometry" in told["reason"]["stable"]


def test_sensitivities_are_by_name_and_in_the_order_of_elements(run: Run, solved: str):
    ended = run("analyse", solved, "--sensitivity", "verticals", "--sensitivity", "n4,n1")
    found = json.loads(ended.stdout)["sensitivity"]
    assert list(found) == ["verticals", "n4,n1"]
    own = cgff_cli.solve("prism.yaml").sensitivity("n1,n4")
    assert list(found["n4,n1"]) == ["nodes", "forces", "reason"]
    assert found["n4,n1"]["forces"] == pytest.approx(own.forces.tolist(), rel=1e-6)
    assert found["n4,n1"]["nodes"]["n2"] == pytest.approx(own.coordinates[1].tolist(), rel=1e-6)
    assert found["n4,n1"]["reason"] is None


def test_an_unknown_group_is_wrong_usage(run: Run, solved: str):
    ended = run("analyse", solved, "--sensitivity", "strut")
    assert (ended.exit_code, ended.stdout) == (2, "")
    one = "(one element is written A,B, by its nodes)"
    assert ended.stderr == f"cgff: no group is named 'strut' {one}; did you mean 'struts'?\n"


def test_the_page_begins_with_the_verdict_in_words(run: Run, solved: str):
    page = run("analyse", solved, "--format", "table", "--sensitivity", "struts").stdout
    first, _, verdict, *rest = page.splitlines()
    assert first == "Triangular prism, Table IV  stable"
    assert "the forces balance" in verdict
    assert "it is stable by its stress alone" in verdict
    assert [line.split()[0] for line in rest if line.strip()][:5] == [
        "structure",
        "residual",
        "analysis",
        "rank",
        "stiffness",
    ]
    assert "  critical_load_factor, first_slack_factor, first_slack_cables: there are no loads" in page
    assert "mechanism" in page
    assert "per unit of struts" in page


def test_the_page_of_an_unstable_shape_counts_the_ways(run: Run, unstable: str):
    ended = run("analyse", unstable, "--format", "table")
    assert ended.exit_code == 0
    assert "in line, pushed together  unstable" in ended.stdout
    assert "energy to be gained in 1 independent way" in ended.stdout
    neutral = Path(unstable).read_text().replace("rest_length: 1.0", "rest_length: 0.9")
    assert (
        "some deformation meets no resistance"
        in run("analyse", "-", "--format", "table", stdin=neutral).stdout
    )


def test_the_page_tells_at_which_loads_stiffness_is_lost(run: Run):
    ended = run("analyse", "-", "--format", "table", stdin=COLUMN)
    assert ended.exit_code == 0
    # 2 k l / load of a column of length 2 that two springs hold at its head.
    assert "its stiffness is lost at 4 times the loads" in ended.stdout


@pytest.mark.parametrize(
    ("spring", "tension", "words"),
    [
        (
            3,
            0.003,
            "at 4 times the loads as if no cable went slack, but tail: foot-head goes slack at 2.001 times",
        ),
        (3, 0.018, "lost at 4 times the loads\n"),
        (
            0.5,
            0.003,
            "lost at 0.666667 times the loads; tail: foot-head goes slack at 2.001 times the loads\n",
        ),
    ],
    ids=["before that", "after that", "and needs its loads"],
)
def test_the_page_tells_whether_a_cable_goes_slack_first(run: Run, spring, tension, words):
    # The cable shortens with the column, which takes 1000 of 1001 of the load: 0.003 is lost of it.
    tail = f"  tail: {{kind: cable, EA: 1, rest_length: {2 - tension}, pairs: [[foot, head]]}}\n"
    text = COLUMN.replace("2.003,", f"{2.003 + tension / 1000},").replace("EA: 3", f"EA: {spring}")
    ended = run("analyse", "-", "--format", "table", stdin=text.replace("supports", f"{tail}supports"))
    assert words in ended.stdout


def test_the_help_says_what_its_tolerance_judges(run: Run):
    words = " ".join(run("analyse", "--help").stdout.split())
    assert "--tolerance X Largest out-of-balance force, over the largest force, that still counts as" in words
    assert "at which to stop" not in words


def test_it_goes_to_a_file_but_never_over_its_scene(run: Run, solved: str):
    ended = run("analyse", solved, "-o", "out.json")
    assert (ended.exit_code, ended.stdout) == (0, "")
    assert json.loads(Path("out.json").read_text())["schema"] == "cgff-analysis/1"
    ended = run("analyse", solved, "-o", solved)
    assert ended.exit_code == 2
    assert "would be written over" in ended.stderr
    assert run("analyse", solved, "-o", "out.csv").exit_code == 2


def test_as_many_motions_are_told_as_the_help_says(run: Run, solved: str):
    modes = json.loads(run("analyse", solved).stdout)["analysis"]["modes"]
    assert [mode["kind"] for mode in modes] == ["mechanism"] + ["softest"] * MODES
    assert f"Default: {MODES}." in run("analyse", "--help").stdout


def test_two_runs_write_the_same_bytes(run: Run, solved: str):
    runs = [run("analyse", solved, "--sensitivity", "struts", "--modes", "9").stdout for _ in range(2)]
    assert runs[0] == runs[1]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('"EA": 1000.0', '"EA": -1.0', "prism.json:{}: elements.struts.EA[0]: must be > 0, got -1.0"),
        (
            '"end": "n6"',
            '"end": "n9"',
            "prism.json:{}: elements.triangles.pairs[4][1]: node 'n9' is not defined",
        ),
        ('"law": "paper"', '"law": "papr"', "law: must be paper"),
        (
            '"kind": "cable"',
            '"kind": "rope"',
            "elements.triangles.kind: must be cable or strut, got 'rope' in q",
        ),
        ('"nodes": {', '"knots": {', "missing key 'nodes'"),
    ],
)
def test_a_damaged_result_is_told_at_its_place(run: Run, solved: str, old: str, new: str, message: str):
    text = Path(solved).read_text()
    assert old in text
    place = text[: text.index(old)]
    line, column = place.count("\n") + 1, len(place) - place.rfind("\n") + len(old.partition(" ")[0]) + 1
    Path(solved).write_text(text.replace(old, new, 1))
    ended = run("analyse", solved)
    assert (ended.exit_code, ended.stdout) == (3, "")
    assert message.format(f"{line}:{column}") in ended.stderr
    assert "Traceback" not in ended.stderr


def test_loads_and_supports_of_a_result_count(run: Run):
    run("solve", "bracket.yaml", "-o", "bracket.json")
    ended = run("analyse", "bracket.json")
    assert ended.exit_code == 0
    assert json.loads(ended.stdout)["analysis"]["rigid_motions"] == 0


def test_a_result_is_no_scene_to_solve(run: Run, solved: str):
    ended = run("solve", solved)
    assert ended.exit_code == 3
    assert "this is the result of a solve, not a scene" in ended.stderr


@pytest.mark.parametrize("schema", ["cgff-compare/1", "cgff-result/9"])
def test_another_record_is_told_in_one_line(run: Run, solved: str, schema: str):
    Path(solved).write_text(Path(solved).read_text().replace("cgff-result/1", schema))
    for command in ("solve", "analyse"):
        ended = run(command, solved)
        said = f"{solved}:1:1: this is a record of cgff, of schema {schema!r}, not a scene\n"
        assert (ended.exit_code, ended.stderr) == (3, said)


def test_the_page_of_a_sensitivity_names_no_node_that_stays(run: Run):
    assert run("solve", "bracket.yaml", "-o", "bracket.json").exit_code == 0
    page = run("analyse", "bracket.json", "--sensitivity", "tie", "--format", "table").stdout
    assert "nodes move, most of all tip 1.8375; forces change" in " ".join(page.split())
    assert "-0.0" not in run("analyse", "bracket.json").stdout.partition('"modes"')[2]
