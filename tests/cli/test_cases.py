"""Load cases, starts and scenes written again: --case, --envelope, --start and --scene-out of `solve`."""

import csv
import json
from itertools import permutations
from pathlib import Path

import numpy as np
import pytest

import cgff_cli
from cgff_cli.cases import solve_cases
from tests.cli.conftest import Run
from tests.shapes import STRUCTURES

ROOF = """\
name: roof strip
law: hooke
nodes: {a: [0, 0], b: [2, -0.2], c: [4, -0.3], d: [6, -0.2], e: [8, 0]}
elements:
  rope: {kind: cable, EA: 1000, pretension: 20, weight: 0.1, pairs: [[a, b], [b, c], [c, d], [d, e]]}
supports: {a: xy, e: xy}
loads: {c: [0, -0.5]}
load_cases:
  snow: {b: [0, -1], c: [0, -1], d: [0, -1]}
  wind: {b: [0.2, 0.4], c: [0.2, 0.4], d: [0.2, 0.4]}
combinations:
  uls: {dead: 1.35, snow: 1.5}
x-note: "mine"
"""
SLACK = """\
law: hooke
nodes: {a: [0, 0], b: [1, 0]}
elements: {rope: {kind: cable, EA: 10, rest_length: 1.1, pairs: [[a, b]]}}
supports: {a: xy}
load_cases: {pull: {b: [3, 0]}}
"""


@pytest.fixture
def roof(run: Run) -> str:
    """Write a roof of cables with weight, two load cases and a combination; return its path."""
    Path("roof.yaml").write_text(ROOF)
    return "roof.yaml"


def results(output: str) -> dict[str, dict]:
    """Return the results of lines of JSON by case, without times."""
    read = list(map(json.loads, output.splitlines()))
    return {own["scene"]["case"]: own | {"timing": None} for own in read}


def test_each_case_is_solved_and_has_a_file_a_line_and_a_row(run: Run, roof: str):
    told = results(run("solve", roof, "--case", "all").stdout)
    assert list(told) == ["snow", "wind", "uls"]
    assert run("solve", roof, "--case", "all", "--out-dir", "found", "--summary", "rows.csv").exit_code == 0
    for case, own in told.items():
        assert json.loads(Path(f"found/roof.{case}.json").read_text()) | {"timing": None} == own
        assert own["scene"]["begins"] == "equilibrium without cases"
    rows = list(csv.DictReader(Path("rows.csv").read_text().splitlines()))
    assert [(row["case"], row["verdict"], row["stability"]) for row in rows] == [
        (case, "converged", "stable") for case in told
    ]


def test_one_case_is_the_same_as_among_all(run: Run, roof: str):
    told = results(run("solve", roof, "--case", "all").stdout)
    for case, own in told.items():
        assert json.loads(run("solve", roof, "--case", case).stdout) | {"timing": None} == own


def test_the_order_of_cases_changes_nothing():
    scene = cgff_cli.loads(ROOF)
    shapes = {
        order: {own.source.case: own.coordinates.tobytes() for own in solve_cases(scene, order)}
        for order in permutations(["snow", "wind", "uls"])
    }
    assert all(own == next(iter(shapes.values())) for own in shapes.values())


def test_loads_as_solved_are_sums_by_hand():
    scene = cgff_cli.loads(ROOF)
    (uls,) = solve_cases(scene, ["uls"])
    weight = 0.1 * uls.structure.rest_lengths
    at_c = -1.35 * (0.5 + 0.5 * (weight[1] + weight[2])) - 1.5
    assert uls.loads["c"] == pytest.approx([0.0, at_c], rel=1e-14)
    pull = np.sum(list(uls.reactions.values()), axis=0)
    assert pull == pytest.approx([0.0, 1.35 * (0.5 + weight.sum()) + 1.5 * 3.0], rel=1e-10)


def test_a_case_is_a_scene_of_its_own_that_begins_at_the_same_shape():
    scene = cgff_cli.loads(ROOF)
    dead = cgff_cli.solve(scene)
    (snow,) = solve_cases(scene, ["snow"])
    loads = {"b": (0.0, -1.0), "c": (0.0, -1.5), "d": (0.0, -1.0)}
    alone = cgff_cli.solve(scene.with_loads(loads).with_coordinates(dead.coordinates))
    assert alone.coordinates.tobytes() == snow.coordinates.tobytes()
    assert snow.max_displacement == alone.max_displacement > 0.0


def test_where_there_is_no_equilibrium_without_cases_a_case_begins_at_the_start(run: Run, roof: str):
    (told,) = solve_cases(cgff_cli.loads(ROOF), ["wind"], max_iterations=1)
    assert told.scene["begins"] == "start of the scene"


