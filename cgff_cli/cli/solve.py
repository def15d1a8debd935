"""`cgff solve`: form-find each scene, write what was found, tell how it ended."""

from itertools import chain
from typing import Any

import click

from cgff_cli.cli.common import ExitCode, SectionCommand, examples, flag, word_options, worst
from cgff_cli.cli.options import (
    Checked,
    given_solve_options,
    output_flag,
    output_options,
    scenes_arguments,
    solve_options,
)
from cgff_cli.cli.outputs import Outputs
from cgff_cli.cli.requirements import ALLOWED, requirements
from cgff_cli.cli.solving import Solving, earlier, took, watched
from cgff_cli.report.files import STDOUT, is_stream

_EPILOG = examples(
    "cgff solve prism.yaml -o prism.json --history prism.csv",
    "cgff solve *.yaml --out-dir results --require stable,no-slack,max-strain=0.02",
)


@click.command("solve", cls=SectionCommand, epilog=_EPILOG)
@output_options
@flag(
    "--case",
    section="Scenes",
    metavar="NAME",
    help="Solve a load case or combination, from the equilibrium without cases; all: each of them.",
)
@flag(
    "--start",
    section="Scenes",
    metavar="RESULT.json",
    type=click.Path(),
    help="Begin at the shape of a result of the same nodes.",
)
@output_flag("--scene-out", metavar="FILE.yaml", help="Also write the scene with the answer as its start.")
@output_flag(
    "--envelope",
    metavar="FILE.csv",
    help="Also write, with --case all, least and greatest force of each element and reaction.",
)
@flag(
    "--require",
    section="Judging",
    type=Checked("requirements", requirements),
    metavar="WORDS",
    multiple=True,
    help=f"End with exit code 5 where an equilibrium is not all of these: {ALLOWED}.",
)
@flag(
    "--jobs",
    section="Many scenes",
    type=click.IntRange(min=1),
    default=1,
    metavar="N",
    help="Solve N scenes at a time, each in a process of its own. Default: 1.",
)
@flag(
    "--resume",
    section="Many scenes",
    is_flag=True,
    help="Leave alone the results in DIR of scenes that are the same, as is what is asked of them. Each run "
    "with --out-dir notes in DIR what is done; one with --resume wants DIR for itself.",
)
@scenes_arguments
@solve_options
@word_options
@click.pass_context
def command(ctx: click.Context, scenes: tuple[str, ...], **values: Any) -> None:
    """Find the equilibrium shape of each scene.

    A SCENE is a YAML or JSON file, or - for standard input. A solve option given here wins over the
    scene's own `solver` block. A run that does not converge still writes its last state, and says so.
    """
    from cgff_cli.study.machine import done

    piped = any(scene == STDOUT or is_stream(scene) for scene in scenes)
    if values["resume"] and (values["out_dir"] is None or piped):
        raise click.UsageError("--resume needs --out-dir DIR, and scenes that are files")
    outputs = Outputs(scenes, values)
    # Standard input and what a shell opens are there for this process alone, and once.
    processes = 1 if piped else min(values["jobs"], len(scenes))
    required = tuple(chain.from_iterable(values["require"]))
    refuse = outputs.refuse_inputs if piped else None
    asked = given_solve_options(values), outputs.writing, required, processes > 1, refuse
    work = Solving(*asked, values["case"], values["start"])
    code = ExitCode.OK
    with earlier(scenes, work, outputs, values["resume"]) as (jobs, journal, known):
        for ended in watched(done(jobs, work, known, processes), len(scenes), len(known)):
            code = worst(code, took(ended, outputs, journal))
            if code is ExitCode.INTERRUPTED:
                break
    outputs.finish()
    ctx.exit(code)
