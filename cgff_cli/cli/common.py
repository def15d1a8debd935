"""What all commands share: exit codes, words on standard error, and errors turned into both."""

import os
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from enum import IntEnum
from typing import TYPE_CHECKING, Any, TextIO, TypedDict, TypeVar

import click

from cgff_cli.errors import CgffError, OptionError, SceneError

if TYPE_CHECKING:
    from cgff_cli.report.progress import Progress

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


class TellingCommand(click.Command):
    """A command whose help, where it cannot be written, is an error like that of any other output."""

    def make_context(self, *arguments: Any, **more: Any) -> click.Context:
        """Read the command line; --help and --version write here."""
        try:
            return super().make_context(*arguments, **more)
        except BrokenPipeError:
            raise
        except OSError as error:
            raise CgffError(f"standard output: cannot be written: {error.strerror}") from error


class SectionCommand(TellingCommand):
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
    """Add -q, -v, --traceback and --color, given before or after the command's name."""
    for names, help_text in (
        (("--traceback",), "Show where in the program an error arose."),
        (("--color/--no-color",), "Colours or none. Default: on a terminal, unless NO_COLOR is set."),
        (("-v", "--verbose"), "More words, and full tables."),
        (("-q", "--quiet"), "No progress and no warnings; errors only."),
    ):
        add = click.option(
            *names, help=help_text, is_flag=True, default=None, expose_value=False, callback=_keep_word
        )
        function = add(function)
    return function


def _keep_word(ctx: click.Context, option: click.Parameter, value: bool | None) -> None:
    if value is not None:
        ctx.meta[f"cgff.{option.name}"] = value


def wanted(word: str) -> bool | None:
    """Return whether "quiet", "verbose", "traceback" or "color" was asked for; None: nothing was said."""
    ctx = click.get_current_context(silent=True)
    return ctx.meta.get(f"cgff.{word}") if ctx else None


class Screen(TypedDict):
    """What a page is drawn for: a terminal or not, in colour or not, None for the terminal's own habit."""

    terminal: bool
    colour: bool | None


def screen() -> Screen:
    """Return what standard output is."""
    return {"terminal": sys.stdout.isatty(), "colour": wanted("color")}


def say(text: str) -> None:
    """Write one line of words to standard error; where nobody can read them, they change nothing."""
    with suppress(OSError):
        click.echo(text, err=True)


def warn(text: str) -> None:
    """Write one line of words to standard error, unless -q was given."""
    if not wanted("quiet"):
        say(text)


def title(scene: str) -> str:
    """Return what a scene is called in words: its path, or <stdin>."""
    return "<stdin>" if scene == "-" else scene


@contextmanager
def progress(words: str, **more: Any) -> Iterator["Progress | None"]:
    """Give what shows progress on standard error; None where that is no terminal, or -q was given."""
    if wanted("quiet") or not sys.stderr.isatty():
        yield None
        return
    from cgff_cli.report.progress import Progress

    with Progress(words, **more) as line:
        yield line


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
        raise click.exceptions.Exit(report_error(error)) from error
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
