"""A sweep on a dask scheduler of its own: workers that die, that come late, and none at all."""

import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from time import monotonic, sleep

import pytest

from cgff_cli.errors import CgffError
from cgff_cli.study.dask_hands import _at_worker
from cgff_cli.study.digest import program
from tests.cli.test_processes import CGFF, ENVIRONMENT, PRISM

SWEEP = [
    *CGFF,
    "sweep",
    PRISM,
    "--set",
    "struts.EA=log:10:1e4:200",
    "--set",
    "verticals.rest_length=2.5:3.5:100",
]
DASK = {**ENVIRONMENT, **dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS"), "1")}
Worker = Callable[[], "subprocess.Popen[bytes]"]
Cluster = tuple[str, Worker]

pytestmark = pytest.mark.needs_distributed


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    """Give the address of a scheduler, and what starts a worker process for it."""
    running: list[subprocess.Popen[bytes]] = []
    log = tmp_path / "log"

    def start(*words: str) -> "subprocess.Popen[bytes]":
        with log.open("ab") as out:
            command = [sys.executable, "-m", "distributed.cli." + words[0], *words[1:], "--no-dashboard"]
            running.append(subprocess.Popen(command, env=DASK, cwd=tmp_path, stdout=out, stderr=out))
        return running[-1]

    start("dask_scheduler", "--host", "127.0.0.1", "--port", "0")
    address = _within(30.0, lambda: re.search(rb"Scheduler at:\s+(tcp://\S+)", log.read_bytes()))[1].decode()
    yield address, lambda: start("dask_worker", address, "--nthreads", "1", "--no-nanny")
    for process in running:
        process.kill()
        process.wait()


def _within(seconds: float, found: Callable[[], "re.Match[bytes] | bool | None"]) -> "re.Match[bytes]":
    until = monotonic() + seconds
    while not (value := found()) and monotonic() < until:
        sleep(0.05)
    assert value
    return value


def test_the_rows_are_the_same_though_a_worker_is_killed_and_another_comes_late(
    cluster: Cluster, tmp_path: Path
):
    address, worker = cluster
    first = [worker(), worker()]
    sweep = subprocess.Popen([*SWEEP, "--dask", address, "-o", "dask.csv"], env=ENVIRONMENT, cwd=tmp_path)
    part = tmp_path / "dask.csv.part"
    _within(30.0, lambda: part.exists() and part.stat().st_size > 1000)
    first[0].kill()
    worker()
    assert sweep.wait(timeout=60.0) == 0
    subprocess.run([*SWEEP, "-o", "here.csv"], env=ENVIRONMENT, cwd=tmp_path, check=True)
    assert (tmp_path / "dask.csv").read_bytes() == (tmp_path / "here.csv").read_bytes()


def test_a_scheduler_that_does_not_answer_is_told(tmp_path: Path):
    command = [*SWEEP, "--dask", "tcp://127.0.0.1:1", "-o", "rows.csv"]
    ended = subprocess.run(command, env=ENVIRONMENT, cwd=tmp_path, capture_output=True, text=True)
    assert ended.returncode == 1
    assert "cgff: dask scheduler tcp://127.0.0.1:1: no answer" in ended.stderr
    assert not os.path.exists(tmp_path / "rows.csv")


def test_a_worker_with_another_program_is_refused():
    with pytest.raises(
        CgffError, match=r"^dask: a worker runs another program, 0\.1\.0, than this one, 9\.9$"
    ):
        _at_worker("9.9 abc", abs, -1)
    assert _at_worker(program(), abs, -1) == 1
