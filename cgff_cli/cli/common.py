"""What all commands share: exit codes, words on standard error, and errors turned into both."""

import os
import sys
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from enum import IntEnum
from functools import reduce
from typing import TYPE_CHECKING, Any, TextIO, TypeVar

import click

from cgff_cli.cli.section_option import SectionOption
from cgff_cli.errors import CgffError, OptionError, SceneError
from cgff_cli.report.files import STDOUT, write_output

if TYPE_CHECKING:
    from cgff_cli.report.progress import Progress
    from cgff_cli.study.machine import Done

Decorated = TypeVar("Decorated", bound=Callable[..., Any])
Decorator = Callable[[Decorated], Decorated]


class ExitCode(IntEnum):
    """How a command ends."""

    OK = 0
    ERROR = 1
    USAGE = 2
    SCENE = 3
    NOT_CONVERGED = 4
    UNMET = 5
    INTERRUPTED = 130
    BROKEN_PIPE = 141
    """The reader of standard output has gone: 128 + SIGPIPE, as of any other program in a pipe."""


_SEVERITY = ("OK", "UNMET", "NOT_CONVERGED", "SCENE", "USAGE", "ERROR", "INTERRUPTED", "BROKEN_PIPE")

_LINE = "cgff.line"

_WIDEST = 24  # columns of a flag that keeps its help beside it


def worst(*codes: ExitCode) -> ExitCode:
    """Return the exit code of several scenes: a bad scene outweighs one that did not converge.

    An error of cgff's own outweighs both, since what it left undone is not known.
    """
    return max(codes, key=lambda code: _SEVERITY.index(code.name))


