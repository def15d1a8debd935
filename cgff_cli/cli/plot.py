"""`cgff plot`: a picture of a structure, of how a solve went, or of a sweep."""

from typing import Any

import click

from cgff_cli.cli.common import SectionCommand, examples, flag, word_options
from cgff_cli.cli.options import Checked, output_flag
from cgff_cli.cli.showing import shown_of
from cgff_cli.cli.targets import check_targets, files_of, form_of_file
from cgff_cli.values import ALL_CASES

_EPILOG = examples(
    "cgff plot prism.yaml -o prism.png",
    "cgff plot tower.json --view front --mode 1 -o mode.svg",
    "cgff plot --sweep rows.csv --x node:top.x --y node:top.z -o path.pdf",
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
@flag("--x", section="Curves", metavar="COLUMN", help="Of --sweep, what stands across.")
@flag("--y", section="Curves", metavar="COLUMN", multiple=True, help="Of --sweep, what is drawn; repeatable.")
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
    if scene is not None and (values["x"] or values["y"]):
        raise click.UsageError("--x and --y are columns of --sweep FILE.csv")
    case, as_given = values.pop("case"), values.pop("as_given")
    if case == ALL_CASES:
        raise click.UsageError("--case all: a picture is of one case; cgff view shows all")
    inputs = files_of([scene]) if scene else [(values["sweep"], "the rows")]
    targets = check_targets([(output, "the picture")], inputs)
    check_matplotlib("cgff plot")
    if scene is None:
        figure.write_sweep(values["sweep"], output, form, values["x"], values["y"])
        return
    ((result, code),) = shown_of(scene, case, as_given, targets)
    asked = figure.Shown(**{name: values[name] for name in figure.Shown._fields})
    figure.write_picture(result, asked, output, form)
    ctx.exit(code)