def test_dead_is_the_scene_without_cases():
    scene = cgff_cli.loads(ROOF)
    (dead,) = solve_cases(scene, ["dead"])
    assert dead.coordinates.tobytes() == cgff_cli.solve(scene).coordinates.tobytes()


def test_the_envelope_holds_the_least_and_greatest_of_every_element_and_reaction(run: Run, roof: str):
    told = results(run("solve", roof, "--case", "all").stdout)
    assert run("solve", roof, "--case", "all", "--out-dir", "found", "--envelope", "ends.csv").exit_code == 0
    rows = list(csv.DictReader(Path("ends.csv").read_text().splitlines()))
    assert [row["kind"] for row in rows] == ["cable"] * 4 + ["reaction"] * 4
    for i, row in enumerate(rows[:4]):
        by_case = {case: own["elements"][i]["force"] for case, own in told.items()}
        assert (float(row["least"]), row["least_in"]) == min((t, case) for case, t in by_case.items())
        assert (float(row["greatest"]), row["greatest_in"]) == max((t, case) for case, t in by_case.items())
    for row in rows[4:]:
        axis = "xy".index(row["end"])
        by_case = [own["reactions"][row["start"]][axis] for own in told.values()]
        assert (float(row["least"]), float(row["greatest"])) == (min(by_case), max(by_case))


def test_a_person_reads_a_row_per_case_and_the_envelope_by_group(run: Run, roof: str):
    lines = run("solve", roof, "--case", "all", "--format", "table").stdout.splitlines()
    assert lines[0].split()[:5] == ["scene", "case", "verdict", "stability", "slack"]
    assert [line.split()[1] for line in lines[1:4]] == ["snow", "wind", "uls"]
    assert next(line for line in lines if "rope" in line).split()[2::2] == ["wind", "uls"]
    assert sum(line.split()[:1] in (["a"], ["e"]) for line in lines) == 4


@pytest.mark.parametrize(
    ("flags", "told"),
    [
        (("--case", "snw"), "no load case is named 'snw'; did you mean 'snow'?"),
        (("--case", "all", "-o", "x.json"), "-o takes one case; use --out-dir DIR for all"),
        (("--case", "all", "--scene-out", "x.yaml"), "--scene-out takes one case; use --out-dir DIR for all"),
        (("--case", "all", "--format", "csv"), "--format csv takes one case; use --out-dir DIR for all"),
        (("--envelope", "x.csv"), "--envelope is that of all cases: it needs --case all"),
        (("--case", "all", "--envelope", "x.json"), "--envelope x.json: the name must end in .csv"),
        (("--scene-out", "x.json"), "--scene-out x.json: the name must end in .yaml or .yml"),
        (("--scene-out", "roof.yaml"), "roof.yaml would be written over the scene roof.yaml"),
    ],
)
def test_what_does_not_go_together_is_told(run: Run, roof: str, flags: tuple[str, ...], told: str):
    ended = run("solve", roof, *flags)
    assert (ended.exit_code, ended.stderr.endswith(f"{told}\n")) == (2, True), ended.stderr


def test_a_scene_without_cases_has_none_to_solve(run: Run):
    ended = run("solve", "prism.yaml", "--case", "all")
    told = "cgff: prism.yaml: --case all: the scene has no load_cases or combinations\n"
    assert (ended.exit_code, ended.stderr) == (2, told)


def test_results_of_cases_are_left_alone_by_resume(run: Run, roof: str):
    flags = ("solve", roof, "--case", "all", "--out-dir", "found", "--resume", "--format", "jsonl")
    first = run(*flags).stdout
    times = {path: path.stat().st_mtime_ns for path in Path("found").glob("*.json")}
    assert run(*flags).stdout == first
    assert {path: path.stat().st_mtime_ns for path in Path("found").glob("*.json")} == times
    Path("found/roof.snow.json").unlink()
    assert run(*flags).stdout.count("\n") == 3


@pytest.mark.parametrize("name", ["prism", "x-module", "hexagon", "octahedron", "cable-net", "bracket"])
def test_an_answer_as_start_takes_no_iteration_and_moves_nothing(run: Run, name: str):
    path = str(STRUCTURES / f"{name}.yaml")
    assert run("solve", path, "-o", "a.json", "--scene-out", "again.yaml").exit_code == 0
    first = json.loads(Path("a.json").read_text())
    for flags in (("again.yaml",), (path, "--start", "a.json")):
        again = json.loads(run("solve", *flags).stdout)
        assert again["counts"]["iterations"] == 0
        assert again["nodes"] == first["nodes"]
        assert again["max_displacement"] == 0.0


