"""`cgff compare`: the same scenes by CGFF and by others, side by side."""

import os
from collections.abc import Iterable, Sequence
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import (
    ExitCode,
    SectionCommand,
    drawn,
    examples,
    failed,
    progress,
    say,
    title,
    wanted,
    warn_of,
    word_options,
    worst,
)
from cgff_cli.cli.comparing import comparing_flags, comparing_options, wanted_methods
from cgff_cli.cli.options import case_flag, once_only, output_flag
from cgff_cli.cli.targets import (
    Named,
    check_targets,
    data_outputs,
    files_of,
    refuse_inputs,
)
from cgff_cli.report.files import STDOUT, write_output

if TYPE_CHECKING:
    from cgff_cli.study.machine import Done
    from cgff_cli.study.record import Comparison
    from cgff_cli.study.scenes import SceneJob

_EPILOG = examples(
    "cgff compare prism.yaml --fdm --fsolve --lm --plot prism.png",
    "cgff compare *.yaml --all -o methods.csv",
)

PICTURES = (".png", ".svg")

_PLOT = output_flag(
    "--plot",
    help="Also draw residual against time and iterations to FILE (.png or .svg); needs matplotlib, the "
    "extra cgff-cli[plot].",
)


@click.command("compare", cls=SectionCommand, epilog=_EPILOG)
@click.argument("scenes", nargs=-1, metavar="[SCENE...]", type=click.Path(allow_dash=True))
@comparing_flags(
    "fdm",
    60.0,
    "Write to FILE: .json everything, .csv a row per scene and method; - is standard output.",
    _PLOT,
    case_flag("Comparing", "In a load case or combination, begun at the scene's own start."),
)
@word_options
@click.pass_context
def command(ctx: click.Context, scenes: tuple[str, ...], **values: Any) -> None:
    """Form-find scenes by CGFF and by other methods, side by side.

    Without a SCENE it takes the paper's three structures, which come with the program. All methods are
    judged by the scene's forces and stop at the same tolerance, and all but --fdm, --afdm, --dsvd and
    --schek, which take no start, begin at the scene's own. A method that fails is a row that says how.
    """
    from cgff_cli.scene.read import PAPER, shipped
    from cgff_cli.study.machine import done
    from cgff_cli.study.scenes import SceneJob

    outputs = data_outputs(values["output_format"], values["output"])
    at_once = [(place, form) for place, form in outputs if place != STDOUT or form == "csv"]
    given = scenes or [shipped(name) for name in PAPER]
    targets = _prepare(given, values["output"], values["plot"])
    options = comparing_options(values) | {"methods": wanted_methods(values, "fdm")}
    found: list[Comparison] = []
    code = ExitCode.OK
    for ended in done(map(SceneJob, given), partial(_compared, options, values["case"], targets)):
        code = worst(code, _told(ended))
        if ended.found is not None:
            found.append(ended.found)
            for place, form in outputs:
                if (place, form) not in at_once:
                    write_output(place, _text([ended.found], form, many=len(given) != 1))
    if code is not ExitCode.INTERRUPTED or found:
        _finish(found, at_once, values["plot"])
    ctx.exit(code)


def _finish(found: "list[Comparison]", outputs: list[tuple[str, str]], plot: str | None) -> None:
    """Write what takes all scenes at once."""
    for place, form in outputs:
        write_output(place, _text(found, form, many=False))
    if plot is not None and found:
        from cgff_cli.report.plots import draw

        draw(found, plot)


def _compared(
    options: dict[str, Any], case: str | None, targets: Sequence[Named], job: "SceneJob"
) -> "Comparison":
    """Return the comparison of one scene, showing on a terminal which method is at work."""
    from cgff_cli.cases import scene_in_case
    from cgff_cli.scene.read import load
    from cgff_cli.study.compare import compare

    scene = load(job.path)
    refuse_inputs(targets, ((file, f"a file of {title(job.path)}") for file in scene.files))
    scene = scene_in_case(scene, case)
    with progress(title(job.path), delay=0.0) as line:
        show = None if line is None else lambda *run: line.show(f"{run[0]}, run {run[1]}")
        return compare(scene, observer=show, **options)


def _told(ended: "Done") -> ExitCode:
    """Say on standard error what a reader of the exit code alone would miss, and return that code."""
    name = title(ended.job.path)
    code = failed(ended, name)
    if code is not None:
        return code
    warn_of(name, ended.found.source.warnings)
    own = ended.found.methods[0]
    if own.converged:
        return ExitCode.OK
    say(f"cgff: {name}: {own.verdict}: {own.message}")
    return ExitCode.NOT_CONVERGED


def _prepare(scenes: Sequence[str], path: str | None, plot: str | None) -> list[Named]:
    """Return the files to write; what cannot be written is refused before any scene is solved."""
    once_only(*scenes)
    if plot is not None:
        from cgff_cli.report.plots import check_matplotlib

        if os.path.splitext(plot)[1].lower() not in PICTURES:
            raise click.UsageError(f"--plot {plot}: the name must end in .png or .svg")
        check_matplotlib()
    return check_targets([(path, "the comparison"), (plot, "the picture")], files_of(scenes))


def _text(found: "list[Comparison]", form: str, many: bool) -> Iterable[str]:
    """Return the pieces of text of comparisons; many: one of several pieces of standard output."""
    if form == "csv":
        from cgff_cli.report.csv_out import comparison_table

        return comparison_table(found)
    if form == "table":
        from cgff_cli.report.comparison_text import comparison_page

        pages = [drawn(comparison_page(one, bool(wanted("verbose")))) for one in found]
        return [*pages, "\n"] if many else pages
    from cgff_cli.report import json_out

    if len(found) == 1:
        layout = json_out.line if many else json_out.pretty
        return layout(found[0].to_dict().items())
    return json_out.array(json_out.encode(one.to_dict()) for one in found)
