"""`cgff view`: one page that shows structures in a browser."""

from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import (
    ExitCode,
    SectionCommand,
    examples,
    flag,
    say,
    title,
    warn_of,
    word_options,
    worst,
)
from cgff_cli.cli.options import output_flag
from cgff_cli.cli.targets import check_targets, files_of, form_of_file, refuse_inputs

if TYPE_CHECKING:
    from cgff_cli.result import Result

_EPILOG = examples(
    "cgff view prism.yaml -o prism.html",
    "cgff view roof.yaml --case all -o roof.html",
    "cgff view before.json after.json -o both.html",
)


@click.command("view", cls=SectionCommand, epilog=_EPILOG)
@click.argument(
    "scenes", nargs=-1, required=True, metavar="SCENE|RESULT...", type=click.Path(allow_dash=True)
)
@output_flag("-o", "--output", required=True, dash=True, help="Write to FILE.html; -: to standard output.")
@flag("--case", section="Page", metavar="NAME", help="Of scenes, in a load case or combination; all: each.")
@flag("--as-given", section="Page", is_flag=True, help="Scenes at their own start, without solving them.")
@flag(
    "--modes",
    section="Page",
    type=click.IntRange(min=0),
    default=3,
    show_default=True,
    metavar="N",
    help="Motions of either kind to choose among: mechanisms, softest motions.",
)
@word_options
@click.pass_context
def command(ctx: click.Context, scenes: tuple[str, ...], output: str, **values: Any) -> None:
    """Show structures in a browser, on one page that needs no network.

    Scenes are solved; results are shown as they are, and so are geometries. Turn, zoom, hover for names and
    numbers, colour by force, force density or strain, hide groups, let motions swing, switch between
    structures. It needs three.js, the extra cgff-cli[view].
    """
    from cgff_cli.report import view
    from cgff_cli.report.files import STDOUT, write_output

    if output != STDOUT:
        form_of_file("-o", output, {".html": ""})
    targets = check_targets([(output, "the page")], files_of(scenes))
    view.check_threejs()
    shown, code = [], ExitCode.OK
    given = values["case"], values["as_given"]
    for path, result in ((own, found) for own in scenes for found in view.results_shown(own, *given)):
        source = result.source
        refuse_inputs(targets, ((own, f"a file of {title(path)}") for own in source.files))
        warn_of(path, source.warnings if source.is_geometry else result.warnings)
        code = worst(code, _ended(path, result, values["as_given"]))
        shown.append(view.exhibit_of(result, 0 if result.interrupted else values["modes"]))
        if result.interrupted:
            break
    write_output(output, [view.page_of(shown)])
    ctx.exit(code)


def _ended(path: str, result: "Result", as_given: bool) -> ExitCode:
    """Say where a solve did not converge and return its exit code; what was given may be as it is."""
    if as_given or result.source.is_answer or result.source.is_geometry or result.converged:
        return ExitCode.OK
    say(f"cgff: {title(path)}: {result.message}")
    return ExitCode.INTERRUPTED if result.interrupted else ExitCode.NOT_CONVERGED