def test_a_scene_written_again_says_what_it_said_but_with_rest_lengths(run: Run, roof: str):
    assert run("solve", roof, "--case", "uls", "--scene-out", "again.yaml").exit_code == 0
    first, again = cgff_cli.load("roof.yaml"), cgff_cli.load("again.yaml")
    for name in ("name", "law", "node_names", "supports", "loads", "load_cases", "combinations", "own"):
        assert getattr(again, name) == getattr(first, name)
    assert again.groups[0].pretension is None
    assert again.groups[0].rest_length.tolist() == first.groups[0].rest_length.tolist()
    assert again.groups[0].weight.tolist() == [0.1] * 4
    text = Path("again.yaml").read_text()
    assert text.startswith(
        "# Start coordinates: what cgff solve made of roof.yaml in case uls: equilibrium: "
    )


def test_the_table_tells_how_far_a_node_goes_from_where_the_case_begins(run: Run, roof: str):
    shown = run("solve", roof, "--case", "all", "--format", "table").stdout.splitlines()
    _, *rows = (line.split() for line in shown[:4])
    scene = cgff_cli.loads(ROOF)
    dead = cgff_cli.solve(scene)
    for row, own in zip(rows, solve_cases(scene, scene.cases), strict=True):
        moved = np.linalg.norm(own.coordinates - dead.coordinates, axis=1).max()
        assert f"{moved:.3g}" in row


def test_a_case_begins_at_the_shape_it_is_given_and_ends_there_where_it_balances(run: Run, roof: str):
    run("solve", roof, "--case", "snow", "-o", "snow.json")
    told = json.loads(run("solve", roof, "--case", "snow", "--start", "snow.json").stdout)
    assert (told["scene"]["begins"], told["counts"]["iterations"]) == ("shape given", 0)
    assert told["nodes"] == json.loads(Path("snow.json").read_text())["nodes"]


def test_supports_stay_where_the_scene_has_them_whatever_the_start(run: Run, roof: str):
    run("solve", roof, "-o", "a.json")
    Path("moved.yaml").write_text(ROOF.replace("e: [8, 0]", "e: [8.1, 0]"))
    told = json.loads(run("solve", "moved.yaml", "--start", "a.json").stdout)
    assert told["nodes"]["e"] == [8.1, 0.0]


def test_a_start_of_another_scene_is_refused(run: Run, roof: str):
    run("solve", roof, "-o", "a.json")
    ended = run("solve", roof, "--start", "a.json", "-o", "a.json")
    told = "a.json would be written over the result it begins at\n"
    assert (ended.exit_code, ended.stderr.endswith(told)) == (2, True)
    ended = run("solve", "prism.yaml", "--start", "a.json")
    assert ended.exit_code == 2
    assert "--start a.json: is of another scene, with nodes that prism.yaml has not: 'a', 'b'" in ended.stderr


def test_a_result_is_no_scene_and_says_what_to_do(run: Run, roof: str):
    run("solve", roof, "-o", "a.json")
    ended = run("solve", "a.json")
    assert ended.exit_code == 3
    assert ended.stderr.startswith(
        "a.json:1:1: this is the result of a solve, not a scene; make it one: "
        "cgff convert a.json -o scene.yaml; as it is, `cgff analyse` judges it"
    )
    assert ended.stderr.count("\n") == 1
    assert run("solve", "prism.yaml", "-o", "prism.json").exit_code == 0
    assert run("convert", "prism.json", "-o", "scene.yaml").exit_code == 0
    assert run("prestress", "scene.yaml").exit_code == 0


def test_tables_that_solve_writes_are_tables_of_a_scene(run: Run, roof: str):
    run("solve", roof, "-o", "nodes.csv", "--elements", "elements.csv")
    tables = "law: hooke\nnodes: nodes.csv\nelements: elements.csv\n"
    Path("again.yaml").write_text(f"{tables}supports: {{a: xy, e: xy}}\nloads: {{c: [0, -0.5]}}\n")
    ended = run("solve", "again.yaml", "-v")
    assert ended.exit_code == 0
    told = "elements.csv: not used: 5 columns, length, force, force_density, slack, strain\n"
    assert f"cgff: again.yaml: note: {told}" in ended.stderr


def test_a_sweep_takes_a_case(run: Run, roof: str):
    rows = [
        run("sweep", roof, "--set", "rope.EA=1000", "--out", "force:rope", *flags).stdout.splitlines()[1]
        for flags in ((), ("--case", "snow"))
    ]
    forces = [float(row.split(",")[-1]) for row in rows]
    (snow,) = solve_cases(cgff_cli.load(roof), ["snow"])
    assert forces[0] < forces[1] == pytest.approx(snow.groups["rope"]["force"][1], rel=1e-8)


