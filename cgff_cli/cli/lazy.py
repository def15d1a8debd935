"""A group whose commands are made when they are called, and listed without being made."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar

import click

from cgff_cli.hints import did_you_mean


class LazyGroup(click.Group, ABC):
    """Commands known by name and a line of help; a group of its own kind says which.

    listed : name -> line of help, in the order to list them
    noun, heading : what one of them is called, and all of them in the help
    """

    listed: ClassVar[Mapping[str, str]]
    noun: ClassVar[str]
    heading: ClassVar[str]

    @abstractmethod
    def made(self, name: str) -> click.Command:
        """Return the command of a name."""

    def meant(self, word: str) -> str:
        """Return what may have been meant by an unknown name, or all there is."""
        return did_you_mean(word, self.listed, "there are")

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names in order."""
        return list(self.listed)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command, made now, or None where there is none of that name."""
        return self.made(cmd_name) if cmd_name in self.listed else None

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the list of commands, making none."""
        with formatter.section(self.heading):
            formatter.write_dl(list(self.listed.items()))

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Find the command to run; an unknown one is refused with what may have been meant."""
        word = args[0]
        if word not in self.listed and not word.startswith("-") and not ctx.resilient_parsing:
            ctx.fail(f"no such {self.noun} {word!r}{self.meant(word)}")
        return super().resolve_command(ctx, args)
