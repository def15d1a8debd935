"""`cgff view`: one page without a network, its arrays, and what its own script does with them."""

import json
import re
from dataclasses import replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

import cgff_cli
from cgff_cli.report import drawing, view
from cgff_cli.solvers.stopping import Verdict
from tests.cli.conftest import Run
from tests.cli.page_of_view import Page, Stage, floats, rows

ROOF = """\
law: hooke
nodes: {a: [100000, 0], b: [100001, 0.2], c: [100002, 0], d: [100001, 1]}
elements:
  strut: {kind: strut, EA: 100, rest_length: 2, pairs: [[a, c]]}
  cables: {kind: cable, EA: 10, rest_length: [0.9, 0.9, 3], pairs: [[a, b], [b, c], [b, d]]}
supports: {a: xy, c: xy, d: xy}
loads: {b: [0, -1]}
load_cases: {snow: {b: [0, -1]}, wind: {b: [0.5, 0]}}
"""
GEOMETRY = re.sub(r"rest_length: (\[.*?\]|2), ", "", ROOF)
HOSTILE = "</script><img src=x onerror=document.title='gone'>"

pytestmark = pytest.mark.needs_jupyter_threejs_sage


def page_of(run: Run, *arguments: str) -> Page:
    """Return the page that `cgff view` makes of files."""
    ended = run("view", *arguments, "-o", "page.html")
    assert ended.exit_code == 0, ended.stderr
    return Page(Path("page.html").read_text(encoding="utf-8"))


@pytest.fixture
def stage(run: Run) -> Stage:
    """Run the script of the page of a prism, solved."""
    pytest.importorskip("py_mini_racer")
    return Stage(page_of(run, "prism.yaml"))


def test_a_page_fetches_nothing_and_runs_only_its_own_scripts(run: Run):
    page = page_of(run, "prism.yaml")
    assert not {tag for tag, _ in page.tags} & {"img", "link", "iframe", "object", "base", "video", "image"}
    assert not [own for _, own in page.tags if {"src", "href", "action", "srcset", "style"} & set(own)]
    assert not [name for _, own in page.tags for name in own if name.startswith("on")]
    assert page.policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe" not in page.policy
    assert "http" not in "".join(page.scripts[2:]) + page.words
    assert not re.search(r"innerHTML|outerHTML|insertAdjacent|document\.write|eval|fetch", page.scripts[2])


def test_a_page_is_the_same_twice(run: Run):
    page_of(run, "prism.yaml")
    first = Path("page.html").read_bytes()
    page_of(run, "prism.yaml")
    assert Path("page.html").read_bytes() == first


def test_the_arrays_of_a_page_are_those_of_the_result(run: Run):
    page, result = page_of(run, "prism.yaml"), cgff_cli.solve("prism.yaml")
    frame, shown = page.data["frames"][0], page.data["results"][0]
    places = floats(shown["places"]).reshape(-1, 3) * frame["size"] + frame["middle"]
    assert places == pytest.approx(result.coordinates, abs=1e-6)
    assert (
        rows(shown["pairs"])
        == np.column_stack([result.structure.start, result.structure.end]).ravel().tolist()
    )
    told = {own["name"]: floats(own["values"]) * own["most"] for own in shown["fields"]}
    wanted = {"force": result.forces, "force density": result.force_densities, "strain": result.strains}
    assert {name: pytest.approx(values, rel=1e-6) for name, values in wanted.items()} == told
    assert frame["names"] == [f"n{k}" for k in range(1, 7)]


def test_places_far_from_the_origin_keep_their_digits(run: Run):
    Path("roof.yaml").write_text(ROOF)
    page = page_of(run, "roof.yaml")
    frame, shown = page.data["frames"][0], page.data["results"][0]
    places = floats(shown["places"]).reshape(-1, 3) * frame["size"] + frame["middle"]
    assert places[[0, 2]] == pytest.approx(np.array([[1e5, 0, 0], [1e5 + 2, 0, 0]]), abs=1e-6)


def test_cases_share_a_frame_so_that_the_larger_load_sags_more(run: Run):
    Path("roof.yaml").write_text(ROOF)
    page = page_of(run, "roof.yaml", "--case", "all")
    assert [own["title"] for own in page.data["results"]] == ["roof, snow", "roof, wind"]
    assert [own["frame"] for own in page.data["results"]] == [0, 0]
    snow, wind = (floats(own["places"])[3 * 1 + 2] for own in page.data["results"])
    assert snow < wind


def test_structures_of_one_name_can_be_told_apart_and_have_frames_of_their_own(run: Run):
    run("solve", "prism.yaml", "-o", "prism.json")
    page = page_of(run, "prism.json", "prism.yaml", "bracket.yaml")
    titles = [own["title"] for own in page.data["results"]]
    assert len(set(titles)) == 3
    assert [own["frame"] for own in page.data["results"]] == [0, 0, 1]


