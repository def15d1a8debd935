"""`cgff sweep`: one scene solved for many sets of numbers, a row for each."""

from typing import Any

import click

from cgff_cli.cli.common import SectionCommand, examples, flag, note_of, title, warn_of, word_options
from cgff_cli.cli.options import (
    by_key,
    case_flag,
    format_flag,
    given_solve_options,
    output_flag,
    solve_options,
)
from cgff_cli.cli.sweeping import KeyValues, Shard, checked_form, swept

_EPILOG = examples(
    "cgff sweep prism.yaml --set struts.EA=log:10:1e4:50 --out height --out force:struts -o rows.csv",
    "cgff sweep net.yaml --scale cables.rest_length=0.9:1.1:21 --jobs 4 --resume -o rows.jsonl",
)
_VALUES = "LEAST:GREATEST:COUNT, log:LEAST:GREATEST:COUNT, or numbers with commas"
_KEYS = (
    "GROUP.rest_length, .EA, .pretension, .weight, or A,B for GROUP, one element by its nodes, "
    "nodes.NAME.x, loads.NAME.x, case.NAME, the factor of a load case or combination"
)
_OUT = "Also tell: force:GROUP (least and greatest), length:A,B, node:NAME, slack, max_strain or height."


@click.command("sweep", cls=SectionCommand, epilog=_EPILOG)
@click.argument("scene", type=click.Path(allow_dash=True))
@flag(
    *("--set", "values"),
    section="What is swept",
    type=KeyValues(),
    multiple=True,
    help=f"Give KEY values: {_VALUES}. Keys: {_KEYS}.",
)
@flag(
    *("--scale", "factors"),
    section="What is swept",
    type=KeyValues(),
    multiple=True,
    help="The same with factors, of the scene's own numbers, or of all its loads by the key loads.",
)
@case_flag("What is swept", "Add a load case or combination to every row.")
@flag(
    *("--zip", "is_zipped"),
    section="What is swept",
    is_flag=True,
    help="Take values side by side. Default: all combinations, the last key fastest.",
)
@flag(
    "--random",
    section="What is swept",
    type=click.IntRange(min=1),
    metavar="N",
    help="Take N rows at random, by --seed: between LEAST and GREATEST, without COUNT, or among numbers.",
)
@flag(
    "--follow",
    section="What is swept",
    is_flag=True,
    help="Take a path: each row starts from the shape of the last, and what is lost on the way is told.",
)
@flag(*("--out", "outs"), section="Output", multiple=True, metavar="WORD", help=_OUT)
@output_flag(
    *("-o", "--output"),
    dash=True,
    help="Write to FILE (.csv, .jsonl); it grows as FILE.part until all is done.",
)
@format_flag("csv", "jsonl", help="What to write to standard output. Default: csv.")
@flag("--no-header", section="Output", is_flag=True, help="No line of names above a CSV.")
@flag("--resume", section="Many rows", is_flag=True, help="Go on with FILE where an earlier run ended.")
@flag(
    "--jobs",
    section="Many rows",
    type=click.IntRange(min=1),
    default=1,
    metavar="N",
    help="Processes at work; no row depends on it. Default: 1.",
)
@flag(
    "--shard", section="Many rows", type=Shard(), default="1/1", help="The i-th of n parts, for job arrays."
)
@flag("--dask", section="Many rows", metavar="ADDRESS", help="Let the workers of a dask scheduler do it.")
@solve_options
@word_options
@click.pass_context
def command(ctx: click.Context, scene: str, **values: Any) -> None:
    """Solve a scene for many sets of numbers, a row for each.

    Every row starts from the scene's own start, and depends on nothing but its numbers. A run that was
    killed goes on with --resume, to the same bytes as one that was not.
    """
    from cgff_cli.cases import scene_in_case
    from cgff_cli.scene.read import load
    from cgff_cli.study.sweep import planned

    form = checked_form(scene, values)
    read = load(scene)
    warn_of(scene, read.warnings)
    note_of(scene, read.notes)
    plan = planned(
        scene_in_case(read, values["case"]),
        set=by_key("--set", values["values"]),
        scale=by_key("--scale", values["factors"]),
        out=values["outs"],
        zip=values["is_zipped"],
        random=values["random"],
        **given_solve_options(values),
    )
    ctx.exit(swept(title(scene), plan, form, values))
