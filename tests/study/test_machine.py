"""The machine: rows in the order of the jobs, known ones not done again, errors in their place."""

import os
import select
import signal
import subprocess
import sys
import time
from concurrent.futures import BrokenExecutor
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import pytest

from cgff_cli.errors import OptionError, Problem, SceneError
from cgff_cli.study.hands import ONE_THREAD
from cgff_cli.study.machine import Journal, done

ROOT = Path(__file__).parents[2]


class Number(NamedTuple):
    digest: str
    value: int


def numbers(*values: int) -> list[Number]:
    return [Number(f"digest {value}", value) for value in values]


def squared(job: Number) -> list[int]:
    if job.value < 0:
        raise SceneError([Problem("a.yaml", 1, 2, f"{job.value} is less than nothing")])
    return [job.value * job.value]


def slow_first(job: Number) -> list[int]:
    time.sleep(0.3 if job.value == 0 else 0.0)
    return [job.value]


def environment(job: Number) -> dict[str, str]:
    return {name: os.environ[name] for name in ONE_THREAD}


def killed(job: Number) -> int:
    if job.value == 3:
        os._exit(1)
    return job.value


def interrupted(job: Number) -> int:
    """Interrupt the process that asked from within the second job, and hand in what there is of it."""
    try:
        if job.value == 1:
            os.kill(os.getppid(), signal.SIGINT)
        time.sleep(30.0 if job.value else 0.0)
    except KeyboardInterrupt:
        Path(f"{job.digest}-{job.value}").touch()
    return job.value


@pytest.mark.parametrize("processes", [1, 2])
def test_rows_come_in_the_order_of_the_jobs(processes: int):
    found = done(iter(numbers(*range(20))), slow_first, processes=processes)
    assert [(ended.job.value, ended.found) for ended in found] == [(k, [k]) for k in range(20)]


@pytest.mark.parametrize("processes", [1, 2])
def test_an_error_is_its_jobs_alone_and_comes_whole(processes: int):
    one, bad, other = done(numbers(2, -1, 3), squared, processes=processes)
    assert (one.found, other.found) == ([4], [9])
    assert isinstance(bad.error, SceneError)
    assert bad.error.problems == (Problem("a.yaml", 1, 2, "-1 is less than nothing"),)


def test_what_is_known_is_not_done_again():
    asked = []
    known = {"digest 1": [1]}
    found = list(done(numbers(1, 2), lambda job: asked.append(job.value) or squared(job), known))
    assert asked == [2]
    assert [(ended.found, ended.is_new) for ended in found] == [([1], False), ([4], True)]


def test_an_interrupt_is_the_last_that_comes():
    def stopped(job: Number) -> int:
        if job.value == 1:
            raise KeyboardInterrupt
        return job.value

    found = list(done(numbers(0, 1, 2), stopped))
    assert [ended.is_interrupt for ended in found] == [False, True]


def test_a_worker_that_is_killed_is_an_error_of_every_job_left():
    *_, last = found = list(done(numbers(*range(20)), killed, processes=2))
    assert len(found) == 20
    assert isinstance(last.error, BrokenExecutor)


def test_workers_have_one_thread_each():
    assert [ended.found for ended in done(numbers(1, 2), environment, processes=2)] == [ONE_THREAD] * 2


def test_workers_hand_in_what_they_have_when_this_process_is_interrupted(tmp_path: Path):
    jobs = [Number(str(tmp_path / "job"), value) for value in range(6)]
    *before, last = done(jobs, interrupted, processes=2)
    assert last.is_interrupt
    assert last.job.value == len(before) <= 1
    handed_in = [path.name for path in tmp_path.iterdir()]
    assert "job-1" in handed_in
    assert len(handed_in) <= 3  # what two workers had begun, and the one that was done


def test_a_journal_holds_what_a_run_that_was_killed_had_done(tmp_path: Path):
    path = str(tmp_path / "journal")
    with Journal(path) as journal:
        journal["a"] = [1, {"x": 0.1}]
        journal["b"] = [2]
    with Path(path).open("ab") as file:
        file.write(b'\n["c", [3\xff')
    with Journal(path) as again:
        assert again == {"a": [1, {"x": 0.1}], "b": [2]}
        again["c"] = [4]
    with Journal(path) as last:
        assert last["c"] == [4]


def test_runs_that_only_add_to_a_journal_share_it(tmp_path: Path):
    path = str(tmp_path / "journal")
    with Journal(path, alone=False) as one, Journal(path, alone=False) as other:
        one["a"] = 1
        other["b"] = 2
        one["a"] = 3
    with Journal(path) as found:
        assert found == {"a": 3, "b": 2}


@pytest.mark.parametrize(("first", "then"), [(True, True), (True, False), (False, True)])
def test_a_journal_wanted_alone_is_shared_with_nobody(tmp_path: Path, first: bool, then: bool):
    path = str(tmp_path / "journal")
    with (
        Journal(path, alone=first),
        pytest.raises(OptionError, match="another run is at work there"),
        Journal(path, alone=then),
    ):
        pass
    with Journal(path, alone=then):
        pass


def test_a_worker_ends_with_the_process_that_began_it():
    program = (
        "from tests.study.test_machine import numbers, at_ease\n"
        "from cgff_cli.study.machine import done\n"
        "list(done(numbers(1, 2), at_ease, processes=2))\n"
    )
    begun = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, start_new_session=True, cwd=ROOT
    )
    try:
        out = begun.stdout.fileno()
        assert len(os.read(out, 1) + os.read(out, 1)) == 2
        begun.kill()
        closed, *_ = select.select([out], [], [], 10.0)  # once no worker is left to write to it
        assert closed == [out]
        assert os.read(out, 1) == b""
    finally:
        with suppress(ProcessLookupError):
            os.killpg(begun.pid, signal.SIGKILL)
        begun.communicate()


def at_ease(job: Number) -> int:
    os.write(1, b"!")
    time.sleep(20.0)
    return job.value