def test_a_plane_lies_in_the_page_and_a_geometry_has_no_forces(run: Run):
    Path("shape.yaml").write_text(GEOMETRY)
    page = page_of(run, "shape.yaml")
    shown = page.data["results"][0]
    assert floats(shown["places"]).reshape(-1, 3)[:, 1].tolist() == [0.0] * 4
    assert (page.data["frames"][0]["eye"], page.data["frames"][0]["columns"]) == ([0, -1, 0], [0, 2])
    assert shown["fields"] == []
    assert shown["told"].startswith("a geometry without rest lengths")


def test_modes_are_those_that_analyse_tells(run: Run):
    page = page_of(run, "prism.yaml", "--modes", "2")
    found = cgff_cli.analyse(cgff_cli.solve("prism.yaml"), modes=2).analysis["modes"]
    told = page.data["results"][0]["modes"]
    assert len(told) == len(found) > 1
    for mine, theirs in zip(told, found, strict=True):
        shape = np.array(list(theirs["shape"].values()))
        largest = np.linalg.norm(shape, axis=1).max()
        assert floats(mine["shape"]) == pytest.approx(shape.ravel() / largest, abs=1e-6)
        assert mine["name"].startswith(theirs["kind"])
    assert page_of(run, "prism.yaml", "--modes", "0").data["results"][0]["modes"] == []


def test_a_hostile_name_is_text_and_nothing_else(run: Run):
    pytest.importorskip("py_mini_racer")
    text = Path("prism.yaml").read_text().replace("Triangular prism, Table IV", f'"{HOSTILE}"')
    Path("prism.yaml").write_text(re.sub(r"\bn1\b", f'"{HOSTILE}"', text).replace("struts:", f'"{HOSTILE}":'))
    page = page_of(run, "prism.yaml")
    assert len(page.scripts) == 3
    assert "img" not in {tag for tag, _ in page.tags}
    assert page.data["frames"][0]["names"][0] == HOSTILE
    assert Stage(page).ask("words({ node: 0 })").startswith(HOSTILE)


def test_every_member_is_met_along_its_length_and_every_node_at_its_place(stage: Stage):
    met = stage.ask(
        "[0.2, 0.35, 0.66].map((share) => Array.from(now.owners, (_, i) =>"
        " pick(...pixel(now.pairs[2 * i], now.pairs[2 * i + 1], share)).member))"
    )
    right = [row == i for found in met for i, row in enumerate(found)]
    assert sum(right) >= 32  # the others are met where a nearer one passes in front
    assert not any(None in found for found in met)
    assert stage.ask("[0, 1, 2, 3, 4, 5].map((n) => pick(...pixel(n)).node)") == [0, 1, 2, 3, 4, 5]
    assert stage.ask("pick(5, 5)") == {}


def test_of_members_that_cross_the_one_in_front_is_met(stage: Stage):
    spots = np.array(stage.ask("Array.from(seen())")).reshape(-1, 4)
    pairs = np.array(stage.ask("Array.from(now.pairs)")).reshape(-1, 2)
    crossed = 0
    for i, j in combinations(range(len(pairs)), 2):
        (a, b), (c, d) = spots[pairs[i]], spots[pairs[j]]
        if set(pairs[i]) & set(pairs[j]):
            continue
        share = np.linalg.solve(np.column_stack([b - a, c - d])[:2], (c - a)[:2])
        if np.all((share > 0.1) & (share < 0.9)):
            depths = a[2] + share[0] * (b - a)[2], c[2] + share[1] * (d - c)[2]
            x, y = a[:2] + share[0] * (b - a)[:2]
            assert stage.ask(f"pick({x}, {y})") == {"member": (i, j)[int(np.argmin(depths))]}
            crossed += 1
    assert crossed > 1


def test_what_hovers_is_told_in_the_users_numbers(stage: Stage):
    told = stage.ask("words({ member: 11 })").splitlines()
    assert (
        told == ["n3 - n6", "struts: strut", "force -7", "force density -1", "strain -0.000998", "length 7"]
        or told[:4]
    )
    result = cgff_cli.solve("prism.yaml")
    name, *place = stage.ask("words({ node: 3 })").splitlines()
    assert name == "n4"
    assert [float(own.split()[1]) for own in place] == pytest.approx(result.coordinates[3], abs=1e-5)


