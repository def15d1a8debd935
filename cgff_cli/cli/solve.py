"""`cgff solve`: form-find each scene, write what was found, tell how it ended."""

from itertools import chain
from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import (
    ExitCode,
    SectionCommand,
    examples,
    flag,
    progress,
    report_error,
    say,
    title,
    wanted,
    warn_of,
    word_options,
    worst,
)
from cgff_cli.cli.options import (
    Checked,
    given_solve_options,
    output_options,
    scenes_arguments,
    solve_options,
)
from cgff_cli.cli.outputs import Outputs
from cgff_cli.cli.requirements import ALLOWED, Requirement, judged_for, requirements, unmet

if TYPE_CHECKING:
    from cgff_cli.report.result import Result

_EPILOG = examples(
    "cgff solve prism.yaml -o prism.json --history prism.csv",
    "cgff solve *.yaml --out-dir results --require stable,no-slack,max-strain=0.02",
)


@click.command("solve", cls=SectionCommand, epilog=_EPILOG)
@output_options
@flag(
    "--require",
    section="Judging",
    type=Checked("requirements", requirements),
    metavar="WORDS",
    multiple=True,
    help=f"End with exit code 5 where an equilibrium is not all of these: {ALLOWED}.",
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
    options = given_solve_options(values)
    required = tuple(chain.from_iterable(values["require"]))
    outputs = Outputs(scenes, values)
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
    if not outputs.on_page:
        warn_of(scene, result.warnings)
    return _tell(title(scene), result, required)


def _found(path: str, options: dict[str, Any], outputs: Outputs) -> "Result":
    from cgff_cli import pipeline
    from cgff_cli.scene.read import load

    scene = load(path)
    outputs.refuse_inputs(scene)
    with progress(title(path)) as observer:
        return pipeline.solve(scene, observer=observer, **options)


def _tell(name: str, result: "Result", required: tuple[Requirement, ...]) -> ExitCode:
    """Say on standard error what a reader of the exit code alone would miss."""
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