class SectionCommand(click.Command):
    """A command whose help lists options section by section."""

    def format_options(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write one list per section, in the order the sections first occur."""
        sections: dict[str, list[tuple[str, str]]] = {}
        for option in self.get_params(ctx):
            record = option.get_help_record(ctx)
            if record is not None and isinstance(option, click.Option):
                sections.setdefault(getattr(option, "section", "Options"), []).append(record)
        for section, records in sections.items():
            with formatter.section(section):
                formatter.write_dl(records, col_max=_WIDEST)


def flag(*names: str, **attributes: Any) -> Decorator[Any]:
    """Return what adds an option; `section` is its heading in the help."""
    return click.option(*names, cls=SectionOption, **attributes)


def flags(*own: Decorator[Any]) -> Decorator[Any]:
    """Return what adds several options, listed in the help in this order."""
    return lambda function: reduce(lambda made, add: add(made), reversed(own), function)


def examples(*lines: str) -> str:
    """Return the end of a help text: commands that do something useful."""
    return "\b\nExamples:\n" + "".join(f"  {line}\n" for line in lines)


def _keep_word(ctx: click.Context, option: click.Parameter, value: bool | None) -> None:
    if value is not None:
        ctx.meta[f"cgff.{option.name}"] = value


_WORD: dict[str, Any] = {"is_flag": True, "default": None, "expose_value": False, "callback": _keep_word}
_COLOURS = "Colours or none. Default: on a terminal, unless NO_COLOR is set."

word_options = flags(
    flag("-q", "--quiet", help="No progress and no warnings; errors only.", **_WORD),
    flag("-v", "--verbose", help="More words, and full tables.", **_WORD),
    flag("--color/--no-color", help=_COLOURS, **_WORD),
    flag("--traceback", help="Show where in the program an error arose.", **_WORD),
)
"""Adds -q, -v, --color and --traceback, given before or after the command's name."""


def wanted(word: str) -> bool | None:
    """Return whether "quiet", "verbose", "traceback" or "color" was asked for; None: nothing was said."""
    ctx = click.get_current_context(silent=True)
    return ctx.meta.get(f"cgff.{word}") if ctx else None


def drawn(page: Iterable[Any]) -> str:
    """Return a page as text for standard output, with widths and colours where that is a terminal."""
    from cgff_cli.report.terminal import rendered

    return rendered(page, sys.stdout.isatty(), wanted("color"))


def say(text: str) -> None:
    """Write one line of words to standard error; where nobody can read them, they change nothing."""
    _make_way()
    with suppress(OSError):
        click.echo(text, err=True)


def warn_of(scene: str, warnings: Iterable[str], case: str | None = None) -> None:
    """Write the warnings about a scene, in a load case, to standard error, unless -q was given."""
    for warning in () if wanted("quiet") else warnings:
        say(f"cgff: {title(scene, case)}: warning: {warning}")


def note_of(scene: str, notes: Iterable[str]) -> None:
    """Write what was passed over in a scene to standard error, where many words are wanted."""
    for note in notes if wanted("verbose") else ():
        say(f"cgff: {title(scene)}: note: {note}")


def title(scene: str, case: str | None = None) -> str:
    """Return what a scene is called in words: its path, or <stdin>, and the load case it is in."""
    return ("<stdin>" if scene == "-" else scene) + (f" [{case}]" if case else "")


def tell(pieces: Iterable[str]) -> None:
    """Write pieces of data to standard output, if there are any, in place of what shows progress there."""
    if not pieces:
        return
    if sys.stdout.isatty():
        _make_way()
    write_output(STDOUT, pieces)


def _make_way() -> None:
    """Wipe what shows progress, for something else to be written."""
    ctx = click.get_current_context(silent=True)
    if ctx and _LINE in ctx.meta:
        ctx.meta[_LINE].wipe()


@contextmanager
def progress(words: str, **more: Any) -> Iterator["Progress | None"]:
    """Give what shows progress on standard error; None where that is no terminal, or -q was given.

    Within another it is that one.
    """
    if wanted("quiet") or not sys.stderr.isatty():
        yield None
        return
    ctx = click.get_current_context()
    if _LINE in ctx.meta:
        yield ctx.meta[_LINE]
        return
    from cgff_cli.report.progress import Progress

    with Progress(words, **more) as line:
        ctx.meta[_LINE] = line
        try:
            yield line
        finally:
            del ctx.meta[_LINE]


def report_error(error: Exception) -> ExitCode:
    """Put an error into words on standard error and return its exit code."""
    if wanted("traceback"):
        import traceback

        traceback.print_exception(error)
    if isinstance(error, SceneError):
        say(str(error))
        return ExitCode.SCENE
    if isinstance(error, CgffError):
        say(f"cgff: {error}")
        return ExitCode.USAGE if isinstance(error, OptionError) else ExitCode.ERROR
    from concurrent.futures import BrokenExecutor

    text = f"unexpected error: {type(error).__name__}: {error}".rstrip(": ") + "; run again with --traceback"
    is_killed = isinstance(error, BrokenExecutor)
    say(f"cgff: {'a worker process was killed, maybe for want of memory' if is_killed else text}")
    return ExitCode.ERROR


def failed(ended: "Done", name: str = "") -> ExitCode | None:
    """Say why a job has no result and return the exit code; None where it has one.

    Raises what ends the whole command: a reader that has gone, output over a file that is read.
    """
    if ended.is_interrupt:
        say(f"cgff: {name}: interrupted" if name else "cgff: interrupted")
        return ExitCode.INTERRUPTED
    if isinstance(ended.error, (BrokenPipeError, click.UsageError)):
        raise ended.error
    return report_error(ended.error) if ended.error else None


@contextmanager
def errors_reported() -> Iterator[None]:
    """End the command with words and an exit code where the body raises."""
    try:
        yield
    except (click.exceptions.Exit, click.Abort):
        raise
    except click.ClickException as error:
        with suppress(OSError):  # a full disk leaves no words, but the exit code
            error.show()
        raise click.exceptions.Exit(error.exit_code) from None
    except KeyboardInterrupt:
        say("cgff: interrupted")
        raise click.exceptions.Exit(ExitCode.INTERRUPTED) from None
    except BrokenPipeError:
        raise click.exceptions.Exit(ExitCode.BROKEN_PIPE) from None
    except Exception as error:
        told: Exception = error
        # From --help, the one output of click's own.
        if isinstance(error, OSError) and error.filename is None:
            told = CgffError(f"standard output: cannot be written: {error.strerror}")
        raise click.exceptions.Exit(report_error(told)) from error
    finally:
        for stream in (sys.stdout, sys.stderr):
            _settle(stream)


def _settle(stream: TextIO) -> None:
    """Let what cannot be written go nowhere, or Python complains about it at exit."""
    try:
        stream.flush()
    except (OSError, ValueError):
        with suppress(OSError, ValueError):  # where it is no real file, nothing is flushed at exit
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
