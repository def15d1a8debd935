"""The one machine: jobs in, what became of each out, in the jobs' order whatever the number of processes.

A job carries a digest of all that its rows depend on; what does the work is a function of the job alone. So
rows depend neither on where, when and beside what they were worked out, nor on whether that was in this run
or in one that was cut short: whoever asks for them keeps those worth keeping, in a Journal or in a file of
its own, and hands them back as `known`. Work too small for a job by itself goes into jobs of fixed chunks,
cut by number alone.
"""

import os
import signal
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from itertools import islice
from typing import Any, Generic, NamedTuple, Protocol, TypeVar, cast

Row = dict[str, Any]
"""One line of a table: plain values, or arrays, by name."""

AHEAD = 4
"""Jobs that wait for each process: enough for it never to wait, few enough for what they hold."""

ONE_THREAD = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""What makes each worker round as any other, and leaves the others their cores."""


INTERRUPT = (signal.SIGINT,)


class Digested(Protocol):
    """A job, for the machine: other than its digest it is the work's alone."""

    @property
    def digest(self) -> str:
        """A word for all that its rows depend on, program and machine included where they do."""


J = TypeVar("J", bound=Digested)
R = TypeVar("R")


class Done(NamedTuple, Generic[J, R]):
    """What became of a job.

    found        : what the work returned; None where it did not
    error        : what it raised instead, unless that was an interrupt
    is_interrupt : Ctrl-C ended it
    is_new       : it was worked out in this run
    """

    job: J
    found: R
    error: Exception | None = None
    is_interrupt: bool = False
    is_new: bool = True


def done(
    jobs: Iterable[J], work: Callable[[J], R], known: Mapping[str, R] | None = None, processes: int = 1
) -> Iterator[Done[J, R]]:
    """Yield what became of each job, in order; nothing after an interrupt.

    work      : what to do with a job; with several processes it can be pickled, as can jobs and findings
    known     : digest -> what the work returned in an earlier run, not done again
    processes : 1 is this one; more are processes of their own, with one BLAS thread each
    """
    known, jobs = known or {}, iter(jobs)
    waiting: deque[tuple[J, Callable[[], R] | None]] = deque()
    most = 1 if processes == 1 else AHEAD * processes
    with _begin(processes) as begin:
        while True:
            try:
                for job in islice(jobs, most - len(waiting)):
                    waiting.append((job, None if job.digest in known else begin(work, job)))
                ended = _ended(*waiting[0], known) if waiting else None
            except KeyboardInterrupt:
                if not waiting:
                    raise
                yield Done(waiting[0][0], cast(R, None), is_interrupt=True)
                return
            if ended is None:
                return
            waiting.popleft()
            yield ended


def _ended(job: J, get: Callable[[], R] | None, known: Mapping[str, R]) -> Done[J, R]:
    if get is None:
        return Done(job, known[job.digest], is_new=False)
    try:
        return Done(job, get())
    except Exception as error:
        return Done(job, cast(R, None), error)


@contextmanager
def _begin(processes: int) -> Iterator[Callable[..., Callable[[], Any]]]:
    """Give what begins a job and returns a function that waits for its end.

    In this process a job begins when it is waited for.
    """
    if processes == 1:
        yield partial
        return
    from concurrent.futures import ProcessPoolExecutor
    from multiprocessing import active_children, get_context

    os.environ.update(ONE_THREAD)  # for the workers: what this process has loaded does not look again
    others = set(active_children())
    pool = ProcessPoolExecutor(processes, get_context("spawn"))

    def begin(work: Callable[[J], R], job: J) -> Callable[[], R]:
        """Hand a job to the pool; workers begin deaf to interrupts, which would end them untimely."""
        before = signal.pthread_sigmask(signal.SIG_BLOCK, INTERRUPT)
        try:
            return pool.submit(_at_work, work, job).result
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)

    try:
        yield begin
    finally:  # at an end before the last job, such as an interrupt, workers hand in what they have
        for process in set(active_children()) - others:
            if process.pid is not None:
                os.kill(process.pid, signal.SIGINT)
        pool.shutdown(cancel_futures=True)


def _at_work(work: Callable[[J], R], job: J) -> R:
    """Do a job in a worker, which heeds an interrupt only while it has something to do, and only once."""
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
