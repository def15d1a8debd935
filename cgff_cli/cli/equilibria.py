"""`cgff equilibria`: the distinct stable equilibria of a scene, from many starts."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli import common
from cgff_cli.cli.common import ExitCode, flag, title
from cgff_cli.cli.options import FORMATS, case_flag, format_flag, output_flag
from cgff_cli.cli.targets import check_targets, data_outputs, files_of, refuse_inputs
from cgff_cli.report.files import write_output

if TYPE_CHECKING:
    from cgff_cli.study.landscape import Equilibria

_EPILOG = common.examples(
    "cgff equilibria prism.yaml",
    "cgff equilibria tower.yaml --starts 5000 --seed 1 --jobs 4 -o found.json",
)
_CONTENTS = "Write to FILE: .json everything, .csv a row per equilibrium; - is standard output."
_FORM = "What to write to standard output. Default: table on a terminal, json in a pipe."


def _number(name: str, least: int, default: int, text: str) -> Any:
    kind = click.IntRange(min=least)
    help = f"{text} Default: {default}."
    return flag(name, section="Search", type=kind, default=default, metavar="N", help=help)


@click.command("equilibria", cls=common.SectionCommand, epilog=_EPILOG)
@click.argument("scene", type=click.Path(allow_dash=True))
@_number("--starts", 1, 200, "Solves, those begun along soft motions included.")
@_number("--seed", 0, 0, "Seed of the random starts.")
@_number("--jobs", 1, 1, "Processes at work; nothing that is found depends on it.")
@case_flag("Search", "In a load case or combination.")
@flag("--all", "everything", section="Search", is_flag=True, help="List those not stable as well.")
@output_flag("-o", "--output", dash=True, help=_CONTENTS)
@format_flag(*FORMATS, help=_FORM)
@common.word_options
@click.pass_context
def command(
    ctx: click.Context, scene: str, output: str, output_format: str, case: str | None, **values: Any
) -> None:
    """Find the stable equilibria of a scene.

    Half of the starts are the scene's own and random ones in a cube of its size about it; the other half
    goes along the softest motions of what these find. What is found is told best first; shapes that a
    symmetry of the scene maps to each other are of one kind. Ctrl-C keeps what was found.
    """
    from cgff_cli.cases import scene_in_case
    from cgff_cli.scene.read import load
    from cgff_cli.study.search import equilibria

    outputs = data_outputs(output_format, output)
    targets = check_targets([(output, "the equilibria")], files_of([scene]))
    read = load(scene)
    refuse_inputs(targets, ((file, f"a file of {title(scene)}") for file in read.files))
    common.warn_of(scene, read.warnings)
    with common.progress(title(scene), delay=0.0) as line:
        found = equilibria(scene_in_case(read, case), watcher=None if line is None else line.count, **values)
    for place, form in outputs:
        write_output(place, _text(found, form))
    ctx.exit(_told(title(scene), found))


def _text(found: "Equilibria", form: str) -> Iterable[str]:
    """Return the pieces of what is written."""
    if form == "table":
        from cgff_cli.report.equilibria_text import equilibria_page

        return [common.drawn(equilibria_page(found, bool(common.wanted("verbose"))))]
    if form == "csv":
        from cgff_cli.report.csv_out import columns

        return columns(found.columns())
    from cgff_cli.report.json_out import pretty

    return pretty(found.to_dict().items())


def _told(name: str, found: "Equilibria") -> ExitCode:
    """Say on standard error what a reader of the exit code alone would miss, and return that code."""
    if found.is_interrupted:
        common.say(f"cgff: {name}: interrupted after {found.starts} starts")
        return ExitCode.INTERRUPTED
    if any(own.stability == "stable" for own in found.shapes):
        return ExitCode.OK
    from cgff_cli.report.equilibria_text import verdict_of

    common.say(f"cgff: {name}: {verdict_of(found)}")
    return ExitCode.NOT_CONVERGED
