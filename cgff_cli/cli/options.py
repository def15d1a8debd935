"""The flags that several commands take: scenes, solve options, where output goes; and how values are read."""

import os
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from functools import partial
from typing import Any, TypeVar

import click

from cgff_cli.cli.common import Decorator, flag, flags
from cgff_cli.errors import OptionError
from cgff_cli.options import OPTIONS, checked
from cgff_cli.report.files import STDOUT
from cgff_cli.values import ALL_CASES, Rule

FORMATS = ("table", "json", "csv")

Value = TypeVar("Value")


class Checked(click.ParamType):
    """A value that a rule of the library accepts, or refuses in its own words on what is allowed.

    kinds : what text is tried to be read as before the rule sees it
    """

    def __init__(self, name: str, rule: Callable[[Any], Any], *kinds: type):
        self.name, self.rule, self.kinds = name, rule, kinds

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the value as the rule gives it."""
        try:
            return self.rule(self._read(value))
        except OptionError as error:
            self.fail(str(error), param, ctx)

    def _read(self, value: Any) -> Any:
        for kind in self.kinds:
            with suppress(ValueError, OverflowError):
                return kind(value)
        return value


def _all_scenes(ctx: click.Context, argument: click.Parameter, given: tuple[str, ...]) -> tuple[str, ...]:
    """Return the scenes given and those listed, where there is one at all."""
    if ctx.resilient_parsing:
        return given
    path = ctx.params["files_from"]
    scenes = (*given, *(_lines(path) if path is not None else ()))
    if not scenes:
        raise click.MissingParameter(ctx=ctx, param=argument)
    once_only(path, *scenes)
    return scenes


def once_only(*inputs: str | None) -> None:
    """Raise UsageError where standard input is to be read more than once."""
    if inputs.count(STDOUT) > 1:
        raise click.UsageError("standard input (-) can be read only once")


def by_key(words: str, given: Iterable[tuple[str, Value]]) -> dict[str, Value]:
    """Return key -> value of a flag that may be repeated; raises UsageError for a key given twice."""
    found: dict[str, Value] = {}
    for key, value in given:
        if key in found:
            raise click.UsageError(f"{words} {key}".rstrip() + " is given twice")
        found[key] = value
    return found


def _lines(path: str) -> list[str]:
    """Return the lines of a file that are not blank."""
    try:
        with click.open_file(path, "rb") as file:
            lines = file.read().splitlines()
    except OSError as error:
        raise click.UsageError(f"--files-from {path}: cannot be read: {error.strerror}") from None
    return [os.fsdecode(line) for line in lines if line.strip()]


scenes_arguments = flags(
    flag(
        "--files-from",
        section="Scenes",
        metavar="FILE",
        type=click.Path(allow_dash=True),
        is_eager=True,
        help="Also take the scenes that FILE names, one a line; - is standard input.",
    ),
    click.argument(
        "scenes",
        nargs=-1,
        metavar="SCENE...",
        type=click.Path(allow_dash=True),
        callback=_all_scenes,
    ),
)
"""Adds SCENE... and --files-from; a command gets the scenes of both."""


def rule_flag(
    name: str, rule: Rule, checked: Callable[[Any], Any], section: str, default: object
) -> Decorator[Any]:
    """Return what adds the flag of a value that has a rule; None is a default that the help explains."""
    letter = {int: "N", str: "TEXT", float: "X"}[rule.kind]
    kinds = () if rule.kind is str else (int, float)
    said = "" if default is None else f" Default: {default}."
    return flag(
        f"--{name.replace('_', '-')}",
        name,
        section=section,
        type=click.Choice(rule.choices) if rule.choices else Checked(letter, checked, *kinds),
        metavar=None if rule.choices else letter,
        help=f"{_as_sentence(rule.help)}{said}",
    )


def solve_option(name: str, default: object = None, help: str = "") -> Decorator[Any]:
    """Return what adds the flag of one solve option; `default` and `help` may be the command's own."""
    option = OPTIONS[name]
    shown = option.default if default is None else default
    rule = option.metadata["rule"]
    rule = rule._replace(help=help) if help else rule
    return rule_flag(name, rule, partial(checked, name), "Solver", shown)


def _as_sentence(text: str) -> str:
    """Return a help text as a sentence; one that begins with an option's value keeps its first letter."""
    begins_with_value = text.split()[0].endswith((":", ","))
    return (text if begins_with_value else text[0].upper() + text[1:]).removesuffix(".") + "."


solve_options = flags(*map(solve_option, OPTIONS))
"""Adds a flag for every solve option; one left out is None, so the scene's own value stands."""


def given_solve_options(values: Mapping[str, Any]) -> dict[str, Any]:
    """Return the solve options that were set on the command line."""
    return {name: values[name] for name in OPTIONS if values.get(name) is not None}


def case_flag(section: str, help: str) -> Decorator[Any]:
    """Return what adds --case of a command that takes one case, not all."""
    return flag("--case", section=section, type=Checked("NAME", _one_case), metavar="NAME", help=help)


def _one_case(name: str) -> str:
    if name == ALL_CASES:
        raise OptionError("all is for cgff solve and cgff view; name one load case or combination")
    return name


def output_flag(
    *names: str, dash: bool = False, metavar: str = "FILE", help: str, **attributes: Any
) -> Decorator[Any]:
    """Return what adds a flag that names a file to write; dash: - is standard output."""
    kind = click.Path(allow_dash=dash)
    return flag(*names, section="Output", metavar=metavar, type=kind, help=help, **attributes)


def format_flag(*formats: str, help: str, **attributes: Any) -> Decorator[Any]:
    """Return what adds --format."""
    choice = click.Choice(formats)
    return flag("--format", "output_format", section="Output", type=choice, help=help, **attributes)


output_options = flags(
    output_flag(
        "-o",
        "--output",
        dash=True,
        help="Write to FILE: .json everything, .csv the coordinates; - is standard output.",
    ),
    format_flag(
        *FORMATS,
        "jsonl",
        help="What to write to standard output; jsonl: an object a line. Default: table on a terminal, "
        "json in a pipe.",
    ),
    output_flag(
        "--out-dir",
        metavar="DIR",
        help="Write DIR/NAME.json for each scene NAME.yaml; .csv with --format csv.",
    ),
    output_flag("--history", help="Also write the history to FILE (.csv or .json)."),
    output_flag("--elements", help="Also write the elements to FILE (.csv or .json)."),
    output_flag("--summary", help="Also write a row per scene to FILE (.csv, .jsonl)."),
)
"""Adds -o, --format, --out-dir, --history, --elements and --summary."""
