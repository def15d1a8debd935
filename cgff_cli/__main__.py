"""`cgff` and `python -m cgff_cli`: the process around the command, its streams and Ctrl-C."""

import gc
import os
import signal
import sys
from contextlib import suppress

_MODES = (os.O_WRONLY, os.O_RDONLY, os.O_WRONLY)
"""How a closed stream is opened: reading standard input fails, so does writing data; words go nowhere."""


def run() -> None:
    """Run the command. Ctrl-C ends it in a word also while its parts are still being imported.

    Nothing that imports make is garbage, and nothing is left to do at the end: looking for it and taking
    the interpreter apart would be a fifth of the time of a small solve (tests/studies/startup.py).
    """
    gc.set_threshold(1_000_000)
    heeded = signal.getsignal(signal.SIGINT) is signal.default_int_handler  # not so in the background
    if heeded:
        signal.signal(signal.SIGINT, _leave)
    _open_closed_streams()
    from cgff_cli.cli import main

    if heeded:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        main(prog_name="cgff")
    except SystemExit as end:
        if isinstance(end.code, int) and sys.getprofile() is sys.gettrace() is None:
            _end(end.code)
        raise


def _end(code: int) -> None:
    """Leave with an exit code; what streams still hold goes out."""
    for stream in (sys.stdout, sys.stderr):
        with suppress(OSError, ValueError):  # told by now, if it matters
            stream.flush()
    os._exit(code)


def _leave(*_: object) -> None:
    """End at once: there is nothing to write yet, and an import cut short may raise anything."""
    with suppress(OSError):
        os.write(2, b"cgff: interrupted\n")
    os._exit(130)


def _open_closed_streams() -> None:
    """Take the places of closed streams, which the next files to be opened would take otherwise."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            handle = os.open(os.devnull, _MODES[number])
            if handle != number:
                os.dup2(handle, number)
                os.close(handle)
            setattr(sys, name, os.fdopen(number, "w" if number else "r", encoding="utf-8", closefd=False))


if __name__ == "__main__":
    run()
