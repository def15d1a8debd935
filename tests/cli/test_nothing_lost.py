"""A folder of results after a kill, a cut, a full disk, a folder that goes: resumed, it is whole."""

import fcntl
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from cgff_cli import pipeline
from cgff_cli.cli.solving import JOURNAL
from cgff_cli.study.machine import Journal
from tests.cli.conftest import STRUCTURES, Run

SCENES = [f"{number:02}.yaml" for number in range(20)]
WHOLE = ["solve", *SCENES, "--out-dir", "out", "--resume", "--summary", "rows.csv", "--format", "jsonl"]
ENVIRONMENT = {**os.environ, "PYTHONPATH": str(STRUCTURES.parent)}
LEFTOVER = ".cgff-0123456789ab.part"


@pytest.fixture(autouse=True)
def scenes(run: Run, bad: str) -> None:
    prism = Path("prism.yaml").read_text()
    for number, name in enumerate(SCENES):
        Path(name).write_text(prism.replace("1.8", f"1.7{number}"))
    Path("05.yaml").write_text(Path(bad).read_text())


def begin(folder: Path, *flags: str, most: int | None = None) -> subprocess.Popen[bytes]:
    """Start a run on the scenes as a process; most: bytes of a file that the system takes."""

    def limit() -> None:
        if most is not None:
            resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))

    command = [sys.executable, "-m", "cgff_cli", *WHOLE, *flags]
    for name in ("told", "words"):  # what outlives a run that is killed may still write to its own
        (folder / name).unlink(missing_ok=True)
    with (folder / "told").open("wb") as told, (folder / "words").open("wb") as words:
        out = told if most is None else subprocess.DEVNULL
        return subprocess.Popen(
            command, cwd=folder, env=ENVIRONMENT, stdout=out, stderr=words, preexec_fn=limit
        )


def left(folder: Path = Path()) -> dict[str, str]:
    """Return all files a run left, by name, without times and the journal."""
    names = ["told", "words", "rows.csv", *(f"out/{name}" for name in os.listdir(folder / "out"))]
    texts = {name: (folder / name).read_text() for name in names if not name.endswith(JOURNAL)}
    times = re.compile(r'"seconds": [^}]+|,[^,\n]+$', re.MULTILINE)
    return {name: times.sub("", text) if name != "words" else text for name, text in texts.items()}


def undisturbed() -> dict[str, str]:
    """Return what a run leaves that nothing happens to, and begin again."""
    assert begin(Path()).wait() == 3
    found = left()
    shutil.rmtree("out")
    Path("rows.csv").unlink()
    return found


def test_a_run_that_is_killed_and_resumed_leaves_what_one_in_peace_does():
    right = undisturbed()
    assert len(right) == 3 + 19
    for jobs, results in (("1", 0), ("1", 4), ("2", 2), ("2", 9)):
        running = begin(Path(), "--jobs", jobs)
        while running.poll() is None and len(list(Path().glob("out/*.json"))) < results:
            time.sleep(0.001)
        running.send_signal(signal.SIGKILL)
        running.wait()
    assert begin(Path()).wait() == 3
    assert left() == right


def test_a_file_larger_than_the_system_takes_is_left_out_and_made_up_for():
    right = undisturbed()
    # Room for a result, but not for the journal of all.
    size = max(len(text) for name, text in right.items() if name.startswith("out/")) + 200
    assert begin(Path(), most=size).wait() == 1
    words = Path("words").read_text().splitlines()
    assert f"cgff: out/{JOURNAL}: cannot be written: File too large" in words
    assert all(word.startswith(("cgff: ", "05.yaml:")) for word in words)
    assert left().keys() == right.keys()
    shutil.rmtree("out")
    assert begin(Path(), most=1000).wait() == 1
    assert os.listdir("out") == [JOURNAL]
    assert begin(Path()).wait() == 3
    assert left() == right


