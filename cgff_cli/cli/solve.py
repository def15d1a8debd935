"""`cgff solve`: form-find each scene, write what was found, tell how it ended."""

import sys
from itertools import chain
from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import (
    ExitCode,
    SectionCommand,
    SectionOption,
    report_error,
    say,
    title,
    wanted,
    warn,
    word_options,
    worst,
)
from cgff_cli.cli.options import (
    given_solve_options,
    list_given,
    output_options,
    scenes_arguments,
    solve_options,
)
from cgff_cli.cli.outputs import Flags, Outputs
from cgff_cli.cli.requirements import ALLOWED, Requirement, Requirements, judged_for, unmet

if TYPE_CHECKING:
    from cgff_cli.result import Result

EPILOG = """\b
Examples:
  cgff solve prism.yaml
  cgff solve prism.yaml -o prism.json --history prism-history.csv
  cgff solve *.yaml --out-dir results --summary results.csv
  find . -name "*.yaml" | cgff solve --files-from - --format jsonl
  cgff solve net.yaml --format csv > shape.csv
  cgff solve tower.yaml --require stable,no-slack,max-strain=0.02
  cat prism.yaml | cgff solve - | jq .analysis
"""


@click.command("solve", cls=SectionCommand, epilog=EPILOG)
@scenes_arguments
@output_options
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
    options = given_solve_options(values)
    required = tuple(chain.from_iterable(values["require"]))
    outputs = Outputs(scenes, Flags(*(values[name] for name in Flags._fields)), list_given())
    code = ExitCode.OK
    for scene in scenes:
        code = worst(code, _solve(scene, options, outputs, required))
        if code is ExitCode.INTERRUPTED:
            break
    outputs.finish()
    ctx.exit(code)


def _solve(
    scene: str, options: dict[str, Any], outputs: Outputs, required: tuple[Requirement, ...]
) -> ExitCode:
    """Solve and write one scene; what goes wrong with it is told and stops no other."""
    try:
        result = judged_for(_found(scene, options, outputs), required)
        outputs.write(scene, result)
    except KeyboardInterrupt:  # outside the solver, which keeps what it has reached
        say("cgff: interrupted")
        return ExitCode.INTERRUPTED
    except (BrokenPipeError, click.UsageError):
        raise
    except Exception as error:
        code = report_error(error)
        outputs.failed(scene, "bad_scene" if code is ExitCode.SCENE else "error")
        return code
    return _tell(scene, result, required)


def _found(path: str, options: dict[str, Any], outputs: Outputs) -> "Result":
    from cgff_cli import pipeline
    from cgff_cli.scene.read import load

    scene = load(path)
    outputs.refuse_inputs(scene)
    if wanted("quiet") or not sys.stderr.isatty():
        return pipeline.solve(scene, **options)
    from cgff_cli.report.progress import Progress

    with Progress(title(path)) as progress:
        return pipeline.solve(scene, observer=progress, **options)


def _tell(scene: str, result: "Result", required: tuple[Requirement, ...]) -> ExitCode:
    """Say on standard error what a reader of the exit code alone would miss."""
    name = title(scene)
    for warning in result.warnings:
        warn(f"cgff: {name}: warning: {warning}")
    if not result.converged or result.interrupted or wanted("verbose"):
        say(f"cgff: {name}: {result.verdict}: {result.message}")
    if result.interrupted:
        return ExitCode.INTERRUPTED
    if not result.converged:
        return ExitCode.NOT_CONVERGED
    lacking = unmet(result, required)
    for sentence in lacking:
        say(f"cgff: {name}: {sentence}")
    return ExitCode.UNMET if lacking else ExitCode.OK