def test_what_the_legend_hides_is_neither_seen_nor_met(stage: Stage):
    spot = "...pixel(now.pairs[22], now.pairs[23], 0.35)"
    assert stage.ask(f"pick({spot})") == {"member": 11}
    stage.do(
        "const box = elements.legend.children[3].children[0];box.checked = false; box.fire('change'); frame()"
    )
    assert stage.ask("parts.filter((part) => part.members).map((part) => part.mesh.visible)") == [
        True,
        True,
        False,
    ]
    assert stage.ask(f"pick({spot}).member ?? null") != 11


def test_the_scale_has_grey_at_zero_and_the_result_s_own_ends(stage: Stage):
    ends = stage.ask("elements['scale-ends'].children.map((span) => span.textContent)")
    result = cgff_cli.solve("prism.yaml")
    assert [float(end) for end in ends] == pytest.approx(
        [result.forces.min(), 0, result.forces.max()], rel=1e-5
    )
    force = "now.fields[0]"
    assert stage.ask(f"colourOf(0, {force})") == stage.ask("ink().none")
    assert stage.ask(f"colourOf({force}.least, {force})") == stage.ask("ink().push")
    assert stage.ask(f"colourOf({force}.greatest, {force})") == stage.ask("ink().pull")
    stage.do("elements.field.value = 2; elements.field.fire('change')")
    assert stage.ask("elements['scale-name'].textContent") == "strain"


def test_a_mode_swings_about_the_shape_by_its_reach_and_stops(stage: Stage):
    stage.do("elements.mode.value = 1; elements.mode.fire('change'); frame(200 * Math.PI)")
    moved = np.array(stage.ask("Array.from(at)")) - stage.ask("Array.from(now.places)")
    assert moved == pytest.approx(0.1 * np.array(stage.ask("Array.from(now.modes[0].shape)")), abs=1e-6)
    assert np.linalg.norm(moved.reshape(-1, 3), axis=1).max() == pytest.approx(0.1, rel=1e-5)
    assert stage.ask("queue.length") == 1  # and goes on
    stage.do("elements.mode.value = 0; elements.mode.fire('change'); frame()")
    assert stage.ask("Array.from(at)") == stage.ask("Array.from(now.places)")
    assert stage.ask("queue.length") == 0  # nothing moves, nothing is drawn


def test_tubes_reach_from_node_to_node(stage: Stage):
    ends = stage.ask(
        "parts.filter((part) => part.members).flatMap((part) => part.members.map((i, k) => {"
        " const m = new THREE.Matrix4(); part.mesh.getMatrixAt(k, m);"
        " const end = (y) => new THREE.Vector3(0, y, 0).applyMatrix4(m).toArray();"
        " return [end(-0.5), end(0.5), m.determinant()]; }))"
    )
    places, pairs = (np.array(stage.ask(f"Array.from(now.{own})")) for own in ("places", "pairs"))
    for (a, b, turn), (i, j) in zip(ends, pairs.reshape(-1, 2), strict=True):
        assert [a, b] == [pytest.approx(places[3 * n : 3 * n + 3], abs=1e-6) for n in (i, j)]
        assert turn > 0.0


def test_all_nodes_are_beside_the_panel_and_stay_so_when_turned_by_keys(stage: Stage):
    middle = stage.ask("(camera.updateMatrixWorld(), new THREE.Vector3().project(camera).toArray())")
    assert (middle[0] + 1.0) * 600.0 == pytest.approx(254 + (1200 - 254) / 2)
    for keys in ([], ["ArrowLeft"] * 9, ["ArrowUp"] * 40, ["+", "-"], ["Home"]):
        for key in keys:
            stage.do(f"elements.view.fire('keydown', {{ key: '{key}', preventDefault() {{}} }})")
        x, y = np.array(stage.ask("[0, 1, 2, 3, 4, 5].map((n) => pixel(n))")).T
        assert np.all((x > 254) & (x < 1200) & (y > 0) & (y < 800))
        assert np.ptp(y) > 100


def test_slack_is_dashed_and_said_and_many_members_are_lines(run: Run):
    pytest.importorskip("py_mini_racer")
    Path("roof.yaml").write_text(ROOF)
    roof = Stage(page_of(run, "roof.yaml"))
    assert roof.ask("parts.filter((part) => part.members).map((part) => part.mesh.material.type)") == [
        "MeshLambertMaterial",
        "MeshLambertMaterial",
        "LineDashedMaterial",
    ]
    assert roof.ask("words({ member: 3 })").splitlines()[1] == "cables: cable, slack"
    assert "1 slack, dashed" in roof.ask("elements.legend.children[2].children[2].textContent")
    assert roof.ask("words({ node: 1 })").splitlines()[3] == "load 0, -1"
    run("new", "net", "--side", "52", "--snow", "0.1", "-o", "net.yaml")
    net = Stage(page_of(run, "net.yaml", "--as-given", "--modes", "0"))
    assert net.ask("[now.owners.length > TUBES, parts[0].mesh.type]") == [True, "LineSegments"]
    arrows = "parts.filter((part) => part.extra === 'loads').map((part) => part.mesh.count)"
    assert (roof.ask(arrows), net.ask(arrows)) == ([1, 1], [150, 150])
    assert net.ask("elements.legend.children.at(-1).children[2].textContent") == "150 of 2500"


