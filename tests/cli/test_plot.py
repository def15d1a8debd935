"""`cgff plot`: what is drawn how, in which files, and what is said where it cannot be."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

import cgff_cli
from cgff_cli.report import plots
from cgff_cli.report.curves import draw_sweep, history_of, read_rows
from cgff_cli.report.drawing import results_of
from tests.cli.conftest import Run
from tests.study.test_path import SNAPS, TRUSS

SLACK = """\
law: hooke
nodes: {a: [0, 0], b: [1, 0.2], c: [2, 0], d: [1, 1]}
elements:
  strut: {kind: strut, EA: 100, rest_length: 2, pairs: [[a, c]]}
  cables: {kind: cable, EA: 10, rest_length: [0.9, 0.9, 3], pairs: [[a, b], [b, c], [b, d]]}
supports: {a: xy, c: xy, d: xy}
loads: {b: [0, -1]}
"""
GEOMETRY = re.sub(r"rest_length: (\[.*?\]|2), ", "", SLACK)
MAGIC = {"png": b"\x89PNG", "svg": b"<?xml", "pdf": b"%PDF"}

pytestmark = pytest.mark.needs_matplotlib


def axes_of(scene: str, **asked: object):
    """Return the axes that a scene is drawn in, and the drawing."""
    from matplotlib.figure import Figure

    from cgff_cli.report.drawing import drawing_of
    from cgff_cli.report.picture import draw_structure, eye_for

    read = cgff_cli.loads(scene)
    result = cgff_cli.analyse(read).result if read.is_geometry else cgff_cli.solve(read)
    drawing = drawing_of(result)
    axes = Figure().subplots()
    draw_structure(drawing, axes, eye_for(drawing.coordinates, None), **asked)
    return axes, drawing


@pytest.mark.parametrize("form", list(MAGIC))
def test_a_picture_has_the_form_of_its_name_and_is_the_same_twice(run: Run, form: str):
    assert run("plot", "prism.yaml", "-o", f"a.{form}").exit_code == 0
    assert run("plot", "prism.yaml", "-o", f"b.{form}").exit_code == 0
    assert Path(f"a.{form}").read_bytes()[:8].startswith(MAGIC[form])
    assert Path(f"a.{form}").read_bytes() == Path(f"b.{form}").read_bytes()


def test_struts_are_thick_cables_thin_slack_ones_dashed_and_the_start_is_a_ghost():
    axes, drawing = axes_of(SLACK)
    ghost, own = axes.collections[:2]
    assert len(ghost.get_segments()) == len(own.get_segments()) == 4
    widths = own.get_linewidths()
    assert sorted(widths)[-1] > 2.0 * sorted(widths)[-2]
    assert [dash is not None for _, dash in own.get_linestyles()].count(True) == drawing.slack.sum() == 1
    assert axes.get_aspect() == 1.0
    assert {text.get_text() for text in axes.texts} == {"a", "b", "c", "d"}


def test_the_ends_of_the_scale_are_darker_than_its_middle_and_not_red_against_green():
    from matplotlib.colors import to_rgb

    from cgff_cli.report.picture import NOTHING, PULL, PUSH

    def grey(colour: str) -> float:
        return float(np.dot(to_rgb(colour), (0.299, 0.587, 0.114)))

    assert max(grey(PUSH), grey(PULL)) < grey(NOTHING) - 0.2
    blues = [to_rgb(colour)[2] for colour in (PUSH, PULL)]
    assert blues[0] > blues[1] + 0.4


def test_colours_follow_forces_by_a_scale_in_the_users_numbers():
    axes, drawing = axes_of(SLACK)
    bar = axes.figure.axes[-1]
    assert bar.get_ylabel() == "force, tension > 0"
    assert bar.get_ylim() == pytest.approx((drawing.forces.min(), drawing.forces.max()))


def test_a_geometry_has_no_forces_to_colour():
    axes, _ = axes_of(GEOMETRY)
    assert len(axes.figure.axes) == 1
    assert len(axes.collections) == 1 + 1  # elements, loads


def test_a_plane_scene_lies_in_its_plane_and_a_mode_is_told():
    shape = np.array([[0, 0], [0, 1.0], [0, 0], [0, 0]])
    axes, drawing = axes_of(SLACK, mode=(shape, "softest 1"))
    own = axes.collections[1].get_segments()
    assert sorted(np.ravel(own)) == pytest.approx(sorted(drawing.coordinates[drawing.pairs].ravel()))
    assert axes.get_title().endswith("\nsoftest 1")
    assert len(axes.collections) == 5  # ghost, elements, loads, the mode and its arrows


def test_up_is_up_and_the_widest_side_is_seen():
    from cgff_cli.report.picture import VIEWS, eye_for

    X = np.array([[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 5.0]])
    for view in (None, VIEWS["front"], VIEWS["side"], (10.0, 40.0)):
        eye = eye_for(X, view)
        assert eye.axes @ eye.axes.T == pytest.approx(np.eye(3))
        up = eye.seen(X)[3] - eye.seen(X)[0]
        assert up[0] == pytest.approx(0.0)
        assert up[1] > 0.0
    assert np.ptp(eye_for(X, None).seen(X)[:, 0]) > 8.0
    assert eye_for(X, VIEWS["top"]).seen(X) == pytest.approx(X[:, :2])


def test_a_result_is_drawn_as_it_is_and_a_scene_solved_unless_it_is_not_to_be(run: Run):
    run("solve", "prism.yaml", "-o", "prism.json")
    for name, flags in (("prism.yaml", ()), ("prism.json", ()), ("prism.yaml", ("--as-given",))):
        assert run("plot", name, *flags, "-o", "a.svg").exit_code == 0
    solved, result = (next(results_of(name, None, False)) for name in ("prism.yaml", "prism.json"))
    assert result.coordinates == pytest.approx(solved.coordinates, abs=1e-12)
    given = next(results_of("prism.yaml", None, True))
    assert given.coordinates.tolist() == cgff_cli.load("prism.yaml").coordinates.tolist()


def test_modes_histories_cases_and_sweeps_have_pictures(run: Run):
    assert run("plot", "prism.yaml", "--mode", "1", "-o", "mode.png").exit_code == 0
    run("solve", "prism.yaml", "-o", "prism.json")
    for name in ("prism.yaml", "prism.json"):
        assert run("plot", name, "--history", "-o", f"{name}.png").exit_code == 0
    flags = ("--set", "struts.EA=10,100,1000", "--set", "verticals.EA=10,100", "--out", "slack")
    run("sweep", "prism.yaml", *flags, "-o", "rows.csv")
    assert run("plot", "--sweep", "rows.csv", "-o", "rows.png").exit_code == 0


def test_the_curve_of_a_path_ends_where_it_fell_and_a_line_tells_where(run: Run):
    from matplotlib.figure import Figure

    Path("truss.yaml").write_text(TRUSS)
    run("sweep", "truss.yaml", "--set", "loads.b.y=0:-6:4", "--follow", "--out", "node:b", "-o", "rows.csv")
    swept, found, rows = read_rows("rows.csv")
    axes = Figure().subplots(len(found), 1)
    draw_sweep(swept, found, rows, axes)
    for name, own in zip(found, axes, strict=True):
        curve, fall = own.lines
        x, y = (np.asarray(numbers, dtype=float) for numbers in curve.get_data())
        assert x.tolist() == pytest.approx([0.0, -2.0, np.nan, -4.0, -6.0], nan_ok=True)
        assert y[[0, 1, 3, 4]].tolist() == [float(row[name]) for row in rows]
        assert np.isnan(y[2])
        assert fall.get_xdata() == pytest.approx([SNAPS] * 2, rel=1e-7)
    assert run("plot", "--sweep", "rows.csv", "-o", "rows.svg").exit_code == 0


@pytest.mark.parametrize(
    ("flags", "code", "told"),
    [
        (("prism.yaml", "-o", "a.jpg"), 2, "-o a.jpg: the name must end in .png, .svg or .pdf"),
        (("-o", "a.png"), 2, "give a SCENE, a RESULT or --sweep FILE.csv"),
        (("prism.yaml", "--view", "frnt", "-o", "a.png"), 2, "view 'frnt' is none; did you mean 'front'?"),
        (("prism.yaml", "--case", "all", "-o", "a.png"), 2, "--case all: a picture is of one case"),
        (("prism.yaml", "--case", "snow", "--as-given", "-o", "a.png"), 2, "prism.yaml is drawn as it is"),
        (("prism.yaml", "--as-given", "--history", "-o", "a.png"), 2, "--history: prism.yaml tells none"),
        (("prism.yaml", "--mode", "90", "-o", "a.png"), 2, "mode 90: there are"),
        (("--sweep", "prism.yaml", "-o", "a.png"), 2, "prism.yaml: is no table of rows that"),
        (("--sweep", "none.csv", "-o", "a.png"), 1, "none.csv: cannot be read: No such file or directory"),
        (("prism.yaml", "-o", "no/a.png"), 1, "no/a.png: cannot be written: there is no folder"),
    ],
)
def test_what_cannot_be_drawn_is_told(run: Run, flags: tuple[str, ...], code: int, told: str):
    ended = run("plot", *flags)
    assert (ended.exit_code, told in ended.stderr) == (code, True), ended.stderr


def test_the_history_of_a_result_is_that_of_its_file(run: Run):
    told = json.loads(run("solve", "prism.yaml", "-o", "-").stdout)
    Path("prism.json").write_text(json.dumps(told))
    history, verdict = history_of(next(results_of("prism.json", None, False)))
    assert (history, verdict) == (told["history"], "converged")
    for broken in (
        None,
        [],
        {},
        told["history"] | {"residual_max": ["a"]},
        told["history"] | {"iteration": []},
    ):
        Path("prism.json").write_text(json.dumps(told | {"history": broken}))
        ended = run("plot", "prism.json", "--history", "-o", "a.png")
        assert (ended.exit_code, "--history: prism.json tells none" in ended.stderr) == (2, True)


def test_it_needs_matplotlib_and_says_which_command_brings_it(run: Run, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(plots, "find_spec", lambda name: None)
    ended = run("plot", "prism.yaml", "-o", "a.png")
    told = "cgff: cgff plot needs matplotlib, which is not installed: pip install 'cgff-cli[plot]'\n"
    assert (ended.exit_code, ended.stderr) == (2, told)
    assert not Path("a.png").exists()


def test_the_way_of_a_node_is_drawn_by_its_columns_to_one_scale(run: Run):
    outs = ("--out", "node:n4", "--out", "slack")
    run("sweep", "prism.yaml", "--set", "verticals.rest_length=2:4:5", *outs, "-o", "rows.csv")
    told = ("--sweep", "rows.csv", "--x", "node:n4.x", "--y", "node:n4.z")
    assert run("plot", *told, "-o", "way.png").exit_code == 0
    from matplotlib.figure import Figure

    swept, _, rows = read_rows("rows.csv")
    axes = Figure().subplots()
    draw_sweep(swept, ["node:n4.z"], rows, [axes], "node:n4.x")
    (line,) = axes.lines
    drawn = list(zip(*(map(float, own) for own in (line.get_xdata(), line.get_ydata())), strict=True))
    assert drawn == [(float(row["node:n4.x"]), float(row["node:n4.z"])) for row in rows]
    assert axes.get_aspect() == 1.0
    for flags, words in (
        (("--sweep", "rows.csv", "--x", "node:n4.q"), "rows.csv has no column 'node:n4.q'; did you mean"),
        (("prism.yaml", "--x", "slack"), "--x and --y are columns of --sweep FILE.csv"),
    ):
        ended = run("plot", *flags, "-o", "way.png")
        assert (ended.exit_code, words in ended.stderr) == (2, True)


def test_a_result_read_again_knows_that_it_is_one(run: Run):
    run("solve", "prism.yaml", "-o", "prism.json")
    assert cgff_cli.load("prism.json", results=True).answer["verdict"] == "converged"
    assert not cgff_cli.load("prism.yaml", results=True).answer
    assert json.loads(Path("prism.json").read_text())["schema"] == "cgff-result/1"


def test_what_did_not_converge_is_drawn_and_said(run: Run):
    Path("hard.yaml").write_text(SLACK + "solver: {max_iterations: 1}\n")
    ended = run("plot", "hard.yaml", "-o", "a.svg")
    assert (ended.exit_code, "iteration" in ended.stderr) == (4, True)
    assert Path("a.svg").exists()
    assert run("plot", "hard.yaml", "--as-given", "-o", "a.svg").exit_code == 0
