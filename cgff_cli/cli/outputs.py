"""Where the results of `cgff solve` go: what its output flags mean together, then the writing itself."""

import os
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from cgff_cli.cli.common import drawn, title, wanted
from cgff_cli.cli.targets import (
    check_targets,
    files_of,
    form_for_file,
    form_of_data,
    form_of_file,
    refuse_inputs,
)
from cgff_cli.report.files import STDOUT, write_output
from cgff_cli.values import ALL_CASES

if TYPE_CHECKING:
    from cgff_cli.result import Result
    from cgff_cli.scene.scene import Scene

_RESULT = {".json": "everything", ".csv": "the coordinates"}
_ONE_OF_ITS_TABLES = {".json": "one object", ".csv": "a table"}
_SUMMARY = {".csv": "", ".jsonl": ""}

_OF_A_RESULT = ("output", "out_dir", "output_format", "history", "elements", "scene_out", "envelope", "case")


class File(NamedTuple):
    """A file to write: where, what (result, history, elements, scene) and how (json, csv, yaml)."""

    path: str
    kind: str
    form: str


@dataclass(frozen=True)
class Writing:
    """Where the result of each scene goes and how: what the processes that solve them have to know.

    flags : those that name files, and --format
    shown : what standard output gets: table, json or csv of the one scene, a summary of many,
            lines of JSON, or nothing. Files silence it, unless --format asks for what no file has.
    """

    flags: Mapping[str, Any]
    shown: str

    @property
    def beside(self) -> list[str]:
        """The file of the envelope, if there is one."""
        return [self.flags["envelope"]] if self.flags["envelope"] else []

    def files(self, scene: str, case: str | None = None) -> list[File]:
        """Return the files that the result of a scene in a case goes to."""
        return list(_files(scene, self.flags, case))

    def write(self, scene: str, result: "Result") -> Iterable[str]:
        """Write one result to its files; return the pieces of standard output. Raises CgffError."""
        files = self.files(scene, result.source.case)
        if self.flags["case"] is not None:  # their names are known only now
            read = ((path, f"a file of {scene}") for path in result.source.files)
            refuse_inputs([(file.path, file.kind) for file in files], read)
        for file in files:
            write_output(file.path, _text(result, file.kind, file.form))
        return () if self.shown in ("", "summary") else _text(result, "result", self.shown)

    def enveloped(self, results: "Sequence[Result]") -> str:
        """Write the envelope of a scene's cases to its file; return its page, where one is shown."""
        from cgff_cli.cases import envelope_of

        envelope = envelope_of(results)
        if self.flags["envelope"]:
            from cgff_cli.report.envelope import envelope_table

            write_output(self.flags["envelope"], envelope_table(results[0], envelope))
        if self.shown != "summary":
            return ""
        from cgff_cli.report.envelope import envelope_page

        return drawn(envelope_page(results[0], envelope))

    def digests(self, paths: Iterable[str]) -> dict[str, str | None]:
        """Return a digest of each file: a loss of power may have cut what was whole."""
        from cgff_cli.study.digest import file_digest

        return {path: file_digest(path) for path in paths}

    def written(self, scene: str, rows: Iterable[Mapping[str, Any]]) -> Iterator[str]:
        """Yield the pieces of standard output of a scene that was solved before: lines, from its files."""
        if self.shown != "lines":
            return
        import json

        from cgff_cli.report import json_out

        for row in rows:
            with open(self.files(scene, row["case"])[0].path, encoding="utf-8") as file:
                yield from json_out.line(json.load(file).items())


class Outputs:
    """What the output flags ask for, all checked before any scene is solved, and the rows of summaries."""

    def __init__(self, scenes: Sequence[str], flags: Mapping[str, Any]):
        _refuse_conflicts(scenes, flags)
        self.summary: str | None = flags["summary"]
        self.as_lines = bool(self.summary) and form_of_file("--summary", self.summary, _SUMMARY) == "jsonl"
        own = {name: flags[name] for name in _OF_A_RESULT}
        many = len(scenes) > 1 or flags["case"] == ALL_CASES
        self.writing = Writing(own, _shown(flags, many))
        self.rows: list[dict[str, Any]] = []
        self.pages: list[str] = []
        files = [
            (file.path, f"the {file.kind} of {scene}")
            for scene in scenes
            for file in self.writing.files(scene, flags["case"])
        ]
        files += [(path, "the envelope") for path in self.writing.beside]
        also = ((flags["files_from"], "the list of scenes"), (flags["start"], "the result it begins at"))
        inputs = chain(((path, what) for path, what in also if path), files_of(scenes))
        self.targets = check_targets([*files, (self.summary, "the summary")], inputs, flags["out_dir"])

    @property
    def on_page(self) -> bool:
        """Whether a terminal shows the page of each result, its warnings among the rest."""
        return self.writing.shown == "table" and sys.stdout.isatty()

    def refuse_inputs(self, scene: "Scene") -> None:
        """Raise UsageError where an output would replace a file that a scene was read from."""
        refuse_inputs(self.targets, ((path, f"a file of {scene.path}") for path in scene.files))

    def failed(self, scene: str, verdict: str) -> None:
        """Remember a scene that has no result, so that the summaries show it."""
        self.rows.append({"scene": title(scene), "verdict": verdict})

    def finish(self) -> None:
        """Write what needed all scenes: the summaries."""
        if self.summary is not None:
            from cgff_cli.report.summary import summary_csv, summary_lines

            write_output(self.summary, (summary_lines if self.as_lines else summary_csv)(self.rows))
        if self.writing.shown == "summary":
            from cgff_cli.report.summary import summary_page

            pages = self.pages if len(self.pages) == 1 else []
            write_output(STDOUT, [drawn(summary_page(self.rows)), *pages])