def test_standard_output_can_take_the_page(run: Run):
    ended = run("view", "prism.yaml", "-o", "-")
    assert (ended.exit_code, ended.stderr) == (0, "")
    assert Page(ended.stdout).data == page_of(run, "prism.yaml").data


@pytest.mark.parametrize("scale", [1e-25, 1e25])
def test_no_size_is_out_of_range(run: Run, scale: float):
    pytest.importorskip("py_mini_racer")
    nodes = {"a": [0.0, 0.0], "b": [3.0 * scale, 4.0 * scale]}
    groups = {"rope": {"kind": "cable", "EA": 1.0, "pairs": [["a", "b"]]}}
    Path("rope.yaml").write_text(json.dumps({"law": "hooke", "nodes": nodes, "elements": groups}))
    stage = Stage(page_of(run, "rope.yaml", "--modes", "0"))
    assert stage.ask("words({ member: 0 })").splitlines()[2] == f"length {5.0 * scale:.0e}"
    assert np.linalg.norm(stage.ask("Array.from(at)")[3:]) == pytest.approx(0.5)


def test_what_did_not_converge_is_shown_and_said(run: Run):
    Path("prism.yaml").write_text(Path("prism.yaml").read_text() + "solver: {max_iterations: 1}\n")
    ended = run("view", "prism.yaml", "-o", "page.html")
    assert ended.exit_code == 4
    page = Page(Path("page.html").read_text())
    assert page.data["results"][0]["told"].startswith("the forces do not balance: ")


def test_an_interrupted_solve_is_shown_as_far_as_it_came_and_ends_the_command(
    run: Run, monkeypatch: pytest.MonkeyPatch
):
    real = cgff_cli.solve("prism.yaml", max_iterations=1)
    cut = replace(real, solution=replace(real.solution, verdict=Verdict.INTERRUPTED))
    monkeypatch.setattr(drawing.pipeline, "solve", lambda scene: cut)
    ended = run("view", "prism.yaml", "bracket.yaml", "-o", "page.html")
    assert ended.exit_code == 130
    shown = Page(Path("page.html").read_text()).data["results"]
    assert [own["title"] for own in shown] == ["Triangular prism, Table IV"]


def test_an_element_without_rest_length_has_no_strain_to_tell(run: Run):
    pytest.importorskip("py_mini_racer")
    text = Path("prism.yaml").read_text().replace("2.982679491924", "0.0")
    Path("prism.yaml").write_text(text)
    run("view", "prism.yaml", "-o", "page.html")
    stage = Stage(Page(Path("page.html").read_text()))
    assert stage.ask("words({ member: 0 })").splitlines()[4] == "strain none"


@pytest.mark.parametrize(
    ("flags", "code", "told"),
    [
        (("prism.yaml", "-o", "a.htm"), 2, "-o a.htm: the name must end in .html"),
        (("prism.yaml", "--case", "all", "-o", "a.html"), 2, "the scene has no load_cases or combinations"),
        (("prism.yaml", "--case", "snow", "-o", "a.html"), 2, "snow"),
        (("prism.json", "--case", "all", "-o", "a.html"), 2, "--case all: prism.json is drawn as it is"),
        (("none.yaml", "-o", "a.html"), 3, "none.yaml"),
        (("prism.yaml", "-o", "no/a.html"), 1, "there is no folder"),
        ((), 2, "Missing"),
    ],
)
def test_what_cannot_be_shown_is_told_and_leaves_no_page(
    run: Run, flags: tuple[str, ...], code: int, told: str
):
    run("solve", "prism.yaml", "-o", "prism.json")
    ended = run("view", *flags)
    assert (ended.exit_code, told in ended.stderr) == (code, True), ended.stderr
    assert not Path("a.html").exists()


def test_it_needs_threejs_and_says_which_command_brings_it(run: Run, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(view, "find_spec", lambda name: None)
    ended = run("view", "prism.yaml", "-o", "a.html")
    told = "cgff: cgff view needs three.js, which is not installed: pip install 'cgff-cli[view]'\n"
    assert (ended.exit_code, ended.stderr) == (2, told)


def test_the_script_of_the_page_is_short():
    for name in ("view.js", "view_world.js"):
        lines = (Path(view.__file__).parent / name).read_text().splitlines()
        assert len(lines) <= 250
        assert max(map(len, lines)) <= 112
