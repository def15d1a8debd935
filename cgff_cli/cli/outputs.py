"""Where the results of `cgff solve` go: the rules for its output flags, then the writing itself."""

import os
import sys
from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from cgff_cli.cli.common import screen, title, wanted
from cgff_cli.cli.targets import Named, check_targets, files_among, files_of, refuse_inputs
from cgff_cli.report.files import STDOUT, is_stream, write_output

if TYPE_CHECKING:
    from cgff_cli.result import Result
    from cgff_cli.scene.scene import Scene

SUFFIXES = {".json": "json", ".csv": "csv"}


class Flags(NamedTuple):
    """The output flags of one run, as given."""

    output_format: str | None
    output: str | None
    history: str | None
    elements: str | None
    out_dir: str | None
    summary: str | None


class File(NamedTuple):
    """A file to write: where, what (result, history, elements) and how (json, csv)."""

    path: str
    kind: str
    form: str


class Outputs:
    """The rules for the output flags, all checked before any scene is solved.

    files : scene -> the files its result goes to
    shown : what standard output gets: table, json or csv of the one scene, a summary of many,
            lines of JSON, or nothing. Files silence it, unless --format table or jsonl asks for both.
    """

    def __init__(self, scenes: Sequence[str], flags: Flags, list_file: str | None = None):
        many = len(scenes) > 1
        _refuse_conflicts(scenes, flags, many)
        self.files = {scene: list(_files(scene, flags)) for scene in scenes}
        self.shown = _shown(flags, many)
        self.summary = flags.summary
        self.rows: list[dict[str, Any]] = []
        self.targets = self._targets()
        listed = files_among([(list_file, "the list of scenes")])
        check_targets(self.targets, (*listed, *files_of(scenes)), flags.out_dir)

    def _targets(self) -> list[Named]:
        own = [
            (file.path, f"the {file.kind} of {scene}") for scene in self.files for file in self.files[scene]
        ]
        return files_among([*own, (self.summary, "the summary")])

    def refuse_inputs(self, scene: "Scene") -> None:
        """Raise UsageError where an output would replace a file that a scene was read from."""
        refuse_inputs(self.targets, ((path, f"a file of {scene.path}") for path in scene.files))

    def write(self, scene: str, result: "Result") -> Iterable[str]:
        """Write one result to its files; return the pieces of standard output. Raises CgffError."""
        for file in self.files[scene]:
            write_output(file.path, _text(result, file.kind, file.form))
        return () if self.shown in ("", "summary") else _text(result, "result", self.shown)

    def are_there(self, scene: str) -> bool:
        """Return whether all files of a scene were written before."""
        return all(os.path.isfile(file.path) for file in self.files[scene])

    def written(self, scene: str) -> Iterable[str]:
        """Return the pieces of standard output of a scene that was solved before: a line, from its file."""
        if self.shown != "lines":
            return ()
        import json

        from cgff_cli.report import json_out

        with open(self.files[scene][0].path, encoding="utf-8") as file:
            return json_out.line(json.load(file).items())

    def failed(self, scene: str, verdict: str) -> None:
        """Remember a scene that has no result, so that the summaries show it."""
        self.rows.append({"scene": title(scene), "verdict": verdict})

    def finish(self) -> None:
        """Write what needed all scenes: the summaries."""
        if self.summary is not None:
            from cgff_cli.report.summary import summary_csv, summary_lines

            rows = summary_lines if self.summary.lower().endswith(".jsonl") else summary_csv
            write_output(self.summary, rows(self.rows))
        if self.shown == "summary":
            from cgff_cli.report.summary import summary_text

            write_output(STDOUT, [summary_text(self.rows, **screen())])


def _refuse_conflicts(scenes: Sequence[str], flags: Flags, many: bool) -> None:
    for flag, path in (("-o", flags.output), ("--history", flags.history), ("--elements", flags.elements)):
        if many and path is not None:
            raise click.UsageError(f"{flag} takes one scene; use --out-dir DIR for many")
    if flags.output is not None and flags.out_dir is not None:
        raise click.UsageError("give -o or --out-dir, not both")
    if flags.out_dir is not None and len(set(scenes)) < len(scenes):
        raise click.UsageError("a scene is given twice")
    summary = flags.summary
    if summary is not None and not (is_stream(summary) or summary.lower().endswith((".csv", ".jsonl"))):
        raise click.UsageError(f"--summary {summary}: the name must end in .csv or .jsonl")
    if many and flags.output_format == "csv" and flags.out_dir is None:
        raise click.UsageError("--format csv takes one scene; use --out-dir DIR for many")


def _files(scene: str, flags: Flags) -> Iterator[File]:
    chosen = flags.output_format if flags.output_format in ("json", "csv") else None
    if flags.out_dir is not None:
        form = chosen or "json"
        stem = "stdin" if scene == STDOUT else os.path.splitext(os.path.basename(scene))[0]
        yield File(os.path.join(flags.out_dir, f"{stem}.{form}"), "result", form)
    if flags.output is not None and flags.output != STDOUT:
        form = _form("-o", flags.output, chosen or "json")
        if chosen and chosen != form:
            raise click.UsageError(f"--format {chosen} and -o {flags.output} disagree")
        yield File(flags.output, "result", form)
    if flags.history is not None:
        yield File(flags.history, "history", _form("--history", flags.history, "csv"))
    if flags.elements is not None:
        yield File(flags.elements, "elements", _form("--elements", flags.elements, "csv"))


def _form(flag: str, path: str, of_stream: str) -> str:
    """Return the format a file's suffix asks for; a device or pipe has none."""
    suffix = os.path.splitext(path)[1].lower()
    if suffix in SUFFIXES:
        return SUFFIXES[suffix]
    if is_stream(path):
        return of_stream
    contents = "everything) or .csv (the coordinates" if flag == "-o" else "one object) or .csv (a table"
    raise click.UsageError(f"{flag} {path}: the name must end in .json ({contents})")


def _shown(flags: Flags, many: bool) -> str:
    filed = flags.out_dir is not None or flags.output not in (None, STDOUT)
    if filed and flags.output_format not in ("table", "jsonl"):
        return ""
    form = flags.output_format or ("table" if sys.stdout.isatty() else "json")
    if form == "jsonl":
        return "lines"
    return {"table": "summary", "json": "lines"}[form] if many else form


def _text(result: "Result", kind: str, form: str) -> Iterable[str]:
    """Return the pieces of text of one output; its writer is imported now."""
    if form == "csv":
        from cgff_cli.report import csv_out

        writers = {"result": csv_out.coordinates, "history": csv_out.history, "elements": csv_out.elements}
        return writers[kind](result)
    if form == "table":
        from cgff_cli.report.table import result_text

        return [result_text(result, **screen(), full=bool(wanted("verbose")))]
    from cgff_cli.report import json_out

    if form == "lines":
        return json_out.line(json_out.result_fields(result))
    if kind == "result":
        return json_out.pretty(json_out.result_fields(result))
    return json_out.elements(result) if kind == "elements" else json_out.pretty(result.history.items())