def test_what_an_undisturbed_run_wrote_is_left_alone_by_one_that_resumes(run: Run, solved: list[str]):
    run("solve", "00.yaml", "01.yaml", "--out-dir", "out")
    run("solve", "02.yaml", "--out-dir", "out")
    solved.clear()
    assert run("solve", "00.yaml", "01.yaml", "02.yaml", "--out-dir", "out", "--resume").exit_code == 0
    assert solved == []


@pytest.mark.parametrize("text", [b"", b"\0" * 4000, b'{"schema": "cgff-result/1"}'])
def test_a_result_that_is_not_as_it_was_written_is_solved_again(run: Run, solved: list[str], text: bytes):
    run("solve", "00.yaml", "01.yaml", "--out-dir", "out")
    Path("out/01.json").write_bytes(text)
    solved.clear()
    run("solve", "00.yaml", "01.yaml", "--out-dir", "out", "--resume")
    assert solved == ["01.yaml"]
    assert json.loads(Path("out/01.json").read_text())["converged"] is True


def test_a_result_that_another_run_has_replaced_is_solved_again(run: Run):
    for flags in ([], ["--tolerance", "1e-3"], ["--resume"]):
        run("solve", "00.yaml", "--out-dir", "out", *flags)
    assert json.loads(Path("out/00.json").read_text())["options"]["tolerance"] == 1e-10


def test_what_killed_writers_left_is_cleared_away_but_not_from_under_a_living_one(run: Run):
    run("solve", "00.yaml", "--out-dir", "out")
    living = LEFTOVER.replace("0", "f")
    for name in (f"out/{LEFTOVER}", LEFTOVER, f"out/{living}"):
        Path(name).write_text("half a resu")
    with Path(f"out/{living}").open("rb") as held:
        fcntl.flock(held, fcntl.LOCK_EX)
        run("solve", "00.yaml", "--out-dir", "out", "--resume", "--summary", "rows.csv")
    assert sorted(os.listdir("out")) == sorted([JOURNAL, living, "00.json"])
    assert not Path(LEFTOVER).exists()


@pytest.mark.parametrize(("alone", "flags"), [(True, []), (True, ["--resume"]), (False, ["--resume"])])
def test_a_folder_that_is_wanted_alone_is_refused_while_another_run_is_at_work(
    run: Run, alone: bool, flags: list[str]
):
    run("solve", "00.yaml", "--out-dir", "out")
    with Journal(f"out/{JOURNAL}", alone=alone):
        ended = run("solve", "00.yaml", "--out-dir", "out", *flags)
    assert (ended.exit_code, ended.stdout) == (2, "")
    assert ended.stderr == "cgff: out: another run is at work there; wait for its end\n"
    assert run("solve", "00.yaml", "--out-dir", "out", *flags).exit_code == 0


def test_runs_that_do_not_resume_share_a_folder(run: Run):
    os.mkdir("out")
    with Journal(f"out/{JOURNAL}", alone=False):
        assert run("solve", "00.yaml", "--out-dir", "out").exit_code == 0


@pytest.mark.parametrize("flags", [["--resume"], []])
def test_a_folder_that_goes_meanwhile_costs_no_other_scene(
    run: Run, monkeypatch: pytest.MonkeyPatch, flags: list[str]
):
    real = pipeline.solve

    def solve(scene, **options):
        if scene.path == "01.yaml":
            shutil.rmtree("out")
        if scene.path == "02.yaml":
            os.mkdir("out")
        return real(scene, **options)

    monkeypatch.setattr(pipeline, "solve", solve)
    ended = run("solve", "00.yaml", "01.yaml", "02.yaml", "--out-dir", "out", *flags)
    assert ended.exit_code == 1
    assert ended.stderr == f"cgff: out/01.json: cannot be written: there is no folder {os.getcwd()}/out\n"
    assert os.listdir("out") == ["02.json"]


def test_a_page_is_told_again(run: Run):
    arguments = ("solve", "00.yaml", "--out-dir", "out", "--resume", "--format", "table")
    before, again = run(*arguments), run(*arguments)
    assert [ended.stdout.split("\n")[0] for ended in (before, again)] == [
        "Triangular prism, Table IV  converged"
    ] * 2
