"""`cgff check`: read and validate scenes, solve nothing."""

import sys
from collections.abc import Iterable, Sized
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import (
    ExitCode,
    SectionCommand,
    examples,
    note_of,
    report_error,
    title,
    warn_of,
    word_options,
    worst,
)
from cgff_cli.cli.options import format_flag, scenes_arguments
from cgff_cli.errors import Problem, SceneError
from cgff_cli.hints import count
from cgff_cli.report.files import STDOUT, write_output

if TYPE_CHECKING:
    from cgff_cli.scene.scene import Scene

_EPILOG = examples("cgff check *.yaml", "cgff check --format json net.yaml | jq .problems")


@click.command("check", cls=SectionCommand, epilog=_EPILOG)
@format_flag(
    "table",
    "json",
    "jsonl",
    default="table",
    help="table: a line per good scene (default). json: an object per scene, one per line for many. "
    "jsonl: one per line always.",
)
@scenes_arguments
@word_options
@click.pass_context
def command(ctx: click.Context, scenes: tuple[str, ...], output_format: str, **_: Any) -> None:
    """Read and validate scenes without solving them.

    Every problem of a file is reported at once on standard error, as path:line:column: message.
    """
    code = ExitCode.OK
    for path in scenes:
        record, one = _checked(path)
        code = worst(code, one)
        if output_format != "table" or record["ok"]:
            lines = len(scenes) > 1 or output_format == "jsonl"
            write_output(STDOUT, _line(record) if output_format == "table" else _json(record, lines))
    ctx.exit(code)


def _checked(path: str) -> tuple[dict[str, Any], ExitCode]:
    from cgff_cli.scene.read import load

    try:
        scene = load(path)
    except Exception as error:
        problems = error.problems if isinstance(error, SceneError) else ()
        code = report_error(error)
        return _record(path, None, problems), code
    warn_of(path, scene.warnings)
    note_of(path, scene.notes)
    return _record(path, scene, ()), ExitCode.OK


def _record(path: str, scene: "Scene | None", problems: Iterable[Problem]) -> dict[str, Any]:
    """Return what --format json prints: null where a problem has no place, or a scene cannot be used."""
    held: tuple[Sized, ...] = ()
    if scene is not None:
        elements = range(scene.element_count)
        held = (scene.node_names, elements, scene.groups, scene.supports, scene.loads)
        held = (*held, scene.load_cases, scene.combinations)
    return {
        "path": title(path),
        "ok": scene is not None,
        "problems": [{name: value or None for name, value in own._asdict().items()} for own in problems],
        "warnings": list(scene.warnings) if scene else [],
        **{name: getattr(scene, name, None) for name in ("name", "law", "dimension")},
        "geometry": scene.is_geometry if scene else None,
        **dict(zip_longest(_COUNTED, map(len, held))),
    }


_COUNTED = ("nodes", "elements", "groups", "supports", "loads", "load_cases", "combinations")


def _json(record: dict[str, Any], lines: bool) -> Iterable[str]:
    from cgff_cli.report import json_out

    return (json_out.line if lines else json_out.pretty)(record.items())


def _line(record: dict[str, Any]) -> list[str]:
    """Return what is said of a good scene, wrapped where a terminal is too narrow for it."""
    told = {noun: count(record[noun], noun[:-1].replace("_", " ")) for noun in _COUNTED}
    nodes, elements, groups, supports = (told[noun] for noun in _COUNTED[:4])
    held = ", ".join([supports, *(told[noun] for noun in _COUNTED[4:] if record[noun])])
    line = (
        f"{record['path']}: ok: {nodes}, {elements} in {groups}, {record['dimension']}-D, {held}, "
        f"law {record['law']}{', a geometry without rest lengths' if record['geometry'] else ''}"
    )
    if not sys.stdout.isatty():
        return [f"{line}\n"]
    from shutil import get_terminal_size
    from textwrap import fill

    return [fill(line, get_terminal_size().columns, break_on_hyphens=False), "\n"]
