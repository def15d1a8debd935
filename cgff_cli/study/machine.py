"""The one machine: jobs in, what became of each out, in the jobs' order whoever does the work.

A job carries a digest of all that its rows depend on; what does the work is a function of the job alone. So
rows depend neither on where, when and beside what they were worked out, nor on whether that was in this run
or in one that was cut short: whoever asks for them keeps those worth keeping, in a Journal or in a file of
its own, and hands them back as `known`. Work too small for a job by itself goes into jobs of fixed chunks,
cut by number alone.
"""

import fcntl
import json
import os
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from itertools import islice
from typing import Any, NamedTuple

from cgff_cli.errors import CgffError, OptionError
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

    alone : this run wants the file for itself, and what earlier ones put into it; others only add to it

    Where several run at a time, one that wants it alone is refused, as are those that come after it: with
    OptionError. The lock ends with its process, however that ends. Raises CgffError where the system refuses.
    """

    def __init__(self, path: str, alone: bool = True):
        super().__init__()
        self.path = path
        with self._told("opened"):
            self.file = open(path, "ab+", buffering=0)  # noqa: SIM115
        try:
            self._lock(fcntl.LOCK_EX if alone else fcntl.LOCK_SH)
            with self._told("read"):
                self.file.seek(0)
                self.update(_entries(self.file.readall() if alone else b""))
        except BaseException:
            self.file.close()
            raise

    def __enter__(self) -> "Journal":
        return self

    def __exit__(self, *_: object) -> None:
        self.file.close()

    def __setitem__(self, digest: str, value: Any) -> None:
        super().__setitem__(digest, value)
        # A line of its own, whatever a run that was killed left of its last one.
        line = f"\n{json.dumps([digest, value])}".encode()
        with self._told("written"):
            while line:  # a disk that is nearly full takes a part
                line = line[self.file.write(line) :]

    def _lock(self, kind: int) -> None:
        try:
            fcntl.flock(self.file, kind | fcntl.LOCK_NB)
        except BlockingIOError:
            folder = os.path.dirname(self.path)
            raise OptionError(f"{folder}: another run is at work there; wait for its end") from None
        except OSError:  # not every file system knows locks
            return

    @contextmanager
    def _told(self, what: str) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise CgffError(f"{self.path}: cannot be {what}: {error.strerror or error}") from error


def _entries(text: bytes) -> Iterator[tuple[str, Any]]:
    """Yield what the lines of a journal hold."""
    for line in text.splitlines():
        try:
            digest, value = json.loads(line)
        except (ValueError, TypeError):  # an empty line, or one that was cut off
            continue
        yield str(digest), value
