"""The one machine: jobs in, what became of each out, in the jobs' order whoever does the work.

A job carries a digest of all that its rows depend on; what does the work is a function of the job alone. So
rows depend neither on where, when and beside what they were worked out, nor on whether that was in this run
or in one that was cut short: whoever asks for them keeps those worth keeping, in a Journal or in a file of
its own, and hands them back as `known`. Work too small for a job by itself goes into jobs of fixed chunks,
cut by number alone.
"""

import json
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager
from itertools import islice
from typing import Any, NamedTuple

from cgff_cli.errors import CgffError
from cgff_cli.study.hands import Hands, hands

Row = dict[str, Any]
"""One line of a table: plain values, or arrays, by name."""


class Done(NamedTuple):
    """What became of a job.

    found        : what the work returned; None where it did not
    error        : what it raised instead, unless that was an interrupt
    is_interrupt : Ctrl-C ended it
    is_new       : it was worked out in this run
    """

    job: Any
    found: Any = None
    error: Exception | None = None
    is_interrupt: bool = False
    is_new: bool = True


def done(
    jobs: Iterable[Any],
    work: Callable[[Any], Any],
    known: Mapping[str, Any] | None = None,
    processes: int = 1,
    others: AbstractContextManager[Hands] | None = None,
) -> Iterator[Done]:
    """Yield what became of each job, in order; nothing after an interrupt.

    work      : what to do with a job; with several processes it can be pickled, as can jobs and findings
    known     : digest -> what the work returned in an earlier run, not done again
    processes : 1 is this one; more are processes of their own, with one BLAS thread each
    others    : who works instead, on other machines
    """
    known, jobs = known or {}, iter(jobs)
    waiting: deque[tuple[Any, Callable[[], Any] | None]] = deque()
    with others or hands(processes) as (begin, most):
        while True:
            try:
                for job in islice(jobs, most - len(waiting)):
                    waiting.append((job, None if job.digest in known else begin(work, job)))
                ended = _ended(*waiting[0], known) if waiting else None
            except KeyboardInterrupt:
                if not waiting:
                    raise
                yield Done(waiting[0][0], is_interrupt=True)
                return
            if ended is None:
                return
            waiting.popleft()
            yield ended


def _ended(job: Any, get: Callable[[], Any] | None, known: Mapping[str, Any]) -> Done:
    if get is None:
        return Done(job, known[job.digest], is_new=False)
    try:
        return Done(job, get())
    except Exception as error:
        return Done(job, error=error)


class Journal(dict[str, Any]):
    """Digest -> plain values, in a file that grows by a line each time: a run cut short goes on there.

    Raises CgffError where the system refuses.
    """

    def __init__(self, path: str):
        self.path = path
        super().__init__(_entries(path))

    def __setitem__(self, digest: str, value: Any) -> None:
        super().__setitem__(digest, value)
        try:
            with open(self.path, "a", encoding="utf-8") as file:
                # A line of its own, whatever a run that was killed left of its last one.
                file.write(f"\n{json.dumps([digest, value])}")
        except OSError as error:
            raise CgffError(f"{self.path}: cannot be written: {error.strerror or error}") from error


def _entries(path: str) -> dict[str, Any]:
    """Return what a file holds, the last of each digest; none where there is no file."""
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            lines = file.readlines()
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise CgffError(f"{path}: cannot be read: {error.strerror or error}") from error
    found = {}
    for line in lines:
        try:
            digest, value = json.loads(line)
        except (ValueError, TypeError):  # an empty line, or one that was cut off
            continue
        found[str(digest)] = value
    return found