def _refuse_conflicts(scenes: Sequence[str], flags: Mapping[str, Any]) -> None:
    many = len(scenes) > 1
    for name in ("output", "history", "elements", "scene_out", "envelope"):
        words = "-o" if name == "output" else f"--{name.replace('_', '-')}"
        if many and flags[name] is not None:
            raise click.UsageError(f"{words} takes one scene; use --out-dir DIR for many")
        if flags["case"] == ALL_CASES and name != "envelope" and flags[name] not in (None, STDOUT):
            raise click.UsageError(f"{words} takes one case; use --out-dir DIR for all")
    if flags["envelope"] is not None:
        form_of_file("--envelope", flags["envelope"], {".csv": ""})
        if flags["case"] != ALL_CASES:
            raise click.UsageError("--envelope is that of all cases: it needs --case all")
    if flags["output"] is not None and flags["out_dir"] is not None:
        raise click.UsageError("give -o or --out-dir, not both")
    if flags["out_dir"] is not None and len(set(scenes)) < len(scenes):
        raise click.UsageError("a scene is given twice")
    if flags["output_format"] == "csv" and flags["out_dir"] is None:
        if many:
            raise click.UsageError("--format csv takes one scene; use --out-dir DIR for many")
        if flags["case"] == ALL_CASES:
            raise click.UsageError("--format csv takes one case; use --out-dir DIR for all")


def _files(scene: str, flags: Mapping[str, Any], case: str | None) -> Iterator[File]:
    asked = form_for_file(flags["output_format"], _RESULT)
    if flags["out_dir"] is not None:
        form = asked or "json"
        stem = "stdin" if scene == STDOUT else os.path.splitext(os.path.basename(scene))[0]
        stem = f"{stem}.{case}" if case else stem
        yield File(os.path.join(flags["out_dir"], f"{stem}.{form}"), "result", form)
    if flags["output"] not in (None, STDOUT):
        yield File(flags["output"], "result", form_of_data(asked, flags["output"], _RESULT))
    for kind in ("history", "elements"):
        path = flags[kind]
        if path is not None:
            yield File(path, kind, form_of_file(f"--{kind}", path, _ONE_OF_ITS_TABLES) or "csv")
    if flags["scene_out"] is not None:
        form_of_file("--scene-out", flags["scene_out"], {".yaml": "", ".yml": ""})
        yield File(flags["scene_out"], "scene", "yaml")


def _shown(flags: Mapping[str, Any], many: bool) -> str:
    asked = flags["output_format"]
    filed = flags["out_dir"] is not None or flags["output"] not in (None, STDOUT)
    if filed and asked == form_for_file(asked, _RESULT):
        return ""
    form = form_of_data(flags["output_format"], None)
    if form == "jsonl":
        return "lines"
    return {"table": "summary", "json": "lines"}[form] if many else form


def _text(result: "Result", kind: str, form: str) -> Iterable[str]:
    """Return the pieces of text of one output; its writer is imported now."""
    if kind == "scene":
        from cgff_cli.report.scene_out import scene_text

        return [scene_text(result)]
    if form == "csv":
        from cgff_cli.report import csv_out

        writers = {
            "result": csv_out.coordinate_table,
            "history": csv_out.history,
            "elements": csv_out.elements,
        }
        return writers[kind](result)
    if form == "table":
        from cgff_cli.report.table import result_page

        return [drawn(result_page(result, bool(wanted("verbose"))))]
    from cgff_cli.report import json_out

    if kind == "elements":
        return json_out.array(json_out.element_rows(result))
    layout = json_out.line if form == "lines" else json_out.pretty
    return layout(json_out.result_fields(result) if kind == "result" else result.history.items())
