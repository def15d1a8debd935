"""Output that appears whole or not at all."""

import fcntl
import io
import os
import re
import stat
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import IO, Any

from cgff_cli.errors import CgffError

STDOUT = "-"

_HELD_OPEN = re.compile(r"/dev/std(in|out|err)|/(?:dev|proc/self)/fd/(\d+)")
_PART = re.compile(r"\.cgff-[0-9a-f]{12}\.part")
_NUMBERS = {"in": 0, "out": 1, "err": 2}

TEXT: dict[str, Any] = {"encoding": "utf-8", "errors": "backslashreplace", "newline": "\n"}
"""How text is written. Lone surrogates, which UTF-8 cannot hold, come out as JSON has them, \\udXXX."""


def write_output(path: str, chunks: Iterable[str]) -> None:
    """Write text to a file, or to standard output for "-".

    A file is written beside its final place and moved there once complete, so a failure leaves an
    older file as it was. Devices and pipes cannot be replaced and are written straight.
    Raises CgffError when the system refuses, BrokenPipeError when a reader has gone.
    """
    with opened(path, "w", **TEXT) as out:
        out.writelines(chunks)


def write_bytes(path: str, data: bytes) -> None:
    """Write a picture to a file, whole or not at all; raises as `write_output` does."""
    with opened(path, "wb") as out:
        out.write(data)


def is_stream(path: str) -> bool:
    """Tell whether a path names a device or a pipe, such as /dev/stdout or a shell's >(...)."""
    if _held_open(path) is not None:
        return True  # a redirected /dev/stdout is a regular file to stat, yet the shell holds it open
    try:
        mode = os.stat(path).st_mode
    except OSError:
        return False
    return not (stat.S_ISREG(mode) or stat.S_ISDIR(mode))


def make_folder(path: str) -> None:
    """Create a folder and its parents where missing; raises CgffError."""
    try:
        os.makedirs(path, exist_ok=True)
    except OSError as error:
        raise CgffError(f"{path}: cannot be made a folder: {error.strerror}") from error


def check_target(path: str) -> None:
    """Raise CgffError where a file could not be written: no such folder, or the path is one."""
    _place(path)


def clear_away(targets: Iterable[str]) -> None:
    """Remove what writers that were killed left beside files such as these."""
    for folder in {os.path.dirname(os.path.realpath(path)) for path in targets}:
        for name in filter(_PART.fullmatch, _listed(folder)):
            part = os.path.join(folder, name)
            with suppress(OSError), open(part, "rb") as file:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # whoever writes it still holds it
                os.unlink(part)


def _listed(folder: str) -> list[str]:
    try:
        return os.listdir(folder)
    except OSError:  # one may be allowed to write there, but not to look
        return []


def _place(path: str) -> tuple[str, int | None]:
    """Return where a file is to be, links followed, and the permissions of one there is."""
    target = os.path.realpath(path)
    try:
        mode = os.stat(target).st_mode
    except OSError:
        folder = os.path.dirname(target)
        if not os.path.isdir(folder):
            raise CgffError(f"{path}: cannot be written: there is no folder {folder}") from None
        return target, None
    if stat.S_ISDIR(mode):
        raise CgffError(f"{path}: cannot be written: it is a folder")
    if not os.access(target, os.W_OK):
        raise CgffError(f"{path}: cannot be written: it is read-only")
    return target, stat.S_IMODE(mode)


def _held_open(path: str) -> int | None:
    """Return the number of an open file that a path such as /dev/stdout stands for."""
    named = _HELD_OPEN.fullmatch(path)
    return None if named is None else _NUMBERS[named[1]] if named[1] else int(named[2])


@contextmanager
def opened(path: str, mode: str, **how: Any) -> Iterator[IO[Any]]:
    """Give what is to be written to, in a `with` block; raises as `write_output` does."""
    number = _held_open(path)
    try:
        if path == STDOUT:
            if isinstance(sys.stdout, io.TextIOWrapper):
                sys.stdout.reconfigure(**how)
            yield sys.stdout
            sys.stdout.flush()
        elif number is not None:  # opened by name again, a closed one would take anything and tell nobody
            with open(os.dup(number), mode, **how) as out:
                yield out
        elif is_stream(path):
            with open(path, mode, **how) as out:
                yield out
        else:
            with _in_place_once_complete(path) as handle, open(handle, mode, **how) as out:
                yield out
    except BrokenPipeError:
        raise
    except OSError as error:
        name = "standard output" if path == STDOUT else path
        raise CgffError(f"{name}: cannot be written: {error.strerror or error}") from error


@contextmanager
def _in_place_once_complete(path: str) -> Iterator[int]:
    """Give a handle of a new file, to be closed in the body, which takes the path's place after it."""
    target, permissions = _place(path)
    part = os.path.join(os.path.dirname(target), f".cgff-{os.urandom(6).hex()}.part")
    # os.open, unlike the tempfile module, gives the new file the permissions umask asks for.
    handle = os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666)
    try:
        with suppress(OSError):  # not every file system knows locks
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield handle
        if permissions is not None:
            os.chmod(part, permissions)
        os.replace(part, target)
    except BaseException:
        with suppress(OSError):  # the folder may have gone meanwhile
            os.unlink(part)
        raise
