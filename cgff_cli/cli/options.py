"""The flags that several commands take: scenes, solve options, where output goes."""

import os
from collections.abc import Callable, Mapping
from typing import Any

import click

from cgff_cli.cli.common import Decorated, SectionOption
from cgff_cli.errors import OptionError
from cgff_cli.options import OPTIONS, checked

FORMATS = ("table", "json", "csv")
_LISTED = "cgff.listed"


def scenes_arguments(function: Decorated) -> Decorated:
    """Add SCENE... and --files-from; a command gets the scenes of both."""
    add = click.option(
        "--files-from",
        metavar="FILE",
        type=click.Path(allow_dash=True),
        expose_value=False,
        is_eager=True,
        callback=_keep_listed,
        help="Also take the scenes that FILE names, one a line; - is standard input.",
    )
    listed = add(function)
    return click.argument(
        "scenes", nargs=-1, metavar="SCENE...", type=click.Path(allow_dash=True), callback=_all_scenes
    )(listed)


def _keep_listed(ctx: click.Context, option: click.Parameter, path: str | None) -> None:
    ctx.meta[_LISTED] = [] if path is None or ctx.resilient_parsing else _listed(path)


def _listed(path: str) -> list[str]:
    """Return the lines of a file that are not blank."""
    try:
        with click.open_file(path, "rb") as file:
            lines = file.read().splitlines()
    except OSError as error:
        raise click.UsageError(f"--files-from {path}: cannot be read: {error.strerror}") from None
    return [os.fsdecode(line) for line in lines if line.strip()]


def _all_scenes(ctx: click.Context, argument: click.Parameter, given: tuple[str, ...]) -> tuple[str, ...]:
    """Return the scenes given and those listed, where there is one at all."""
    scenes = (*given, *ctx.meta.get(_LISTED, ()))
    if not scenes and not ctx.resilient_parsing:
        raise click.MissingParameter(ctx=ctx, param=argument)
    return scenes


class SolveNumber(click.ParamType):
    """A number checked by the rules of the solve option its flag is named after."""

    name = "number"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the option's value; fails with the option's own words on what is allowed."""
        name = str(param.name) if param else ""
        try:
            return checked(name, _number(value))
        except OptionError as error:
            self.fail(str(error), param, ctx)


def _number(value: Any) -> Any:
    try:
        return float(value)
    except ValueError:
        return value


def solve_options(function: Decorated) -> Decorated:
    """Add a flag for every solve option; one left out is None, so the scene's own value stands."""
    for name in reversed(OPTIONS):
        function = solve_option(name)(function)
    return function


def solve_option(name: str, default: object = None) -> Callable[[Decorated], Decorated]:
    """Return what adds the flag of one solve option; `default` is the command's own, where it has one."""
    option = OPTIONS[name]
    rules = option.metadata
    allowed = rules.get("allowed")
    return click.option(
        f"--{name.replace('_', '-')}",
        name,
        cls=SectionOption,
        section="Solve options",
        type=click.Choice(allowed) if allowed else SolveNumber(),
        metavar=None if allowed else ("N" if rules["type"] is int else "X"),
        help=f"{_sentence(rules['help'])} Default: {option.default if default is None else default}.",
    )


def _sentence(text: str) -> str:
    """Return a help text as a sentence; one that begins with an option's value keeps its first letter."""
    begins_with_value = text.split()[0].endswith((":", ","))
    return (text if begins_with_value else text[0].upper() + text[1:]).rstrip(".") + "."


def given_solve_options(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the solve options that were set on the command line."""
    return {name: values[name] for name in OPTIONS if values.get(name) is not None}


def output_options(function: Decorated) -> Decorated:
    """Add --format, -o, --history, --elements, --out-dir and --summary."""
    for names, attributes in reversed(_OUTPUT_FLAGS):
        add = click.option(*names, cls=SectionOption, section="Output", **attributes)
        function = add(function)
    return function


_OUTPUT_FLAGS: tuple[tuple[tuple[str, ...], dict[str, Any]], ...] = (
    (
        ("--format", "output_format"),
        {
            "type": click.Choice([*FORMATS, "jsonl"]),
            "help": "What to write to standard output; jsonl: an object a line. "
            "Default: table on a terminal, json in a pipe.",
        },
    ),
    (
        ("-o", "--output"),
        {
            "metavar": "FILE",
            "type": click.Path(allow_dash=True),
            "help": "Write to FILE: .json everything, .csv the coordinates; - is standard output.",
        },
    ),
    (
        ("--history",),
        {
            "metavar": "FILE",
            "type": click.Path(),
            "help": "Also write the history, one row per iteration, to FILE (.csv or .json).",
        },
    ),
    (
        ("--elements",),
        {
            "metavar": "FILE",
            "type": click.Path(),
            "help": "Also write the table of elements to FILE (.csv or .json).",
        },
    ),
    (
        ("--out-dir",),
        {
            "metavar": "DIR",
            "type": click.Path(),
            "help": "Write DIR/NAME.json for each scene NAME.yaml; .csv with --format csv.",
        },
    ),
    (
        ("--summary",),
        {
            "metavar": "FILE",
            "type": click.Path(),
            "help": "Also write a row per scene to FILE (.csv or .jsonl).",
        },
    ),
)
