"""Hands on other machines: the workers of a dask scheduler, in the same chunks and to the same rows."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial
from typing import Any

from cgff_cli.errors import CgffError
from cgff_cli.study.digest import program
from cgff_cli.study.hands import AHEAD, Hands

AT_LEAST = 64
"""Jobs begun ahead at least, so that workers which join late find some."""

ANSWERS_WITHIN = 5.0
"""Seconds to wait for an answer of the scheduler."""


@contextmanager
def dask_hands(address: str) -> Iterator[Hands]:
    """Give the workers of the scheduler at an address, such as tcp://10.0.0.1:8786.

    A job whose worker dies is given to another one; workers may come and go. Raises CgffError where the
    package is missing, or nobody answers.
    """
    try:
        from distributed import Client
    except ImportError:
        raise CgffError(
            "dask needs distributed, which is not installed: pip install 'cgff-cli[dask]'"
        ) from None
    try:
        client = Client(address, timeout=ANSWERS_WITHIN, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise CgffError(f"dask scheduler {address}: no answer: {error}") from error
    begun: set[Any] = set()

    def begin(work: Callable[[Any], Any], job: object) -> Callable[[], Any]:
        future = client.submit(_at_worker, program(), work, job, pure=False)
        begun.add(future)
        return partial(_waited, begun, future)

    try:
        yield Hands(begin, max(AT_LEAST, AHEAD * sum(client.nthreads().values())))
    finally:
        client.cancel(list(begun))
        client.close()


def _waited(begun: set[Any], future: Any) -> Any:
    from distributed import CancelledError, KilledWorker

    try:
        return future.result()
    except (CancelledError, KilledWorker, OSError) as error:
        raise CgffError(f"dask: {error}") from error
    finally:
        begun.discard(future)


def _at_worker(expected: str, work: Callable[[Any], Any], job: object) -> Any:
    """Do a job at a worker, which must run the same program."""
    if program() != expected:
        own, other = (text.partition(" ")[0] for text in (expected, program()))
        raise CgffError(f"dask: a worker runs another program, {other}, than this one, {own}")
    return work(job)
