"""`cgff sweep`: rows as CSV and JSON Lines, files that are gone on with, shards, and how it ends."""

import csv
import json
import os
import random
import signal
import subprocess
from pathlib import Path
from time import monotonic, sleep

import pytest

import cgff_cli
from cgff_cli.report.rows_file import RowsFile, RowsStream
from cgff_cli.study.path import followed
from cgff_cli.study.sweep import planned
from tests.cli.conftest import STRUCTURES, Run
from tests.cli.test_processes import CGFF, ENVIRONMENT
from tests.study.test_path import TRUSS

PRISM = str(STRUCTURES / "prism.yaml")
SMALL = ("sweep", "prism.yaml", "--set", "struts.EA=10,1000", "--scale", "verticals.rest_length=0.8:1:3")
LARGE = ("--set", "struts.EA=log:10:1e4:100", "--set", "verticals.rest_length=2.5:3.5:60", "--out", "node:n1")
COLUMNS = ("verdict", "converged", "stability", "iterations", "residual_relative", "energy")


def whole(flags: tuple[str, ...] = LARGE) -> bytes:
    """Return the rows of an undisturbed sweep."""
    return subprocess.run(
        [*CGFF, "sweep", PRISM, *flags], env=ENVIRONMENT, capture_output=True, check=True
    ).stdout


def test_columns_are_the_keys_then_how_it_ended_then_what_is_asked_for(run: Run):
    ended = run(*SMALL, "--out", "force:struts", "--out", "node:n1", "--out", "slack")
    rows = list(csv.DictReader(ended.stdout.splitlines()))
    assert (ended.exit_code, ended.stderr, len(rows)) == (0, "", 6)
    more = ("force:struts.min", "force:struts.max", "node:n1.x", "node:n1.y", "node:n1.z", "slack")
    assert tuple(rows[0]) == ("struts.EA", "verticals.rest_length", *COLUMNS, *more)
    assert [float(row["verticals.rest_length"]) for row in rows] == [0.8, 0.9, 1.0] * 2
    assert {(row["converged"], row["slack"]) for row in rows} == {("true", "0")}


def test_lines_of_json_hold_the_same_numbers(run: Run):
    assert run(*SMALL, "-o", "rows.jsonl").exit_code == 0
    lines = list(map(json.loads, Path("rows.jsonl").read_text().splitlines()))
    rows = list(csv.DictReader(run(*SMALL, "--no-header").stdout.splitlines(), fieldnames=tuple(lines[0])))
    assert [row["verticals.rest_length"] for row in lines] == [0.8, 0.9, 1.0] * 2
    assert [row["energy"] for row in lines] == [float(row["energy"]) for row in rows]


def test_rows_without_equilibrium_are_written_and_end_with_4(run: Run):
    ended = run(*SMALL, "--max-iterations", "1", "-o", "rows.csv")
    assert (ended.exit_code, ended.stderr) == (4, "cgff: prism.yaml: 6 rows did not converge\n")
    assert Path("rows.csv").read_text().count("max_iterations,false,,1,") == 6
    assert run(*SMALL, "--max-iterations", "1", "-o", "rows.csv", "--resume").exit_code == 4


def test_loads_that_nothing_balances_end_with_3(run: Run):
    ended = run("sweep", "prism.yaml", "--set", "loads.n1.x=0,1")
    told = (
        "cgff: prism.yaml: 1 row bad_scene: nothing can balance the loads, "
        "or no rest length gives the pretension\n"
    )
    assert (ended.exit_code, ended.stderr) == (3, told)


def test_a_table_stands_beside_what_tells_how_it_was_made(run: Run):
    run(*SMALL, "-o", "rows.csv")
    told = json.loads(Path("rows.csv.sweep.json").read_text())
    assert (told["rows"], told["rows_done"], told["version"]) == (6, 6, "0.1.0")
    assert told["--set"] == ["struts.EA=10,1000"]
    assert told["bytes"] == os.path.getsize("rows.csv")
    assert not Path("rows.csv.part").exists()


def test_resume_does_nothing_where_all_is_done_and_begins_where_nothing_is(run: Run):
    assert run(*SMALL, "-o", "rows.csv", "--resume").exit_code == 0
    before = os.stat("rows.csv")
    assert run(*SMALL, "-o", "rows.csv", "--resume").exit_code == 0
    assert os.stat("rows.csv").st_mtime_ns == before.st_mtime_ns


