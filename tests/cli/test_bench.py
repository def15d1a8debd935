"""`cgff bench`: rows by case and method, resumed where it stopped; exit codes and words."""

import csv
import io
import json
import re
from pathlib import Path

import pytest

from cgff_cli.study import bench
from cgff_cli.study.bench import ROW_FIELDS, TIME_LIMIT
from tests.cli.conftest import Run

HARD = Path(__file__).parents[1] / "hard"
ENDS = ("hexagon", "mast")
"""One of which fdm finds another equilibrium, and one so stiff that schek's rounding unbalances it."""
QUICKLY = ("--lm", "--repeat", "1")

SUITE = """\
- {id: one/prism, scene: {file: prism.yaml}}
- {id: one/bracket, scene: {file: bracket.yaml}, expect: {outcome: balanced-stable}}
- {id: two/net, scene: {structure: cable-net}}
"""


@pytest.fixture(autouse=True)
def suite(run: Run) -> None:
    Path("suite.yaml").write_text(SUITE)


@pytest.fixture
def seen(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the cases measured so far; one that "stop at ID" in here names is interrupted."""
    names: list[str] = []
    real = bench.measured

    def counted(job, observer=None):
        if f"stop at {job.case.id}" in names:
            raise KeyboardInterrupt
        names.append(job.case.id)
        return real(job, observer)

    monkeypatch.setattr(bench, "measured", counted)
    return names


def test_the_json_has_a_row_per_case_and_method(run: Run):
    ended = run("bench", "suite.yaml", *QUICKLY)
    assert (ended.exit_code, ended.stderr) == (0, "")
    found = json.loads(ended.stdout)
    assert list(found) == ["schema", "tool", "machine", "options", "rows"]
    assert (found["schema"], found["tool"]["name"]) == ("cgff-bench/1", "cgff")
    assert found["options"] == {"repeat": 1, "methods": ["lm"]}
    assert [(row["suite"], row["case"], row["method"]) for row in found["rows"]] == [
        ("suite", case, method)
        for case in ("one/prism", "one/bracket", "two/net")
        for method in ("cgff", "lm")
    ]
    assert all(tuple(row) == ROW_FIELDS for row in found["rows"])


def test_an_interrupted_run_keeps_what_it_has_and_goes_on_there(run: Run, seen: list[str]):
    seen.append("stop at two/net")
    ended = run("bench", "suite.yaml", *QUICKLY, "-o", "out.json")
    assert (ended.exit_code, ended.stderr) == (130, "cgff: two/net: interrupted\n")
    before = json.loads(Path("out.json").read_text())["rows"]
    assert [row["case"] for row in before] == ["one/prism"] * 2 + ["one/bracket"] * 2
    seen.clear()
    assert run("bench", "suite.yaml", *QUICKLY, "-o", "out.json").exit_code == 0
    assert seen == ["two/net"]
    after = json.loads(Path("out.json").read_text())["rows"]
    assert after[:4] == before
    assert [row["case"] for row in after[4:]] == ["two/net"] * 2


def test_the_file_is_written_after_every_case(run: Run, monkeypatch: pytest.MonkeyPatch):
    real, held = bench.measured, []

    def looking(job, observer=None):
        out = Path("out.json")
        held.append(len(json.loads(out.read_text())["rows"]) if out.exists() else 0)
        return real(job, observer)

    monkeypatch.setattr(bench, "measured", looking)
    run("bench", "suite.yaml", *QUICKLY, "-o", "out.json")
    assert held == [0, 2, 4]


def test_a_case_that_breaks_leaves_the_others(run: Run, monkeypatch: pytest.MonkeyPatch):
    real = bench.measured

    def broken(job, observer=None):
        if job.case.id == "one/bracket":
            raise ZeroDivisionError("by zero")
        return real(job, observer)

    monkeypatch.setattr(bench, "measured", broken)
    ended = run("bench", "suite.yaml", *QUICKLY, "-o", "out.json")
    assert ended.exit_code == 1
    assert ended.stderr.startswith("cgff: one/bracket: not measured\ncgff: unexpected error: ZeroDivision")
    rows = json.loads(Path("out.json").read_text())["rows"]
    assert [row["case"] for row in rows] == ["one/prism"] * 2 + ["two/net"] * 2


@pytest.mark.parametrize(
    ("flags", "measured_anew"),
    [
        ((), []),
        (("--again", "--only", "two"), ["two/net"]),
        (("--again",), ["one/prism", "one/bracket", "two/net"]),
        (("--tolerance", "1e-9"), ["one/prism", "one/bracket", "two/net"]),
        (("--dr",), ["one/prism", "one/bracket", "two/net"]),
    ],
)
def test_only_what_changed_is_measured_anew(
    run: Run, seen: list[str], flags: tuple[str, ...], measured_anew: list[str]
):
    run("bench", "suite.yaml", *QUICKLY, "-o", "out.json")
    seen.clear()
    assert run("bench", "suite.yaml", *QUICKLY, *flags, "-o", "out.json").exit_code == 0
    assert seen == measured_anew
    cases = [row["case"] for row in json.loads(Path("out.json").read_text())["rows"]]
    assert list(dict.fromkeys(cases)) == ["one/prism", "one/bracket", "two/net"]


def test_a_scene_or_a_case_that_changed_is_measured_anew(run: Run, seen: list[str]):
    run("bench", "suite.yaml", *QUICKLY, "-o", "out.json")
    seen.clear()
    Path("prism.yaml").write_text(Path("prism.yaml").read_text().replace("7.007", "7.008"))
    Path("suite.yaml").write_text(SUITE.replace("cable-net}", "cable-net, offset: [1, 0, 0]}"))
    run("bench", "suite.yaml", *QUICKLY, "-o", "out.json")
    assert seen == ["one/prism", "two/net"]


def test_a_case_no_longer_in_the_suite_leaves_the_file(run: Run):
    run("bench", "suite.yaml", *QUICKLY, "-o", "out.json")
    Path("suite.yaml").write_text(SUITE.splitlines()[0])
    run("bench", "suite.yaml", *QUICKLY, "-o", "out.json")
    assert {row["case"] for row in json.loads(Path("out.json").read_text())["rows"]} == {"one/prism"}


def test_only_words_in_the_id_choose_cases(run: Run):
    text = run("bench", "suite.yaml", *QUICKLY, "--only", "prism", "--only", "net").stdout
    assert {row["case"] for row in json.loads(text)["rows"]} == {"one/prism", "two/net"}
    ended = run("bench", "suite.yaml", *QUICKLY, "--only", "tower")
    assert ended.exit_code == 2
    assert "no case has 'tower' in its id" in ended.stderr


def test_without_a_suite_it_takes_the_one_that_comes_with_the_program(run: Run):
    found = json.loads(run("bench", "--only", "structures/prism", *QUICKLY).stdout)
    assert [(row["suite"], row["case"]) for row in found["rows"]] == [("standard", "structures/prism")] * 2


def test_a_scene_is_a_case_by_itself(run: Run):
    rows = json.loads(run("bench", "prism.yaml", "suite.yaml", "--only", "prism", *QUICKLY).stdout)["rows"]
    assert [(row["suite"], row["case"]) for row in rows[::2]] == [(None, "prism"), ("suite", "one/prism")]


def test_all_methods_are_run_unless_some_are_named(run: Run):
    rows = json.loads(run("bench", "prism.yaml", "--repeat", "1").stdout)["rows"]
    assert {"fsolve", "lbfgs", "dr", "fdm", "table1", "cgff-residual"} < {row["method"] for row in rows}


def test_hard_scenes_say_whether_they_end_as_expected(run: Run):
    rows = json.loads(run("bench", str(HARD / "ends.yaml"), "--only", "strut", *QUICKLY).stdout)["rows"]
    judged = [row["as_expected"] for row in rows if row["as_expected"] is not None]
    assert len(judged) == len({row["case"] for row in rows}) > 5
    assert all(judged)


def test_the_table_fits_a_terminal_and_ends_in_a_summary(run: Run):
    page = run("bench", "suite.yaml", "--schek", "--dr", "--repeat", "1", "--format", "table").stdout
    lines = page.splitlines()
    assert lines[0] == "one/prism  6 nodes, 12 elements, 3-D"
    assert lines[1].split()[:6] == ["method", "verdict", "stability", "residual", "shape", "iterations"]
    assert lines[1].endswith("to 1e-04  to 1e-08  to 1e-12")
    assert lines[3].split()[:3] == ["schek", "failed", "-"]
    assert "one/bracket  3 nodes, 2 elements, 2-D, as expected" in lines
    assert all(len(line) <= 110 for line in lines[:-3])
    summary = " ".join(page[page.rindex("  method") :].split())
    assert re.search(r" schek 3 1 0 0 2 - - - dr 3 3 0 0 0 ", summary)
    assert "measured 3 cases, 9 rows" in summary
    assert "expected 1 of 1 cases end as their suite says" in summary
    assert re.search(r"it is one shape to 1e-8 in (\d) of \1 pairs$", summary)


def test_the_summary_counts_another_equilibrium_by_itself_and_names_who_found_cgffs_shape(run: Run):
    Path("suite.yaml").write_text("".join(f"- {{id: {n}, scene: {{structure: {n}}}}}\n" for n in ENDS))
    page = run("bench", "suite.yaml", "--fdm", "--repeat", "1", "--format", "table").stdout
    summary = " ".join(page[page.rindex("  method") :].split())
    assert "method cases equilibrium another out of time failed " in summary
    assert re.search(r" cgff 2 2 0 0 0 .* fdm 1 0 1 0 0 - - - schek 1 0 0 0 0 - - - ", summary)
    assert "cgff's shape found to 1e-8, but out of balance by the difference: mast (schek)" in summary


def test_a_table_beside_a_file_is_of_what_was_asked_for(run: Run, seen: list[str]):
    run("bench", "suite.yaml", *QUICKLY, "-o", "out.json")
    seen.clear()
    page = run("bench", "suite.yaml", *QUICKLY, "-o", "out.json", "--only", "one", "--format", "table").stdout
    assert seen == []
    assert page.startswith("one/prism  ")
    assert "two/net" not in page
    assert len(json.loads(Path("out.json").read_text())["rows"]) == 6


def test_csv_has_a_line_per_case_and_method(run: Run):
    run("bench", "suite.yaml", "--schek", "--repeat", "1", "-o", "out.csv")
    rows = list(csv.DictReader(io.StringIO(Path("out.csv").read_text())))
    assert [(row["case"], row["method"]) for row in rows[:2]] == [
        ("one/prism", "cgff"),
        ("one/prism", "schek"),
    ]
    assert float(rows[0]["seconds_to_1e-08"]) > 0.0
    assert (rows[1]["verdict"], rows[1]["seconds_to_1e-02"], rows[1]["energy"]) == ("failed", "", "")


def test_cgff_not_as_expected_or_without_an_answer_is_exit_code_4(run: Run):
    wrong = SUITE.replace("balanced-stable", "refused")
    Path("suite.yaml").write_text(wrong)
    ended = run("bench", "suite.yaml", *QUICKLY)
    assert ended.exit_code == 4
    assert ended.stderr.startswith("cgff: one/bracket: converged-stable where refused is expected: ")
    ended = run("bench", "prism.yaml", *QUICKLY, "--max-iterations", "2")
    assert ended.exit_code == 4
    assert ended.stderr.startswith("cgff: prism: max_iterations: ")


def test_a_mistake_in_a_suite_is_exit_code_3_and_nothing_is_measured(run: Run, seen: list[str]):
    Path("suite.yaml").write_text(SUITE + "- {id: three, scene: {structure: prsm}}\n- {id: 4, scen: {}}\n")
    ended = run("bench", "suite.yaml", *QUICKLY)
    assert (ended.exit_code, ended.stdout, seen) == (3, "", [])
    assert "suite.yaml:5:11: [4]: unknown key 'scen'; did you mean 'scene'?" in ended.stderr


def test_a_missing_file_is_exit_code_3(run: Run):
    ended = run("bench", "nowhere.yaml", *QUICKLY)
    assert ended.exit_code == 3
    assert ended.stderr == "nowhere.yaml: cannot read the file: no such file\n"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("-o", "out.txt"), "the name must end in .json"),
        (("-o", "out.csv", "--format", "json"), "--format json and -o out.csv disagree"),
        (("-o", "prism.yaml"), "the name must end in .json"),
        (("-o", "other.json"), "other.json is there and holds no cgff-bench/1; name another file"),
        (("--newton",), "--newton"),
    ],
)
def test_wrong_usage_is_refused_before_anything_is_measured(
    run: Run, seen: list[str], arguments: tuple[str, ...], words: str
):
    Path("other.json").write_text('{"schema": "cgff-compare/1"}')
    ended = run("bench", "suite.yaml", *QUICKLY, *arguments)
    assert (ended.exit_code, seen) == (2, [])
    assert words in ended.stderr
    assert Path("other.json").read_text() == '{"schema": "cgff-compare/1"}'


def test_the_help_tells_the_time_limit_that_holds(run: Run):
    assert f"Seconds after which a run is ended. Default: {TIME_LIMIT:g}." in " ".join(
        run("bench", "--help").stdout.split()
    )
