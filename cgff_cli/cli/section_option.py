"""The option that all flags are: listed in the help under a heading, given once unless it may be repeated."""

from collections.abc import Mapping
from typing import Any

import click

from cgff_cli.hints import either


class SectionOption(click.Option):
    """An option listed in the help under a heading of its own; one that takes one value refuses a second."""

    def __init__(self, *args: Any, section: str = "Options", **attributes: Any):
        super().__init__(*args, **attributes)
        self.section = section

    @property
    def _takes_one(self) -> bool:
        return not (self.is_flag or self.multiple or self.count)

    def add_to_parser(self, parser: Any, ctx: click.Context) -> None:
        """Let the parser keep all values given: the last alone would be taken in silence."""
        if self._takes_one:
            parser.add_option(obj=self, opts=self.opts, dest=self.name, action="append", nargs=self.nargs)
        else:
            super().add_to_parser(parser, ctx)

    def consume_value(self, ctx: click.Context, opts: Mapping[str, Any]) -> Any:
        """Return the one value and where it is from; raises UsageError where there are more."""
        given = opts.get(str(self.name)) if self._takes_one else None
        if isinstance(given, list):
            if len(given) > 1 and not ctx.resilient_parsing:
                words = either(list(map(repr, given)), "and")
                raise click.UsageError(f"{self.opts[0]} takes one value, got {words}", ctx)
            opts = {**opts, str(self.name): given[-1]}
        return super().consume_value(ctx, opts)