@pytest.mark.parametrize(
    ("flags", "told"),
    [
        (("--set", "struts.EA=10,100"), '--set was ["struts.EA=10,1000"], is ["struts.EA=10,100"]'),
        (("--set", "struts.EA=10,1000", "--tolerance", "1e-8"), "--tolerance was 1e-10, is 1e-08"),
        (("--set", "struts.EA=10,1000", "--out", "slack"), '--out was [], is ["slack"]'),
        (("--set", "struts.EA=10,1000", "--shard", "1/2"), '--shard was "1/1", is "1/2"'),
    ],
)
def test_resume_refuses_another_sweep_and_says_what_differs(run: Run, flags: tuple[str, ...], told: str):
    run("sweep", "prism.yaml", "--set", "struts.EA=10,1000", "-o", "rows.csv")
    before = Path("rows.csv").read_bytes()
    ended = run("sweep", "prism.yaml", *flags, "-o", "rows.csv", "--resume")
    assert (ended.exit_code, ended.stderr) == (2, f"cgff: rows.csv was begun otherwise: {told}\n")
    assert Path("rows.csv").read_bytes() == before


def test_resume_refuses_another_scene_a_changed_table_and_one_of_which_nothing_is_known(run: Run):
    run(*SMALL, "-o", "rows.csv")
    text = Path("prism.yaml").read_text()
    Path("prism.yaml").write_text(
        text.replace("hooke", "paper") if "law: hooke" in text else text.replace("paper", "hooke")
    )
    assert "rows.csv was begun otherwise: scene was" in run(*SMALL, "-o", "rows.csv", "--resume").stderr
    Path("prism.yaml").write_text(text)
    Path("rows.csv").write_text("edited")
    changed = run(*SMALL, "-o", "rows.csv", "--resume")
    assert (changed.exit_code, changed.stderr) == (
        2,
        "cgff: rows.csv has been changed since it was written\n",
    )
    os.unlink("rows.csv.sweep.json")
    unknown = run(*SMALL, "-o", "rows.csv", "--resume")
    assert unknown.stderr == "cgff: rows.csv has no rows.csv.sweep.json beside it to go on from\n"
    assert Path("rows.csv").read_text() == "edited"


@pytest.mark.parametrize("flags", [("--resume",), ("--resume", "-o", "/dev/stdout")])
def test_what_is_not_a_file_cannot_be_gone_on_with(run: Run, flags: tuple[str, ...]):
    assert run(*SMALL, *flags).stderr.endswith("Error: --resume needs -o FILE\n")


@pytest.mark.parametrize(
    ("flags", "told"),
    [
        (("--set", "struts.EA"), "must be KEY=VALUES, got 'struts.EA'"),
        (("--set", "struts.EA=1", "--set", "struts.EA=2"), "--set struts.EA is given twice"),
        (("--set", "struts.EA=1", "--shard", "3/2"), "must lie between 1/2 and 2/2, got '3/2'"),
        (("--set", "struts.EA=1", "--shard", "x"), "must be i/n, such as 2/10, got 'x'"),
        (("--set", "struts.EA=1", "-o", "rows.json"), "-o rows.json: the name must end in .csv or .jsonl"),
        (
            ("--set", "struts.EA=1", "-o", "a.csv", "--format", "jsonl"),
            "--format jsonl and -o a.csv disagree",
        ),
        (("--set", "struts.EA=1", "-o", "prism.csv"), ""),
    ],
)
def test_a_wrong_command_line_is_told_before_the_scene_is_read(run: Run, flags: tuple[str, ...], told: str):
    ended = run("sweep", "prism.yaml", *flags)
    assert ended.exit_code == (2 if told else 0)
    assert told in ended.stderr


def test_shards_put_together_are_the_whole(run: Run):
    flags = ("sweep", "prism.yaml", *LARGE)
    parts = [run(*flags, "--shard", f"{i}/3", *(["--no-header"] if i > 1 else [])).stdout for i in (1, 2, 3)]
    assert "".join(parts).encode() == whole()
    assert min(map(len, parts)) > 1000


def test_rows_are_the_same_whoever_works_them_out(tmp_path: Path):
    flags = [*CGFF, "sweep", PRISM, *LARGE, "--jobs", "2", "-o", "rows.csv"]
    subprocess.run(flags, env=ENVIRONMENT, cwd=tmp_path, check=True)
    assert (tmp_path / "rows.csv").read_bytes() == whole()


def test_a_sweep_killed_at_any_moment_goes_on_to_the_same_bytes(tmp_path: Path):
    moments, expected = random.Random(5), whole()
    command = [*CGFF, "sweep", PRISM, *LARGE, "-o", "rows.csv", "--resume"]
    for _ in range(4):
        running = subprocess.Popen(command, env=ENVIRONMENT, cwd=tmp_path)
        sleep(moments.uniform(0.2, 0.8))
        running.send_signal(signal.SIGKILL)
        running.wait()
        assert not (tmp_path / "rows.csv").exists() or (tmp_path / "rows.csv").read_bytes() == expected
    subprocess.run(command, env=ENVIRONMENT, cwd=tmp_path, check=True)
    assert (tmp_path / "rows.csv").read_bytes() == expected
    assert sorted(path.name for path in tmp_path.iterdir()) == ["rows.csv", "rows.csv.sweep.json"]


