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

from cgff_cli.cli.common import errors_reported, word_options
from cgff_cli.cli.lazy import LazyGroup

COMMANDS = {
    "solve": "Find the equilibrium shape of each scene.",
    "compare": "Form-find scenes by CGFF and by other methods, side by side.",
    "bench": "Compare methods over many scenes.",
    "sweep": "Solve a scene for many sets of numbers, a row for each.",
    "equilibria": "Find the stable equilibria of a scene.",
    "analyse": "Judge a shape as given: balance, states, mechanisms, stability.",
    "prestress": "Find rest lengths that hold a geometry at its own coordinates.",
    "convert": "Turn files of other programs into scenes, and back.",
    "plot": "Draw a structure.",
    "view": "Show structures in a browser, on one page that needs no network.",
    "check": "Read and validate scenes without solving them.",
    "new": "Write a scene of a family: prisms, towers, nets and others.",
}

_EPILOG = """\b
Examples:
  cgff solve prism.yaml -o prism.json --history prism.csv
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


class _Program(LazyGroup):
    """The commands of COMMANDS; whatever goes wrong becomes words and an exit code."""

    listed, noun, heading = COMMANDS, "command", "Commands"

    def made(self, name: str) -> click.Command:
        """Return a command, imported now."""
        command: click.Command = import_module(f"cgff_cli.cli.{name}").command
        return command

    def make_context(self, *arguments: Any, **more: Any) -> click.Context:
        """Read the command line."""
        with errors_reported():
            return super().make_context(*arguments, **more)

    def invoke(self, ctx: click.Context) -> object:
        """Run the command."""
        with errors_reported():
            return super().invoke(ctx)

    def meant(self, word: str) -> str:
        """Return what may have been meant: to solve a file, perhaps."""
        return f"; did you mean 'cgff solve {word}'?" if os.path.exists(word) else super().meant(word)


@click.group(cls=_Program, context_settings={"help_option_names": ["-h", "--help"]}, epilog=_EPILOG)
@click.version_option(__version__, prog_name="cgff", message="%(prog)s %(version)s")
@word_options
def main() -> None:
    """Find the shapes of tensegrity structures and cable nets.

    Data goes to standard output, words to standard error. `cgff COMMAND --help` tells more.
    """
