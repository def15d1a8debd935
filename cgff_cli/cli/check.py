"""`cgff check`: read and validate scenes, solve nothing."""

from typing import TYPE_CHECKING, Any

import click

from cgff_cli.cli.common import (
    ExitCode,
    SectionCommand,
    SectionOption,
    report_error,
    title,
    warn,
    word_options,
    worst,
)
from cgff_cli.cli.options import scenes_arguments
from cgff_cli.errors import Problem, SceneError
from cgff_cli.report.files import STDOUT, write_output

if TYPE_CHECKING:
    from cgff_cli.scene.scene import Scene

EPILOG = """\b
Examples:
  cgff check prism.yaml
  cgff check *.yaml
  cgff check --format json net.yaml | jq .problems
"""


@click.command("check", cls=SectionCommand, epilog=EPILOG)
@scenes_arguments
@click.option(
    "--format",
    "output_format",
    cls=SectionOption,
    section="Output",
    type=click.Choice(["table", "json", "jsonl"]),
    default="table",
    help="table: a line per good scene (default). json: an object per scene, one per line for many. "
    "jsonl: one per line always.",
)
@word_options
@click.pass_context
def command(ctx: click.Context, scenes: tuple[str, ...], output_format: str) -> None:
    """Read and validate scenes without solving them.

    Every problem of a file is reported at once on standard error, as path:line:column: message.
    """
    code = ExitCode.OK
    for path in scenes:
        record, one = _checked(path)
        code = worst(code, one)
        _write(record, output_format, many=len(scenes) > 1)
    ctx.exit(code)


def _checked(path: str) -> tuple[dict[str, Any], ExitCode]:
    from cgff_cli.scene.read import load

    try:
        scene = load(path)
    except Exception as error:
        problems = error.problems if isinstance(error, SceneError) else ()
        code = report_error(error)
        return _record(path, None, [_placed(problem) for problem in problems]), code
    for warning in scene.warnings:
        warn(f"cgff: {title(path)}: warning: {warning}")
    return _record(path, scene, []), ExitCode.OK


def _placed(problem: Problem) -> dict[str, Any]:
    """Return a problem by field; line and column are null where it has no place."""
    place = {"line": problem.line or None, "column": problem.column or None}
    return {"path": problem.path, **place, "message": problem.message}


def _record(path: str, scene: "Scene | None", problems: list[dict[str, Any]]) -> dict[str, Any]:
    """Return what --format json prints; the counts are null for a scene that cannot be used."""
    return {
        "path": title(path),
        "ok": scene is not None,
        "problems": problems,
        "warnings": list(scene.warnings) if scene else [],
        "name": scene.name if scene else None,
        "law": scene.law if scene else None,
        "dimension": scene.dimension if scene else None,
        "nodes": len(scene.node_names) if scene else None,
        "elements": scene.element_count if scene else None,
        "groups": len(scene.groups) if scene else None,
        "supports": len(scene.supports) if scene else None,
        "loads": len(scene.loads) if scene else None,
    }


def _write(record: dict[str, Any], output_format: str, many: bool) -> None:
    if output_format != "table":
        from cgff_cli.report import json_out

        layout = json_out.line if many or output_format == "jsonl" else json_out.pretty
        write_output(STDOUT, layout(record.items()))
    elif record["ok"]:
        write_output(STDOUT, [_line(record)])


def _line(record: dict[str, Any]) -> str:
    loads = f", {_count(record, 'loads')}" if record["loads"] else ""
    return (
        f"{record['path']}: ok: {_count(record, 'nodes')}, {_count(record, 'elements')} in "
        f"{_count(record, 'groups')}, {record['dimension']}-D, {_count(record, 'supports')}{loads}, "
        f"law {record['law']}\n"
    )


def _count(record: dict[str, Any], plural: str) -> str:
    """Return "no supports", "1 support" or "2 supports"."""
    number = record[plural]
    return f"{number or 'no'} {plural if number != 1 else plural[:-1]}"