def test_rows_under_way_are_locked_by_the_process_that_writes_them(tmp_path: Path):
    command = [*CGFF, "sweep", PRISM, *LARGE, "--set", "triangles.EA=1:2:40", "-o", "rows.csv"]
    first = subprocess.Popen(command, env=ENVIRONMENT, cwd=tmp_path, stderr=subprocess.PIPE)
    until = monotonic() + 20.0
    while not (tmp_path / "rows.csv.sweep.json").exists() and monotonic() < until:
        sleep(0.02)
    second = subprocess.run(command, env=ENVIRONMENT, cwd=tmp_path, capture_output=True)
    assert (second.returncode, second.stderr) == (2, b"cgff: rows.csv is being written by another run\n")
    first.send_signal(signal.SIGINT)
    told = first.communicate()[1].decode()
    assert first.returncode == 130
    assert told.endswith("--resume goes on from there\n")
    done = json.loads((tmp_path / "rows.csv.sweep.json").read_text())
    assert done["bytes"] == os.path.getsize(tmp_path / "rows.csv.part")


def test_a_full_disk_is_told_and_what_is_there_is_gone_on_with(tmp_path: Path):
    command = [*CGFF, "sweep", PRISM, *LARGE, "-o", "rows.csv", "--resume"]
    limited = ["bash", "-c", f"ulimit -f 300; trap '' XFSZ; exec {' '.join(command)}"]
    full = subprocess.run(limited, env=ENVIRONMENT, cwd=tmp_path, capture_output=True, text=True)
    assert full.returncode == 1
    assert "cgff: rows.csv.part: cannot be written: File too large" in full.stderr
    assert not (tmp_path / "rows.csv").exists()
    assert json.loads((tmp_path / "rows.csv.sweep.json").read_text())["rows_done"] > 0
    subprocess.run(command, env=ENVIRONMENT, cwd=tmp_path, check=True)
    assert (tmp_path / "rows.csv").read_bytes() == whole()


def test_a_path_tells_where_an_equilibrium_is_lost_and_goes_on_where_it_was_killed(run: Run):
    Path("truss.yaml").write_text(TRUSS)
    flags = ("sweep", "truss.yaml", "--set", "loads.b.y=0:-6:13", "--follow", "--out", "node:b")
    ended = run(*flags, "-o", "rows.csv")
    told = "cgff: truss.yaml: an equilibrium is lost at loads.b.y = -3.83837398\n"
    assert (ended.exit_code, ended.stderr) == (0, told)
    expected, side = Path("rows.csv").read_bytes(), json.loads(Path("rows.csv.sweep.json").read_text())
    for rows in (3, 9):  # as a kill would have left it
        lines = expected.splitlines(keepends=True)[: rows + 1]
        stops = list(followed(planned(cgff_cli.load("truss.yaml"), set={"loads.b.y": "0:-6:13"})).stops())
        here = stops[rows - 1].here
        kept = {"here": {**vars(here), "shape": here.shape.tolist()}}
        counts = {"rows_done": rows, "bytes": len(b"".join(lines)), "kept": kept}
        Path("rows.csv.part").write_bytes(b"".join(lines) + b"-3.5,conv")
        Path("rows.csv.sweep.json").write_text(json.dumps(side | counts))
        os.unlink("rows.csv")
        assert run(*flags, "-o", "rows.csv", "--resume").exit_code == 0
        assert Path("rows.csv").read_bytes() == expected


def test_rows_of_a_path_without_a_jump_are_counted_with_the_reason(run: Run):
    ended = run("sweep", "prism.yaml", "--set", "struts.rest_length=8:5:7", "--follow", "-o", "rows.csv")
    told = (
        "cgff: prism.yaml: 3 rows without jump: the shape before is not stable, "
        "so that none is predicted from it\n"
    )
    assert (ended.exit_code, ended.stderr) == (0, told)
    assert json.loads(Path("rows.csv.sweep.json").read_text())["no_jump"] == 3


def test_rows_without_stability_are_counted_where_it_was_asked_for(run: Run, monkeypatch: pytest.MonkeyPatch):
    flags = ("sweep", "bracket.yaml", "--set", "tie.EA=1000,1100")
    assert run(*flags, "--analysis", "never").stderr == ""
    monkeypatch.setattr("cgff_cli.many._suits", lambda structure, options: False)  # as large ones are solved
    monkeypatch.setattr("cgff_cli.many.stability_of", lambda solution, options: {"stability": None})
    told = "2 rows without stability: forces left over blur its sign; a smaller --tolerance may tell"
    assert run(*flags).stderr == f"cgff: bracket.yaml: {told}\n"
    assert run(*flags, "--analysis", "never").stderr == ""


