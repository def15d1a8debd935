"""`cgff prestress`: rest lengths that hold a geometry, and the scene that has them."""

import sys
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import (
    ExitCode,
    SectionCommand,
    drawn,
    examples,
    flag,
    flags,
    say,
    title,
    wanted,
    warn_of,
    word_options,
)
from cgff_cli.cli.options import Checked, by_key, format_flag, output_flag
from cgff_cli.cli.targets import check_targets, files_of, form_of_file, refuse_inputs
from cgff_cli.errors import OptionError
from cgff_cli.report.files import STDOUT, write_output

if TYPE_CHECKING:
    from cgff_cli.rest_lengths import Prestressed

_SUFFIXES = {".yaml": "", ".yml": ""}

_EPILOG = examples(
    "cgff prestress shape.yaml -o scene.yaml",
    "cgff prestress shape.yaml --by-symmetry --force struts=-20 | cgff solve -",
    "cgff prestress shape.yaml --format json | jq .certificate",
)


def _force(text: str) -> tuple[str, float]:
    name, _, number = text.rpartition("=")
    try:
        return name, float(number)
    except ValueError:
        raise OptionError(f"must be GROUP=VALUE, as in struts=-20, got {text!r}") from None


def _tolerance(value: object) -> Any:
    from cgff_cli.rest_lengths import TOLERABLE

    return TOLERABLE.checked("tolerance", value)


_question = flags(
    flag("--by-group", is_flag=True, help="One force density for all members of a group."),
    flag("--by-symmetry", is_flag=True, help="One for all members that a symmetry of the shape exchanges."),
    flag(
        "--equal",
        type=click.Choice(["force"]),
        help="With one of these: one force in place of one force density.",
    ),
    flag(
        "--force",
        type=Checked("force", _force),
        multiple=True,
        metavar="GROUP=VALUE",
        help="Greatest force in GROUP. Default: the greatest strain of a cable is 1 %.",
    ),
    flag(
        "--tolerance",
        type=Checked("X", _tolerance, float),
        metavar="X",
        help="For coordinates that were rounded or measured: singular values up to X count as zero, and the "
        "nodes move to the nearest shape that balances. Default: 1e-9, and no node moves.",
    ),
)


@click.command("prestress", cls=SectionCommand, epilog=_EPILOG)
@output_flag("-o", "--output", dash=True, help="Write the scene to FILE (.yaml or .yml).")
@format_flag(
    "table",
    "json",
    help="Write a page, or everything that was found, to standard output. Default: the scene; with -o FILE "
    "a page on a terminal, nothing in a pipe.",
)
@_question
@click.argument("scene", metavar="SCENE", type=click.Path(allow_dash=True))
@word_options
@click.pass_context
def command(ctx: click.Context, scene: str, **values: Any) -> None:
    """Find rest lengths that hold a geometry at its own coordinates.

    SCENE needs no rest lengths; where it has some they are taken only where rounding hides others.
    Supports and loads hold. Where no self-stress has the right signs nothing is written, the exit code is
    5, and the reason is told.
    """
    from cgff_cli.rest_lengths import prestress
    from cgff_cli.scene.read import load

    output, form = values["output"], values["output_format"]
    force = by_key("--force", values["force"])
    if output == STDOUT and form is not None:
        raise click.UsageError(
            f"-o - writes the scene to standard output, and so --format {form} has no place"
        )
    if output not in (None, STDOUT):
        form_of_file("-o", output, _SUFFIXES, "the name of a scene")
    targets = check_targets([(output, "the scene")], files_of([scene]))
    shape = load(scene)
    refuse_inputs(targets, ((path, f"a file of {title(scene)}") for path in shape.files))
    given = {name: values[name] for name in ("by_group", "by_symmetry", "equal", "tolerance") if values[name]}
    found = prestress(shape, **given, force=force)
    on_page = _write(found, output, form)
    if not on_page:
        warn_of(scene, found.warnings)
    if found.scene is None:
        say(
            f"cgff: {title(scene)}: {'undecided' if found.feasible is None else 'impossible'}: {found.reason}"
        )
    elif wanted("verbose") and not on_page:
        say(f"cgff: {title(scene)}: {_verdict(found)}")
    ctx.exit(ExitCode.OK if found.feasible else ExitCode.UNMET)


def _write(found: "Prestressed", output: str | None, form: str | None) -> bool:
    """Write the scene, and to standard output what else was asked for; return whether that was the page."""
    is_filed = output not in (None, STDOUT)
    if found.scene is not None and (is_filed or form is None or output == STDOUT):
        from cgff_cli.scene.write import to_yaml

        write_output(output or STDOUT, [to_yaml(found.scene, _verdict(found))])
    if form is None and is_filed and sys.stdout.isatty():
        form = "table"
    if form is not None:
        write_output(STDOUT, _text(found, form))
    return form == "table"


def _verdict(found: "Prestressed") -> str:
    from cgff_cli.report.prestress_text import verdict

    return verdict(found)


def _text(found: "Prestressed", form: str) -> Iterable[str]:
    if form == "json":
        from cgff_cli.report import json_out

        return json_out.pretty(found.to_dict().items())
    from cgff_cli.report.prestress_text import prestress_page

    return [drawn(prestress_page(found))]
