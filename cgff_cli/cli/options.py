"""The flags that several commands take: scenes, solve options, where output goes."""

from collections.abc import Callable, Mapping
from typing import Any

import click

from cgff_cli.cli.common import Decorated, SectionOption
from cgff_cli.errors import OptionError
from cgff_cli.options import OPTIONS, checked

FORMATS = ("table", "json", "csv")

scenes_argument = click.argument(
    "scenes", nargs=-1, required=True, metavar="SCENE...", type=click.Path(allow_dash=True)
)


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
    """Add --format, -o, --history, --elements and --out-dir."""
    for names, attributes in reversed(_OUTPUT_FLAGS):
        add = click.option(*names, cls=SectionOption, section="Output", **attributes)
        function = add(function)
    return function


_OUTPUT_FLAGS: tuple[tuple[tuple[str, ...], dict[str, Any]], ...] = (
    (
        ("--format", "output_format"),
        {
            "type": click.Choice(FORMATS),
            "help": "What to write to standard output. Default: table on a terminal, json in a pipe.",
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
)
