"""`cgff compare`: the same scenes by CGFF and by others, side by side."""

import os
import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import (
    Decorated,
    ExitCode,
    SectionCommand,
    SectionOption,
    report_error,
    say,
    title,
    wanted,
    warn,
    word_options,
    worst,
)
from cgff_cli.cli.options import FORMATS, given_solve_options, solve_option
from cgff_cli.errors import CgffError
from cgff_cli.options import OPTIONS
from cgff_cli.report.files import STDOUT, check_target, is_stream, write_output

if TYPE_CHECKING:
    from cgff_cli.comparison.record import Comparison

EPILOG = """\b
Examples:
  cgff compare --fdm
  cgff compare prism.yaml --fdm --fsolve --lm --plot prism.png
  cgff compare net.yaml --all --repeat 5 --format json | jq '.methods[].verdict'
  cgff compare *.yaml --all -o methods.csv
"""

RIVALS = {
    "fdm": ("fdm", "Form-finding from connectivity and signs alone; with supports, --schek."),
    "schek": ("schek", "The linear force density method with CGFF's force densities; needs supports."),
    "fsolve": ("fsolve", "scipy's fsolve with the exact Jacobian."),
    "fsolve-fd": ("fsolve-fd", "scipy's fsolve without a Jacobian, by finite differences."),
    "lm": ("lm", "scipy's Levenberg-Marquardt method with the exact Jacobian."),
    "table1": ("table1", "The paper's Table I to the letter."),
    "residual": ("cgff-residual", "CGFF on eq. (10), half the squared residual."),
    "lbfgs": ("lbfgs", "scipy's L-BFGS-B on the energy."),
    "dr": ("dr", "Dynamic relaxation with kinetic damping."),
    "all": ("all", "Every method that suits the scene."),
}
"""Flag -> the method it adds, and its help."""

SOLVE_OPTIONS = tuple(name for name in OPTIONS if name not in ("method", "objective"))
"""The solve options that are flags here; the methods stand for the other two."""

SUFFIXES = {".json": "json", ".csv": "csv"}
PICTURES = (".png", ".svg")


def _flags(function: Decorated) -> Decorated:
    """Add a flag per rival, then the options of comparing, of output and of solving."""
    own: list[tuple[tuple[str, ...], str, dict[str, Any]]] = [
        ((f"--{flag}",), "Methods beside CGFF (--fdm unless given)", {"is_flag": True, "help": text})
        for flag, (_, text) in RIVALS.items()
    ]
    own += _COMPARING
    for name in reversed(SOLVE_OPTIONS):
        function = solve_option(name, 1e-12 if name == "tolerance" else None)(function)
    for names, section, attributes in reversed(own):
        function = click.option(*names, cls=SectionOption, section=section, **attributes)(function)
    return function


_COMPARING: list[tuple[tuple[str, ...], str, dict[str, Any]]] = [
    (
        ("--repeat",),
        "Comparing",
        {
            "type": click.IntRange(min=1),
            "default": 3,
            "metavar": "N",
            "help": "Runs of each method, in turn; times are medians. Default: 3.",
        },
    ),
    (
        ("--time-limit",),
        "Comparing",
        {
            "type": click.FloatRange(min=0.0, min_open=True),
            "default": 60.0,
            "metavar": "X",
            "help": "Seconds after which a run is ended. Default: 60.",
        },
    ),
    (
        ("--format", "output_format"),
        "Output",
        {
            "type": click.Choice(FORMATS),
            "help": "What to write to standard output. Default: table on a terminal, json in a pipe.",
        },
    ),
    (
        ("-o", "--output"),
        "Output",
        {
            "metavar": "FILE",
            "type": click.Path(allow_dash=True),
            "help": "Write to FILE: .json everything, .csv a row per scene and method; - is standard output.",
        },
    ),
    (
        ("--plot",),
        "Output",
        {
            "metavar": "FILE",
            "type": click.Path(),
            "help": "Also draw residual against time and iterations to FILE (.png or .svg); "
            "needs matplotlib, the extra cgff-cli[plot].",
        },
    ),
]