def test_a_path_on_a_full_disk_goes_on_from_the_last_row_that_is_there(tmp_path: Path):
    (tmp_path / "truss.yaml").write_text(TRUSS)
    flags = ["sweep", "truss.yaml", "--set", "loads.b.y=0:-1:101", "--follow"]
    command = [*CGFF, *flags, "-o", "rows.csv", "--resume"]
    limited = ["bash", "-c", f"ulimit -f 5; trap '' XFSZ; exec {' '.join(command)}"]
    full = subprocess.run(limited, env=ENVIRONMENT, cwd=tmp_path, capture_output=True, text=True)
    refused, done = full.stderr.splitlines()
    assert (full.returncode, refused) == (1, "cgff: rows.csv.part: cannot be written: File too large")
    assert done.endswith(" of 101 rows done; --resume goes on from there")
    subprocess.run(command, env=ENVIRONMENT, cwd=tmp_path, check=True)
    whole = subprocess.run([*CGFF, *flags], env=ENVIRONMENT, cwd=tmp_path, capture_output=True, check=True)
    assert (tmp_path / "rows.csv").read_bytes() == whole.stdout


def test_a_path_that_is_none_leaves_no_files(run: Run):
    ended = run(*SMALL, "--follow", "-o", "rows.csv")
    told = "cgff: a path follows one swept number, through all its values in their order\n"
    assert (ended.exit_code, ended.stderr) == (2, told)
    assert sorted(path.name for path in Path().iterdir()) == ["bracket.yaml", "prism.yaml"]


@pytest.mark.parametrize("text", ["", '{"rows_done": 3', "[1]"])
def test_a_sidecar_cut_short_is_told_and_overcome_without_resume(run: Run, text: str):
    run(*SMALL, "-o", "rows.csv")
    expected = Path("rows.csv").read_bytes()
    Path("rows.csv.sweep.json").write_text(text)
    ended = run(*SMALL, "-o", "rows.csv", "--resume")
    assert ended.exit_code == 1
    assert ended.stderr.endswith(
        "is not what a sweep leaves beside its rows; without --resume all begins anew\n"
    )
    assert run(*SMALL, "-o", "rows.csv").exit_code == 0
    assert Path("rows.csv").read_bytes() == expected


def test_who_reads_only_the_head_is_told_nothing(tmp_path: Path):
    command = f"{' '.join(CGFF)} sweep {PRISM} {' '.join(LARGE)} | head -1; exit ${{PIPESTATUS[0]}}"
    ended = subprocess.run(["bash", "-c", command], env=ENVIRONMENT, capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (141, "")
    assert ended.stdout.startswith("struts.EA,verticals.rest_length,verdict")


def test_a_worker_that_was_killed_is_told_in_words(tmp_path: Path):
    command = [*CGFF, "sweep", PRISM, *LARGE, "--set", "triangles.EA=1:2:40", "--jobs", "2", "-o", "a.csv"]
    running = subprocess.Popen(command, env=ENVIRONMENT, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
    until, workers = monotonic() + 20.0, []
    while len(workers) < 3 and monotonic() < until:  # one more keeps track of them
        sleep(0.1)
        workers = Path(f"/proc/{running.pid}/task/{running.pid}/children").read_text().split()
    os.kill(int(workers[-1]), signal.SIGKILL)
    told = running.communicate()[1].splitlines()
    assert running.returncode == 1
    assert told[0] == "cgff: a worker process was killed, maybe for want of memory"
    assert told[1].endswith("--resume goes on from there")


def test_what_comes_after_the_end_belongs_to_the_next_run(tmp_path: Path):
    path, told = str(tmp_path / "rows.csv"), {"digest": "x"}
    with RowsFile(path, 1, told, False) as first:
        first.add("1\n", rows_done=1)
        first.finish()
        with RowsFile(path, 1, told, False):
            pass
        before = (tmp_path / "rows.csv.sweep.json").read_text()
    assert json.loads(before)["rows_done"] == 0
    assert (tmp_path / "rows.csv.sweep.json").read_text() == before


def test_rows_reach_who_reads_them_as_they_come(tmp_path: Path):
    with (tmp_path / "rows").open("w") as out:
        RowsStream(out).add("1,2\n", rows_done=1)
        assert (tmp_path / "rows").read_text() == "1,2\n"


@pytest.mark.parametrize("flags", [("--jobs", "2"), ("--shard", "1/2"), ("--dask", "tcp://localhost:1")])
def test_a_path_is_not_cut_into_parts(run: Run, flags: tuple[str, ...]):
    ended = run("sweep", "prism.yaml", "--set", "struts.EA=1,2", "--follow", *flags)
    assert ended.stderr.endswith("Error: --follow goes step by step: without --jobs, --shard and --dask\n")
