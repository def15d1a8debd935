"""`cgff convert`: a file of another program to a scene, a scene or a result to a file of another."""

from functools import partial
from typing import Any

import click

from cgff_cli.cli.common import (
    SectionCommand,
    examples,
    flag,
    flags,
    say,
    title,
    wanted,
    warn_of,
    word_options,
)
from cgff_cli.cli.options import Checked, by_key, once_only, output_flag
from cgff_cli.cli.targets import check_targets, form_of_file, refuse_inputs
from cgff_cli.errors import OptionError
from cgff_cli.report.files import STDOUT, write_bytes, write_output
from cgff_cli.values import Rule

_SOURCES, _TARGETS = ("scene", "ntrt", "byu", "obj", "csv"), ("scene", "obj", "vtu", "dxf")
_SUFFIXES = {".yaml": "a scene", ".yml": "a scene", ".obj": "", ".vtu": "", ".dxf": ""}

_EPILOG = examples(
    "cgff convert robot.yaml --strut-EA 1e5 -o scene.yaml",
    "cgff convert net.obj --law hooke --EA 500 --kind cable | cgff prestress -",
    "cgff solve prism.yaml -o prism.json && cgff convert prism.json -o prism.vtu",
)


_GIVEN = ("nodes", "law", "EA", "strut_EA", "merge")

_ask = partial(flag, section="What a file does not say")
_EA = Checked("X", partial(Rule(positive=True).checked, "EA"), float)
_LENGTH = Checked("X", partial(Rule(positive=True).checked, "merge"), float)
_KIND = Checked("KIND", lambda text: text.rpartition("=")[::2])  # group, or "" of all others; kind
_unsaid = flags(
    _ask("--nodes", metavar="FILE", type=click.Path(), help="Beside a CSV of edges: that of its nodes."),
    _ask("--law", type=click.Choice(["paper", "hooke"]), help="What EA means. For OBJ, CSV, results."),
    _ask("--EA", "EA", metavar="X", type=_EA, help="EA of cables, and of struts too. For OBJ, CSV, results."),
    _ask("--strut-EA", "strut_EA", metavar="X", type=_EA, help="EA of struts; NTRT's are rigid."),
    _ask("--merge", metavar="X", type=_LENGTH, help="Vertices of an OBJ up to X apart are one node."),
    _ask("--kind", metavar="[GROUP=]KIND", multiple=True, type=_KIND, help="cable or strut; OBJ and CSV."),
)


@click.command("convert", cls=SectionCommand, epilog=_EPILOG)
@output_flag("-o", "--output", dash=True, default=STDOUT, help="A .yaml scene, .obj, .vtu or .dxf.")
@flag("--from", "source", type=click.Choice(_SOURCES), help="Default: by suffix and content of FILE.")
@flag("--to", "target", type=click.Choice(_TARGETS), help="Default: by suffix of -o, else a scene.")
@_unsaid
@click.argument("file", metavar="FILE", type=click.Path(allow_dash=True))
@word_options
def command(file: str, output: str, source: str | None, target: str | None, **values: Any) -> None:
    """Turn files of other programs into scenes, and back.

    FILE is NASA NTRT or BYU TensegritySim YAML, OBJ lines, a CSV of edges, a scene, or a result of `solve`.
    What was assumed stands in the scene as comments; what is left out is said on standard error. With --law
    or --EA a result's elements are made anew, with its forces as their pretension.
    """
    from cgff_cli.formats.convert import convert

    form, kinds = _form(output, target), by_key("--kind", values["kind"])
    once_only(file, values["nodes"])
    targets = check_targets([(output, "what is converted")], [(file, "the file it is converted from")])
    given = {name: values[name] for name in _GIVEN if values[name] is not None}
    converted = convert(file, source=source, kind=kinds, **given)
    refuse_inputs(targets, ((path, f"a file of {title(file)}") for path in converted.scene.files))
    written = converted.written(form)
    if isinstance(written, bytes):
        write_bytes(output, written)
    else:
        write_output(output, [written])
    warn_of(file, converted.scene.warnings)
    for what in () if wanted("quiet") else converted.not_kept(form):
        say(f"cgff: {title(file)}: left out: {what}")


def _form(output: str, target: str | None) -> str:
    """Return the format to write, by --to and by the suffix of -o, which must agree."""
    suffix = None if output == STDOUT else form_of_file("-o", output, _SUFFIXES)
    form = {"yaml": "scene", "yml": "scene"}.get(str(suffix), suffix)
    if None not in (form, target) and form != target:
        raise click.UsageError(f"--to {target} and -o {output} disagree")
    if (form or target) == "vtu" and output == STDOUT:
        raise OptionError("VTU is no text: give -o FILE.vtu")
    return form or target or "scene"
