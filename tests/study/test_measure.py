"""The rows of a case: fields, what was expected, and answers of one energy that must be one shape."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import cgff_cli
from cgff_cli.rivals.task import TOLERANCES
from cgff_cli.study import bench
from cgff_cli.study.bench import ROW_FIELDS, Job, jobs_of, measured
from cgff_cli.study.case import agrees
from cgff_cli.study.digest import machine
from cgff_cli.study.suite import cases_of
from tests.shapes import STRUCTURES

MakeJob = Callable[..., Job]


@pytest.fixture
def job(tmp_path: Path) -> MakeJob:
    """Make the job of one case, given as YAML, by cgff and lm unless other methods are named."""

    def make(entry: str, *methods: str, **options: object) -> Job:
        path = tmp_path / "own.yaml"
        path.write_text(f"- {entry}\n")
        return jobs_of(cases_of([str(path)]), methods or ("lm",), {"repeat": 1, **options})[0]

    return make


def test_a_row_holds_what_compare_found(job: MakeJob):
    prism = job("{id: prism, scene: {structure: prism}}", "dr", "table1")
    rows = measured(prism)
    compared = cgff_cli.compare(STRUCTURES / "prism.yaml", ["dr", "table1"], repeat=1)
    assert [row["method"] for row in rows] == ["cgff", "dr", "table1"]
    for row, method in zip(rows, compared.methods, strict=True):
        assert tuple(row) == ROW_FIELDS
        assert (row["suite"], row["case"], row["digest"]) == ("own", "prism", prism.digest)
        assert (row["nodes"], row["elements"], row["dimension"]) == (6, 12, 3)
        for name in ("verdict", "stable", "iterations", "energy", "distance_matrix_difference", "message"):
            assert row[name] == getattr(method, name)
        assert list(row["reached"]) == [f"{tolerance:.0e}" for tolerance in TOLERANCES]
        assert [point["iterations"] for point in row["reached"].values()] == [
            point.iterations for point in method.curve
        ]
    assert rows[0]["shape_error"] < 1e-12 < 1e-3 < rows[2]["shape_error"]


def test_a_method_that_fails_is_a_row_that_says_how(job: MakeJob):
    failed = measured(job("{id: prism, scene: {structure: prism}}", "schek"))[1]
    assert (failed["verdict"], failed["converged"], failed["seconds"] is not None) == ("failed", False, False)
    assert "needs held nodes" in failed["message"]
    assert all(point == {"iterations": None, "seconds": None} for point in failed["reached"].values())


@pytest.mark.parametrize(
    ("options", "outcome", "own", "fits"),
    [
        ("{}", "balanced-stable", "cgff", True),
        ("{}", "balanced-neutral", "cgff", False),
        ("{max_iterations: 1}", "max_iterations", "cgff", True),
        ("{objective: residual}", "balanced-stable", "cgff-residual", True),
        ("{method: table1}", "step_vanished", "table1", True),
    ],
)
def test_what_is_expected_is_expected_of_the_method_that_solve_would_run(
    job: MakeJob, options: str, outcome: str, own: str, fits: bool
):
    entry = f"{{id: a, scene: {{structure: prism}}, options: {options}, expect: {{outcome: {outcome}}}}}"
    rows = {row["method"]: row for row in measured(job(entry))}
    assert {name: row["as_expected"] for name, row in rows.items()} == dict.fromkeys(rows) | {own: fits}
    assert agrees(rows[own]["outcome"], outcome) is fits


def test_a_scene_refused_as_expected_is_one_row(job: MakeJob):
    entry = "{id: a, scene: {law: paper, nodes: {}}, expect: {outcome: refused}}"
    (row,) = measured(job(entry))
    assert tuple(row) == ROW_FIELDS
    assert (row["verdict"], row["outcome"], row["as_expected"]) == ("refused", "refused", True)
    assert "missing key 'elements'" in row["message"]


def test_the_options_of_a_case_hold_and_those_given_win(job: MakeJob):
    entry = "{id: a, scene: {structure: prism}, options: {tolerance: 1e-3, max_iterations: 3}}"
    assert measured(job(entry))[0]["verdict"] == "max_iterations"
    assert measured(job(entry, max_iterations=50))[0]["residual_relative"] > 1e-9


def test_two_answers_of_one_energy_are_one_shape(job: MakeJob):
    rows = measured(job("{id: prism, scene: {structure: prism}}", "lm", "dr", "table1"))
    assert [(row["same_energy_as"], row["same_answer"]) for row in rows] == [
        (None, None),
        ("cgff", True),
        ("cgff", True),
        (None, None),
    ]


@pytest.mark.parametrize(
    ("shift", "heavier", "told"),
    [
        (0.0, 0.0, ("cgff", True)),
        (1e-7, 0.0, ("cgff", False)),
        (1e-7, 1e-10, ("cgff", False)),
        (1e-7, 1e-8, (None, None)),
    ],
)
def test_two_shapes_are_told_where_their_energies_agree(
    job: MakeJob, monkeypatch: pytest.MonkeyPatch, shift: float, heavier: float, told: tuple
):
    compare = bench.compare

    def planted(*arguments, **options):
        found = compare(*arguments, **options)
        cgff, lm = found.methods
        X = lm.X.copy()
        X[0, 0] += shift
        moved = lm._replace(X=X, energy=lm.energy * (1 + heavier))
        return replace(found, methods=(cgff, moved))

    monkeypatch.setattr(bench, "compare", planted)
    row = measured(job("{id: prism, scene: {structure: prism}}"))[1]
    assert (row["same_energy_as"], row["same_answer"]) == told


def test_a_method_that_failed_or_ran_out_of_time_is_not_run_again():
    runs: list[tuple[str, int]] = []
    cgff_cli.compare(
        STRUCTURES / "prism.yaml",
        ["schek", "dr", "lm"],
        repeat=2,
        time_limit=2e-3,
        observer=lambda method, run: runs.append((method, run)),
    )
    assert {("schek", 1), ("dr", 1), ("cgff", 1)} <= set(runs)
    assert not {("schek", 2), ("dr", 2)} & set(runs)


def test_the_machine_is_named():
    assert set(machine()) == {"python", "numpy", "scipy", "processor", "cores"}
    assert all(machine().values())
