"""A table that grows for hours and survives being killed: FILE.part, its sidecar, and a lock.

Rows go to FILE.part. What is known to be on the disk, and of what study, stands in the sidecar
FILE.sweep.json, written after the rows. A run that goes on cuts FILE.part back to that; the last one renames
it to FILE. The lock is on FILE.part and dies with its process.
"""

import fcntl
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from time import monotonic
from types import TracebackType
from typing import IO, Any, Protocol

from cgff_cli.errors import CgffError, OptionError

EVERY = 1.0
"""Seconds between two looks that rows have reached the disk: as much work is lost with the power, or to a
kill. No row depends on it."""

COUNTS = ("rows_done", "bytes", "not_converged", "bad", "not_judged", "no_jump")


class Sink(Protocol):
    """Where rows go; counts: of all so far, by COUNTS; kept: plain values that a run which goes on needs."""

    counts: dict[str, int]
    kept: dict[str, Any]

    def add(self, text: str, kept: dict[str, Any] | None = None, **counts: int) -> None:
        """Take some rows, or a header, what to keep from then on, and how many of each kind, by name."""

    def finish(self) -> None:
        """Have all rows."""


class RowsStream:
    """Standard output, a pipe or a device, as a sink."""

    def __init__(self, out: IO[str]):
        self.out, self.counts = out, dict.fromkeys(COUNTS, 0)
        self.kept: dict[str, Any] = {}

    def add(self, text: str, kept: dict[str, Any] | None = None, **counts: int) -> None:
        """Write some rows, for whoever reads them as they come."""
        self.out.write(text)
        self.out.flush()
        self.counts |= {name: self.counts[name] + more for name, more in counts.items()}

    def finish(self) -> None:
        """Leave it as it is."""


class RowsFile:
    """A table in the making, in a `with` block; told: what its rows depend on by name, and a digest of it.

    Raises OptionError where another run writes it, or where what is there is of another study; CgffError
    where the system refuses.
    """

    def __init__(self, path: str, total: int, told: Mapping[str, Any], is_resumed: bool):
        self.path, self.total = os.path.realpath(path), total
        self.told, self.is_resumed = dict(told), is_resumed
        self.shown, self.part, self.sidecar = path, f"{self.path}.part", f"{self.path}.sweep.json"
        self.counts = dict.fromkeys(COUNTS, 0)
        self.kept: dict[str, Any] = {}
        self.handle, self.seen = -1, monotonic()

    def __enter__(self) -> "RowsFile":
        with self._refusals():
            if self.is_resumed and not os.path.exists(self.part) and self._was_finished():
                return self
            self.handle = _locked(self.part, self.shown)
            try:
                if self.is_resumed:  # read under the lock: another run may have gone on until now
                    self._take_up(self._earlier(), os.fstat(self.handle).st_size)
                os.ftruncate(self.handle, self.counts["bytes"])
                os.lseek(self.handle, 0, os.SEEK_END)
                self._settle()
            except BaseException:
                os.close(self.handle)
                raise
        return self

    def _was_finished(self) -> bool:
        """Return whether an earlier run wrote the whole table."""
        earlier, is_there = self._earlier(), os.path.exists(self.path)
        if earlier is None and is_there:
            raise OptionError(f"{self.shown} has no {os.path.basename(self.sidecar)} beside it to go on from")
        if earlier is None or not is_there or earlier["rows_done"] < self.total:
            return False
        self._take_up(earlier, size := os.path.getsize(self.path))
        if size != self.counts["bytes"]:
            raise OptionError(f"{self.shown} has been changed since it was written")
        return True

    def _earlier(self) -> dict[str, Any] | None:
        """Return what the sidecar tells, all of it of this study; None where there is none."""
        earlier = _read(self.sidecar)
        if earlier is None or earlier.get("digest") == self.told["digest"]:
            return earlier
        other = [
            f"{name} was {json.dumps(earlier.get(name))}, is {json.dumps(own)}"
            for name, own in self.told.items()
            if name != "digest" and earlier.get(name) != own
        ]
        raise OptionError(f"{self.shown} was begun otherwise: {'; '.join(other) or 'by another program'}")

    def _take_up(self, earlier: dict[str, Any] | None, size: int) -> None:
        """Go on from what a sidecar tells, where a file of so many bytes can hold it."""
        if earlier is not None and size >= earlier["bytes"]:
            self.counts, self.kept = {name: earlier[name] for name in COUNTS}, earlier.get("kept", {})

    def add(self, text: str, kept: dict[str, Any] | None = None, **counts: int) -> None:
        """Write some rows."""
        data = text.encode("utf-8", "backslashreplace")
        with self._refusals():
            left = memoryview(data)
            while left:
                left = left[os.write(self.handle, left) :]
            counts["bytes"] = len(data)
            more = {name: own + counts.get(name, 0) for name, own in self.counts.items()}
            # Together: an interrupt, or a full disk above, leaves both as they were.
            self.counts, self.kept = more, kept or self.kept
            if monotonic() - self.seen >= EVERY:
                self._settle()

    def finish(self) -> None:
        """Put the table in its place."""
        if self.handle < 0:
            return
        with self._refusals():
            self._settle()
            os.replace(self.part, self.path)
            _settle_folder(self.path)
        os.close(self.handle)
        self.handle = -1  # from now on .part and sidecar may be another run's

    def _settle(self) -> None:
        """See that all rows are on the disk, then say so in the sidecar."""
        os.fsync(self.handle)
        kept = {"kept": self.kept} if self.kept else {}
        text = json.dumps(self.told | {"rows": self.total} | self.counts | kept, indent=2) + "\n"
        new = f"{self.sidecar}.new"
        try:
            with open(new, "w", encoding="utf-8") as file:
                file.write(text)
                file.flush()
                os.fsync(file.fileno())
            os.replace(new, self.sidecar)
        except OSError:
            with suppress(OSError):
                os.unlink(new)
            raise
        self.seen = monotonic()

    @contextmanager
    def _refusals(self) -> Iterator[None]:
        try:
            yield
        except OSError as error:
            raise CgffError(f"{self.shown}.part: cannot be written: {error.strerror or error}") from error

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self.handle < 0:
            return
        if os.path.exists(self.part):
            with suppress(OSError):
                os.ftruncate(self.handle, self.counts["bytes"])
                self._settle()
        os.close(self.handle)


def _locked(part: str, shown: str) -> int:
    """Return a handle of the file of rows, locked; one renamed in the meantime is let go."""
    while True:
        handle = os.open(part, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            os.close(handle)
            raise OptionError(f"{shown} is being written by another run") from None
        with suppress(FileNotFoundError):
            if os.path.samestat(os.stat(part), os.fstat(handle)):
                return handle
        os.close(handle)


def _read(sidecar: str) -> dict[str, Any] | None:
    """Return what a sidecar tells; None where there is none."""
    try:
        with open(sidecar, encoding="utf-8") as file:
            found = json.load(file)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise CgffError(f"{sidecar}: cannot be read: {error.strerror or error}") from error
    except ValueError:
        found = None
    if not isinstance(found, dict) or not all(isinstance(found.get(name), int) for name in COUNTS):
        why = "is not what a sweep leaves beside its rows; without --resume all begins anew"
        raise CgffError(f"{sidecar}: {why}")
    return found


def _settle_folder(path: str) -> None:
    """See that a new name is on the disk; some systems do not let a folder be opened for it."""
    with suppress(OSError):
        folder = os.open(os.path.dirname(path), os.O_RDONLY)
        try:
            os.fsync(folder)
        finally:
            os.close(folder)
