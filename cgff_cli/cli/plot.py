"""`cgff plot`: a picture of a structure, of how a solve went, or of a sweep."""

from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import ExitCode, SectionCommand, examples, flag, say, title, warn_of, word_options
from cgff_cli.cli.options import Checked, output_flag
from cgff_cli.cli.targets import check_targets, files_of, form_of_file, refuse_inputs

if TYPE_CHECKING:
    from cgff_cli.report.figure import Shown

_EPILOG = examples(
    "cgff plot prism.yaml -o prism.png",
    "cgff plot tower.json --view front --mode 1 -o mode.svg",
    "cgff plot --sweep rows.csv -o rows.pdf",
)
_PICTURES = {".png": "", ".svg": "", ".pdf": ""}


def _view(text: str) -> Any:
    from cgff_cli.report.picture import view_of

    return view_of(text)


@click.command("plot", cls=SectionCommand, epilog=_EPILOG)
@click.argument("scene", required=False, metavar="[SCENE|RESULT]", type=click.Path(allow_dash=True))
@output_flag("-o", "--output", required=True, help="Write to FILE: .png, .svg or .pdf.")
@flag(
    "--view",
    section="Picture",
    type=Checked("VIEW", _view),
    metavar="VIEW",
    help="front, side, top, iso, or ROUND,UP: degrees round the vertical and up. Default: what shows most.",
)
@flag("--case", section="Picture", metavar="NAME", help="Of a scene, in a load case or combination.")
@flag("--as-given", section="Picture", is_flag=True, help="A scene at its own start, without solving it.")
@flag(
    "--mode",
    section="Picture",
    type=click.IntRange(min=1),
    metavar="K",
    help="Also the K-th of the modes that cgff analyse tells: mechanisms, then softest motions.",
)
@flag("--history", section="Curves", is_flag=True, help="Residual and gradient against iterations, instead.")
@flag(
    "--sweep",
    section="Curves",
    metavar="FILE.csv",
    type=click.Path(),
    help="What a sweep found against what it swept, instead of a structure.",
)
@word_options
@click.pass_context
def command(ctx: click.Context, scene: str | None, output: str, **values: Any) -> None:
    """Draw a structure.

    A scene is solved, and drawn with its start in grey; a result is drawn as it is, and so is a geometry.
    Struts are thick, cables thin, slack ones dashed; colour is force, grey none. It needs matplotlib, the
    extra cgff-cli[plot].
    """
    from cgff_cli.report import figure
    from cgff_cli.report.plots import check_matplotlib

    form = form_of_file("-o", output, _PICTURES) or "png"
    if (scene is None) == (values["sweep"] is None):
        raise click.UsageError("give a SCENE, a RESULT or --sweep FILE.csv")
    inputs = files_of([scene]) if scene else [(values["sweep"], "the rows")]
    targets = check_targets([(output, "the picture")], inputs)
    check_matplotlib("cgff plot")
    if scene is None:
        figure.write_sweep(values["sweep"], output, form)
        return
    asked: Shown = figure.Shown(**{name: values[name] for name in figure.Shown._fields})
    result = figure.result_of(scene, asked)
    refuse_inputs(targets, ((path, f"a file of {title(scene)}") for path in result.source.files))
    unsolved = values["as_given"] or result.source.is_geometry
    warn_of(scene, (result.source if unsolved else result).warnings)
    figure.write_picture(result, asked, output, form)
    if not (unsolved or result.source.is_answer or result.converged):
        say(f"cgff: {title(scene)}: {result.message}")
        ctx.exit(ExitCode.INTERRUPTED if result.interrupted else ExitCode.NOT_CONVERGED)