@click.command("compare", cls=SectionCommand, epilog=EPILOG)
@click.argument("scenes", nargs=-1, metavar="[SCENE...]", type=click.Path(allow_dash=True))
@_flags
@word_options
@click.pass_context
def command(ctx: click.Context, scenes: tuple[str, ...], **values: Any) -> None:
    """Form-find scenes by CGFF and by other methods, side by side.

    Without a SCENE it takes the paper's three structures, which come with the program. All methods begin
    at the scene's own start, are judged by the scene's forces and stop at the same tolerance. A method that
    fails is a row that says how.
    """
    form, path = _form(values["output_format"], values["output"]), values["output"]
    _prepare(scenes, path, values["plot"])
    found: list[Comparison] = []
    code = ExitCode.OK
    for scene in scenes or _paper():
        comparison, one = _compared(scene, values)
        code = worst(code, one)
        if comparison is not None:
            found.append(comparison)
            if path in (None, STDOUT) and form != "csv":
                write_output(STDOUT, _text([comparison], form, many=len(scenes) != 1))
    if form == "csv" or path not in (None, STDOUT):
        write_output(path or STDOUT, _text(found, form, many=False))
    if values["plot"] is not None and found:
        from cgff_cli.report.plots import draw

        draw(found, values["plot"])
    ctx.exit(code)


def _paper() -> list[str]:
    from cgff_cli.scene.shipped import PAPER, shipped

    return [shipped(name) for name in PAPER]


def _compared(scene: str, values: dict[str, Any]) -> "tuple[Comparison | None, ExitCode]":
    """Return the comparison of one scene, None where there is none, and an exit code."""
    try:
        comparison = _found(scene, values)
    except Exception as error:
        return None, report_error(error)
    for warning in comparison.source.warnings:
        warn(f"cgff: {title(scene)}: warning: {warning}")
    own = comparison.methods[0]
    if own.converged:
        return comparison, ExitCode.OK
    say(f"cgff: {title(scene)}: {own.verdict}: {own.message}")
    return comparison, ExitCode.NOT_CONVERGED


def _found(scene: str, values: dict[str, Any]) -> "Comparison":
    """Return the comparison of one scene, showing on a terminal which method is at work."""
    from cgff_cli.comparison.compare import compare

    chosen = [method for flag, (method, _) in RIVALS.items() if values[flag.replace("-", "_")]]
    options = given_solve_options({name: values[name] for name in SOLVE_OPTIONS})
    options |= {"repeat": values["repeat"], "time_limit": values["time_limit"], "methods": chosen or ["fdm"]}
    if wanted("quiet") or not sys.stderr.isatty():
        return compare(scene, **options)
    from cgff_cli.report.progress import Progress

    with Progress(title(scene), delay=0.0) as progress:
        return compare(
            scene,
            observer=lambda method, run: progress.show(f"{method}, run {run}"),
            **options,
        )


def _form(output_format: str | None, path: str | None) -> str:
    """Return the format to write: by the flag, by the file's suffix, or by where it goes."""
    if path is not None and path != STDOUT and not is_stream(path):
        form = SUFFIXES.get(os.path.splitext(path)[1].lower())
        if form is None:
            raise click.UsageError(f"-o {path}: the name must end in .json (everything) or .csv (a table)")
        if output_format not in (None, form):
            raise click.UsageError(f"--format {output_format} and -o {path} disagree")
        return form
    return output_format or ("table" if sys.stdout.isatty() and path in (None, STDOUT) else "json")


def _prepare(scenes: tuple[str, ...], path: str | None, plot: str | None) -> None:
    """Refuse what cannot be written before any scene is solved."""
    if scenes.count(STDOUT) > 1:
        raise click.UsageError("standard input (-) can be read only once")
    if plot is not None:
        from cgff_cli.report.plots import check_matplotlib

        if os.path.splitext(plot)[1].lower() not in PICTURES:
            raise click.UsageError(f"--plot {plot}: the name must end in .png or .svg")
        check_matplotlib()
    taken = [os.path.realpath(scene) for scene in scenes if scene != STDOUT]
    for target in (path, plot):
        if target is None or target == STDOUT or is_stream(target):
            continue
        if os.path.realpath(target) in taken:
            raise click.UsageError(f"{target} would be written over another file of this run")
        taken.append(os.path.realpath(target))
        try:
            check_target(target)
        except CgffError as error:
            raise click.UsageError(str(error)) from error


def _text(found: "list[Comparison]", form: str, many: bool) -> Iterable[str]:
    """Return the pieces of text of comparisons; many: one of several pieces of standard output."""
    if form == "csv":
        from cgff_cli.report.comparison_csv import comparisons

        return comparisons(found)
    if form == "table":
        from cgff_cli.report.comparison_text import comparison_text

        pages = [
            comparison_text(one, terminal=sys.stdout.isatty(), full=wanted("verbose") > 0) for one in found
        ]
        return [*pages, "\n"] if many else pages
    from cgff_cli.report import json_out

    if len(found) == 1:
        layout = json_out.line if many else json_out.pretty
        return layout(found[0].to_dict().items())
    return json_out.array(one.to_dict() for one in found)
