"""`cgff view`: one page that shows structures in a browser."""

from itertools import chain
from typing import Any

import click

from cgff_cli.cli.common import ExitCode, SectionCommand, examples, flag, word_options, worst
from cgff_cli.cli.options import output_flag
from cgff_cli.cli.showing import shown_of
from cgff_cli.cli.targets import check_targets, files_of, form_of_file

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
    exhibits, code = [], ExitCode.OK
    each = (shown_of(path, values["case"], values["as_given"], targets) for path in scenes)
    for result, ended in chain.from_iterable(each):
        code = worst(code, ended)
        exhibits.append(view.exhibit_of(result, 0 if result.interrupted else values["modes"]))
        if result.interrupted:
            break
    write_output(output, [view.page_of(exhibits)])
    ctx.exit(code)
