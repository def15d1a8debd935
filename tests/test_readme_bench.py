"""The pages' figures of `cgff bench` are those of the committed record, and they list what a row holds."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from cgff_cli.study.bench import BENCH_SCHEMA, ROW_FIELDS
from cgff_cli.study.case import BALANCED, STABILITIES
from cgff_cli.study.changes import CHANGES
from cgff_cli.study.suite import cases_of, standard
from tests.pages import ROOT, WORDS, blocks, code_in, rows, section
from tests.studies.readme_tables import BLOCK, MAKERS, PAGE, RECORD, filled

RECORDED = json.loads(RECORD.read_text())
TEXT = PAGE.read_text(encoding="utf-8")


def test_the_figures_are_those_of_the_record():
    assert sorted(found[2] for found in BLOCK.finditer(TEXT)) == sorted(MAKERS)
    assert filled(TEXT, RECORDED) == TEXT, "run python tests/studies/readme_tables.py"


def test_another_figure_would_be_seen():
    row = RECORDED["rows"][0]
    changed = {**row, "reached": {**row["reached"], "1e-04": {"iterations": 5, "seconds": 12.345}}}
    assert "| 12345 |" in filled(TEXT, {**RECORDED, "rows": [changed, *RECORDED["rows"][1:]]})


def test_the_record_is_of_the_suite_that_comes_with_the_program_by_all_methods():
    assert (RECORDED["schema"], RECORDED["options"]) == (BENCH_SCHEMA, {"methods": ["all"]})
    assert all(tuple(row) == ROW_FIELDS for row in RECORDED["rows"])
    names = list(dict.fromkeys(row["case"] for row in RECORDED["rows"]))
    assert names == [case.id for case in cases_of([standard()])]
    nodes = [row["nodes"] for row in RECORDED["rows"]]
    said = f"{len(names)} scenes of {min(nodes)} to {max(nodes)} nodes"
    assert " ".join(WORDS.split()).count(said) == 2


def test_cgff_has_an_answer_in_every_case_of_the_record_and_equal_energies_one_shape():
    assert all(row["converged"] and row["stable"] for row in RECORDED["rows"] if row["method"] == "cgff")
    assert not [(row["case"], row["method"]) for row in RECORDED["rows"] if row["same_answer"] is False]


def test_no_row_of_the_record_is_converged_but_where_the_scenes_own_forces_balance():
    balanced = [row["verdict"] in ("converged", "rounding_floor") for row in RECORDED["rows"]]
    assert [row["converged"] for row in RECORDED["rows"]] == balanced


def test_the_fields_of_a_row_are_those_of_the_program():
    assert [name for row in rows("Bench rows") for name in code_in(row[0])] == list(ROW_FIELDS)


def test_the_changes_and_outcomes_of_a_suite_are_those_of_the_program():
    named = set(code_in(section("Bench")))
    assert set(CHANGES) <= named
    assert {f"{word}-" for word in ("balanced", *BALANCED)} | set(STABILITIES) <= named


def test_the_suite_shown_can_be_measured(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    (shown,) = [block.text for block in blocks("yaml") if block.text.startswith("- ")]
    (tmp_path / "structures").symlink_to(ROOT / "structures")
    (tmp_path / "suite.yaml").write_text(shown)
    command = [sys.executable, "-m", "cgff_cli", "bench", "suite.yaml", "--dr", "--repeat", "1"]
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    ended = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")
    judged = {row["case"]: row["as_expected"] for row in json.loads(ended.stdout)["rows"][::2]}
    assert list(judged.values()) == [None, None, True, True]
