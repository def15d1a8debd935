"""`cgff solve`: form-find each scene, write what was found, tell how it ended."""

from itertools import chain
from typing import Any

import click

from cgff_cli.cli.common import ExitCode, SectionCommand, SectionOption, word_options, worst
from cgff_cli.cli.options import (
    given_solve_options,
    list_given,
    output_options,
    scenes_arguments,
    solve_options,
)
from cgff_cli.cli.outputs import Flags, Outputs
from cgff_cli.cli.requirements import ALLOWED, Requirements
from cgff_cli.cli.solving import Solving, earlier, took, watched
from cgff_cli.report.files import STDOUT

EPILOG = """\b
Examples:
  cgff solve prism.yaml
  cgff solve prism.yaml -o prism.json --history prism-history.csv
  cgff solve *.yaml --out-dir results --summary results.csv
  cgff solve *.yaml --out-dir results --jobs 4 --resume
  find . -name "*.yaml" | cgff solve --files-from - --format jsonl
  cgff solve net.yaml --format csv > shape.csv
  cgff solve tower.yaml --require stable,no-slack,max-strain=0.02
  cat prism.yaml | cgff solve - | jq .analysis
"""


@click.command("solve", cls=SectionCommand, epilog=EPILOG)
@scenes_arguments
@output_options
@click.option(
    "--jobs",
    cls=SectionOption,
    section="Many scenes",
    type=click.IntRange(min=1),
    default=1,
    metavar="N",
    help="Solve N scenes at a time, each in a process of its own. Default: 1.",
)
@click.option(
    "--resume",
    cls=SectionOption,
    section="Many scenes",
    is_flag=True,
    help="Leave alone what an earlier run with --resume has put into DIR, unless its scene or what is asked "
    "has changed.",
)
@solve_options
@click.option(
    "--require",
    cls=SectionOption,
    section="Judging",
    type=Requirements(),
    metavar="WORDS",
    multiple=True,
    help=f"End with exit code 5 where an equilibrium is not all of these: {ALLOWED}.",
)
@word_options
@click.pass_context
def command(ctx: click.Context, scenes: tuple[str, ...], **values: Any) -> None:
    """Find the equilibrium shape of each scene.

    A SCENE is a YAML or JSON file, or - for standard input. A solve option given here wins over the
    scene's own `solver` block. A run that does not converge still writes its last state, and says so.
    """
    from cgff_cli.study.machine import done

    if values["resume"] and (values["out_dir"] is None or STDOUT in scenes):
        raise click.UsageError("--resume needs --out-dir DIR, and scenes that are files")
    outputs = Outputs(scenes, Flags(*(values[name] for name in Flags._fields)), list_given())
    # Standard input is there for this process alone.
    processes = 1 if STDOUT in scenes else min(values["jobs"], len(scenes))
    required = tuple(chain.from_iterable(values["require"]))
    work = Solving(given_solve_options(values), outputs, required, apart=processes > 1)
    jobs, journal, known = earlier(scenes, work, values["out_dir"] if values["resume"] else None)
    code = ExitCode.OK
    for ended in watched(done(jobs, work, known, processes), len(jobs), processes):
        code = worst(code, took(ended, outputs, journal))
        if code is ExitCode.INTERRUPTED:
            break
    outputs.finish()
    ctx.exit(code)
