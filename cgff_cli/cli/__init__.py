"""Last room: the command `cgff`. A command parses, calls the library, writes, and picks an exit code.

Each command is one file here holding one `command`, imported when it is called. A new command is its
file and one line in COMMANDS.
"""

import os
from importlib import import_module
from typing import Any

import click

from cgff_cli import __version__

# Before numpy is imported: our arrays are too small or too sparse to gain from BLAS threads, which wait for
# each other on a busy machine (a large net took up to twenty times as long) and may round differently.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from cgff_cli.cli.common import TellingCommand, errors_reported, word_options
from cgff_cli.hints import did_you_mean

COMMANDS = {
    "solve": "Find the equilibrium shape of each scene.",
    "compare": "Form-find scenes by CGFF and by other methods, side by side.",
    "bench": "Compare methods over many scenes.",
    "check": "Read and validate scenes without solving them.",
    "new": "Write a scene of a family: prisms, towers, polyhedra, nets, chains.",
}

EPILOG = """\b
Examples:
  cgff solve prism.yaml
  cgff solve prism.yaml -o prism.json --history prism.csv
  cgff check *.yaml
  cgff new prism --sides 5 --noise 0.1 | cgff solve -

\b
Exit codes:
  0 converged         2 wrong usage       4 not converged
  1 unexpected error  3 bad scene file    5 the answer is no
                                          130 interrupted

\b
Shell completion (likewise zsh_source, fish_source):
  eval "$(_CGFF_COMPLETE=bash_source cgff)"
"""


class LazyGroup(TellingCommand, click.Group):
    """The commands of COMMANDS, none of them imported before it is called or asked for help."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the commands in the order of COMMANDS."""
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command, imported now, or None where there is none of that name."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = import_module(f"cgff_cli.cli.{cmd_name}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of commands from COMMANDS, importing none."""
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command to run; an unknown one is refused with what may have been meant."""
        word = args[0]
        if word not in COMMANDS and not word.startswith("-") and not ctx.resilient_parsing:
            ctx.fail(f"no such command {word!r}; {_meant(word)}")
        return super().resolve_command(ctx, args)

    def make_context(self, *arguments: Any, **more: Any) -> click.Context:
        """Read the command line; what is wrong with it becomes words and an exit code."""
        with errors_reported():
            return super().make_context(*arguments, **more)

    def invoke(self, ctx: click.Context) -> object:
        """Run the command; whatever it raises becomes words and an exit code."""
        with errors_reported():
            return super().invoke(ctx)


def _meant(word: str) -> str:
    if os.path.exists(word):
        return f"did you mean 'cgff solve {word}'?"
    return did_you_mean(word, COMMANDS)[2:] or f"there are {', '.join(COMMANDS)}"


@click.group(cls=LazyGroup, context_settings={"help_option_names": ["-h", "--help"]}, epilog=EPILOG)
@click.version_option(__version__, prog_name="cgff", message="%(prog)s %(version)s")
@word_options
def main() -> None:
    """Find the shapes of tensegrity structures and cable nets.

    Data goes to standard output, words to standard error. `cgff COMMAND --help` tells more.
    """
