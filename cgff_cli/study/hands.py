"""Who does the jobs of the machine: this process, or a few of its own.

Hands begin a job and give back what waits for its end. Others, such as `dask_hands` on other machines, are
one more function like `_pool`, and an argument of `done`.
"""

import os
import signal
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import partial
from importlib import import_module
from typing import Any, NamedTuple

AHEAD = 4
"""Jobs begun for each process: enough for it never to wait, few enough for what they hold."""

ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""What makes each worker round as any other, and leaves the others their cores."""

INTERRUPT = (signal.SIGINT,)

LOADED = ("cgff_cli.pipeline", "cgff_cli.scene.read", "cgff_cli.scene.yaml_text", "cgff_cli.scene.json_text")
"""What a worker imports before it heeds interrupts: one that falls into an import may get lost there."""


class Hands(NamedTuple):
    """begin: (work, job) -> what returns work(job) once that is done; most: jobs to begin ahead."""

    begin: Callable[..., Callable[[], Any]]
    most: int


def hands(processes: int) -> AbstractContextManager[Hands]:
    """Return who does the jobs, in a `with` block that ends with the last of them."""
    return _here() if processes == 1 else _pool(processes)


@contextmanager
def _here() -> Iterator[Hands]:
    """Give this process, where a job begins when it is waited for."""
    yield Hands(partial, 1)


@contextmanager
def _pool(processes: int) -> Iterator[Hands]:
    """Give processes that start afresh, with one BLAS thread each."""
    from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
    from multiprocessing import active_children, get_context

    os.environ.update(ONE_THREAD)  # for the workers: what this process has loaded does not look again
    others = set(active_children())
    pool = ProcessPoolExecutor(processes, get_context("spawn"), _end_with_parent)

    def begin(work: Callable[[Any], Any], job: object) -> Callable[[], Any]:
        """Hand a job to the pool; workers start deaf to interrupts, which would end them untimely."""
        before = signal.pthread_sigmask(signal.SIG_BLOCK, INTERRUPT)
        try:
            return pool.submit(_at_work, work, job).result
        except BrokenExecutor as error:  # a worker was killed: it takes all jobs with it that are left
            return partial(_refuse, error)
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    try:
        yield Hands(begin, AHEAD * processes)
    finally:  # at an end before the last job, such as an interrupt, workers hand in what they have
        for process in set(active_children()) - others:
            if process.pid is not None:
                with suppress(ProcessLookupError):  # one that was killed may be gone by now
                    os.kill(process.pid, signal.SIGINT)
        pool.shutdown(cancel_futures=True)


def _refuse(error: Exception) -> Any:
    raise error


def _end_with_parent() -> None:
    """End this worker once the process that began it has gone, killed say: nobody else would."""
    from threading import Thread

    Thread(target=_outlive_nobody, daemon=True).start()


def _outlive_nobody() -> None:
    from multiprocessing import parent_process

    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _at_work(work: Callable[[Any], Any], job: object) -> Any:
    """Do a job in a worker, which heeds an interrupt only while it has something to do, and only once."""
    for name in LOADED:
        import_module(name)
    if signal.getsignal(signal.SIGINT) is _interrupted_before:
        raise KeyboardInterrupt
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not so in the background
        signal.signal(signal.SIGINT, _interrupted)
    try:
        signal.pthread_sigmask(signal.SIG_UNBLOCK, INTERRUPT)
        return work(job)
    finally:
        signal.pthread_sigmask(signal.SIG_BLOCK, INTERRUPT)


def _interrupted(*_: object) -> None:
    signal.signal(signal.SIGINT, _interrupted_before)
    raise KeyboardInterrupt


def _interrupted_before(*_: object) -> None:
    """Let a worker hand in what it has."""