ULS_BY_HAND = {"weight: 0.1": "weight: 0.135", "loads: {c: [0, -0.5]}": "", "load_cases:": "loads:"} | {
    "  snow: {b: [0, -1], c: [0, -1], d: [0, -1]}": "  {b: [0, -1.5], c: [0, -2.175], d: [0, -1.5]}"
}
"""What is to be changed in ROOF for the loads of uls to be its own: 1.35 of weight and loads, 1.5 of snow."""


@pytest.fixture
def by_hand(roof: str) -> str:
    """Write the roof again with the loads of uls as its own, and no cases; return its path."""
    text = ROOF.partition("  wind:")[0]
    for old, new in ULS_BY_HAND.items():
        text = text.replace(old, new)
    Path("by_hand.yaml").write_text(text)
    return "by_hand.yaml"


TOLD = {
    "analyse": ((), lambda told: [told["residual"]["max"], *told["analysis"]["tangent_eigenvalues"]]),
    "compare": (
        ("--schek", "--lbfgs", "--repeat", "1"),
        lambda told: [row["energy"] for row in told["methods"]],
    ),
    "equilibria": (("--starts", "6"), lambda told: [own["energy"] for own in told["equilibria"]]),
}
"""Command -> flags, and numbers that it tells."""


@pytest.mark.parametrize("command", TOLD)
def test_a_case_is_the_scene_with_its_loads_in_it_by_hand(run: Run, roof: str, by_hand: str, command: str):
    flags, numbers = TOLD[command]
    in_case = json.loads(run(command, roof, "--case", "uls", *flags).stdout)
    assert (in_case["scene"]["case"], in_case["scene"]["begins"]) == ("uls", "start of the scene")
    own, plain = (json.loads(run(command, path, *flags).stdout) for path in (by_hand, roof))
    assert numbers(in_case) == pytest.approx(numbers(own), rel=1e-9)
    assert numbers(in_case)[0] != pytest.approx(numbers(plain)[0], rel=1e-3)
    page = run(command, roof, "--case", "uls", *flags, "--format", "table").stdout
    assert page.startswith("roof strip, uls")


@pytest.mark.parametrize("command", [*TOLD, "sweep"])
def test_all_cases_are_for_solve_and_view(run: Run, roof: str, command: str):
    flags = ("--set", "rope.EA=1000") if command == "sweep" else ()
    for case, told in (
        ("all", "all is for cgff solve and cgff view; name one load case or combination"),
        ("snw", "no load case is named 'snw'; did you mean 'snow'?"),
    ):
        ended = run(command, roof, *flags, "--case", case)
        assert (ended.exit_code, ended.stdout) == (2, "")
        assert told in ended.stderr


def test_a_result_is_analysed_in_the_case_that_it_was_solved_in(run: Run, roof: str):
    for name, flags in (("uls", ("--case", "uls")), ("plain", ())):
        assert run("solve", roof, *flags, "-o", f"{name}.json").exit_code == 0
    plain = run("analyse", "uls.json")
    assert (plain.exit_code, json.loads(plain.stdout)["scene"]["case"]) == (0, "uls")
    assert run("analyse", "uls.json", "--case", "uls").stdout == plain.stdout
    assert run("analyse", "plain.json", "--case", "dead").stdout == run("analyse", "plain.json").stdout
    for name, own in (("uls", "in case 'uls'"), ("plain", "without a load case")):
        ended = run("analyse", f"{name}.json", "--case", "snow")
        assert (ended.exit_code, ended.stdout) == (2, "")
        assert ended.stderr == f"cgff: {name}.json: this is the result of a solve {own}, not in 'snow'\n"


def test_a_suite_names_the_case_of_a_scene_in_whatever_units(run: Run, roof: str):
    def suite(**scene):
        Path("suite.yaml").write_text(json.dumps([{"id": "one", "scene": {"file": roof, **scene}}]))
        return run("bench", "suite.yaml", "--lbfgs", "--repeat", "1", "--format", "json")

    (uls,) = solve_cases(cgff_cli.loads(ROOF), ["uls"])
    energies = [
        json.loads(suite(**scene).stdout)["rows"][0]["energy"]
        for scene in ({"case": "uls"}, {"case": "uls", "units": [8, 2]}, {"units": [8, 2], "case": "uls"})
    ]
    assert energies == pytest.approx([uls.energy, 16 * uls.energy, 16 * uls.energy], rel=1e-9)
    ended = suite(case="snw")
    assert ended.exit_code == 3
    assert "case one: no load case is named 'snw'; did you mean 'snow'?" in ended.stderr
