"""`cgff analyse`: what the coordinates of a scene or a result are, as given; nothing is solved."""

import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import (
    ExitCode,
    SectionCommand,
    drawn,
    examples,
    flag,
    say,
    title,
    wanted,
    warn_of,
    word_options,
)
from cgff_cli.cli.options import case_flag, format_flag, given_solve_options, output_flag, solve_option
from cgff_cli.cli.targets import check_targets, data_outputs, files_of, refuse_inputs
from cgff_cli.report.files import STDOUT, write_output

if TYPE_CHECKING:
    from cgff_cli.as_given import Analysis

_EPILOG = examples(
    "cgff solve prism.yaml -o prism.json && cgff analyse prism.json --sensitivity verticals",
    "cgff analyse bridge.yaml --modes 5 --format json | jq .analysis.modes",
)


@click.command("analyse", cls=SectionCommand, epilog=_EPILOG)
@output_flag("-o", "--output", dash=True, help="Write to FILE: .json everything; - is standard output.")
@format_flag(
    "table", "json", help="What to write to standard output. Default: table on a terminal, else json."
)
@flag(
    "--modes",
    section="Analysis",
    type=click.IntRange(min=0),
    metavar="N",
    help="Tell N mechanisms, and the N softest motions. Default: 3.",
)
@flag(
    "--sensitivity",
    section="Analysis",
    metavar="GROUP|A,B",
    multiple=True,
    help="Tell how nodes move and forces change per unit of rest length in all of a group, or in the element "
    "that joins nodes A and B; may be repeated.",
)
@case_flag("Analysis", "Of a scene, in a load case or combination; of a result, that it was solved in.")
@click.argument("scene", metavar="SCENE|RESULT", type=click.Path(allow_dash=True))
@solve_option(
    "tolerance", help="largest out-of-balance force, over the largest force, that still counts as balance"
)
@solve_option("factor")
@word_options
@click.pass_context
def command(ctx: click.Context, scene: str, **values: Any) -> None:
    """Judge a shape as given: balance, states, mechanisms, stability.

    The coordinates are those of a scene, or those that a result of `cgff solve` has found; nothing is solved.
    Where the forces do not balance the exit code is 4, and what can be told is told all the same.
    """
    from cgff_cli import as_given
    from cgff_cli.cases import scene_in_case
    from cgff_cli.scene.read import load

    outputs = data_outputs(values["output_format"], values["output"], {".json": "everything"})
    targets = check_targets([(values["output"], "the analysis")], files_of([scene]))
    given = load(scene, results=True)
    refuse_inputs(targets, ((path, f"a file of {title(scene)}") for path in given.files))
    own = {name: values[name] for name in ("modes", "sensitivity") if values[name] is not None}
    given = scene_in_case(given, values["case"])
    found = as_given.analyse(given, **own, **given_solve_options(values))
    for place, form in outputs:
        write_output(place, _text(found, form))
    if not ((STDOUT, "table") in outputs and sys.stdout.isatty()):
        warn_of(scene, found.warnings)
    if found.balanced is False:
        say(f"cgff: {title(scene)}: {found.message}")
    ctx.exit(ExitCode.NOT_CONVERGED if found.balanced is False else ExitCode.OK)


def _text(found: "Analysis", form: str) -> Iterable[str]:
    """Return the pieces of text; their writer is imported now."""
    if form == "table":
        from cgff_cli.report.analysis_text import analysis_page

        return [drawn(analysis_page(found, bool(wanted("verbose"))))]
    from cgff_cli.report import json_out

    return json_out.pretty(found.to_dict().items())
