"""What all commands share: exit codes, words on standard error, and errors turned into both."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from enum import IntEnum
from typing import Any, TypeVar

import click

from cgff_cli.errors import CgffError, OptionError, SceneError

Decorated = TypeVar("Decorated", bound=Callable[..., Any])


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


_SEVERITY = (
    ExitCode.OK,
    ExitCode.UNMET,
    ExitCode.NOT_CONVERGED,
    ExitCode.SCENE,
    ExitCode.USAGE,
    ExitCode.ERROR,
    ExitCode.INTERRUPTED,
    ExitCode.BROKEN_PIPE,
)


def worst(*codes: ExitCode) -> ExitCode:
    """Return the exit code of several scenes: a bad scene outweighs one that did not converge.

    An error of cgff's own outweighs both, since what it left undone is not known.
    """
    return max(codes, key=_SEVERITY.index)


class SectionOption(click.Option):
    """An option listed in the help under a heading of its own."""

    def __init__(self, *args: Any, section: str, **attributes: Any):
        super().__init__(*args, **attributes)
        self.section = section


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
                formatter.write_dl(records)


def word_options(function: Decorated) -> Decorated:
    """Add -q, -v and --traceback; given before or after the command's name, they add up."""
    for names, help_text, is_count in (
        (("--traceback",), "Show where in the program an error arose.", False),
        (("-v", "--verbose"), "More words, and full tables; may be repeated.", True),
        (("-q", "--quiet"), "No progress and no warnings; errors only.", True),
    ):
        kind: dict[str, Any] = {"count": True} if is_count else {"is_flag": True}
        add = click.option(*names, help=help_text, expose_value=False, callback=_add_words, **kind)
        function = add(function)
    return function


def _add_words(ctx: click.Context, option: click.Parameter, value: int) -> None:
    key = f"cgff.{option.name}"
    ctx.meta[key] = ctx.meta.get(key, 0) + int(value or 0)


def wanted(word: str) -> int:
    """Return how often "quiet", "verbose" or "traceback" was asked for in this run."""
    return int(click.get_current_context().meta.get(f"cgff.{word}", 0))


def say(text: str) -> None:
    """Write one line of words to standard error."""
    click.echo(text, err=True)


def warn(text: str) -> None:
    """Write one line of words to standard error, unless -q was given."""
    if not wanted("quiet"):
        say(text)


def title(scene: str) -> str:
    """Return what a scene is called in words: its path, or <stdin>."""
    return "<stdin>" if scene == "-" else scene


def report_error(error: Exception) -> ExitCode:
    """Put an error into words on standard error and return its exit code."""
    if wanted("traceback"):
        import traceback

        traceback.print_exception(error)
    if isinstance(error, SceneError):
        for problem in error.problems:
            say(str(problem))
        return ExitCode.SCENE
    if isinstance(error, CgffError):
        say(f"cgff: {error}")
        return ExitCode.USAGE if isinstance(error, OptionError) else ExitCode.ERROR
    text = f"{type(error).__name__}: {error}".rstrip(": ")
    say(f"cgff: unexpected error: {text}; run again with --traceback")
    return ExitCode.ERROR


@contextmanager
def errors_reported() -> Iterator[None]:
    """End the command with words and an exit code where the body raises."""
    try:
        yield
    except (click.ClickException, click.exceptions.Exit, click.Abort):
        raise  # click's own, which it reports itself
    except KeyboardInterrupt:
        say("cgff: interrupted")
        raise click.exceptions.Exit(ExitCode.INTERRUPTED) from None
    except BrokenPipeError:
        _discard_stdout()
        raise click.exceptions.Exit(ExitCode.BROKEN_PIPE) from None
    except Exception as error:
        raise click.exceptions.Exit(report_error(error)) from error


def _discard_stdout() -> None:
    """Let what is still buffered go nowhere, or Python complains about it at exit."""
    with suppress(OSError, ValueError):  # where it is no real file, nothing is flushed at exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
