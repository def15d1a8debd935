"""What `cgff sweep` does with a plan: rows as text, made where the work is done, and where they go."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import click

from cgff_cli import __version__
from cgff_cli.cli.common import ExitCode, failed, progress, report_error, say, wanted, worst
from cgff_cli.cli.targets import check_targets, files_of, form_of_data
from cgff_cli.errors import CgffError
from cgff_cli.hints import count
from cgff_cli.report.files import STDOUT, TEXT, is_stream, opened

if TYPE_CHECKING:
    from cgff_cli.report.rows_file import Sink
    from cgff_cli.study.machine import Done
    from cgff_cli.study.path import Path
    from cgff_cli.study.sweep import Span, Sweep

_ROWS = {".csv": "", ".jsonl": ""}
_OF_ROWS = {
    "not_converged": "did not converge",
    "not_judged": "without stability: forces left over blur its sign; a smaller --tolerance may tell",
    "no_jump": "without jump: the shape before is not stable, so that none is predicted from it",
}
"""What is said of rows on standard error, by what counts them."""


class KeyValues(click.ParamType):
    """A key and its values, KEY=VALUES; a key may hold =, values do not."""

    name = "KEY=VALUES"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[str, str]:
        """Return the key and its values."""
        key, _, values = value.rpartition("=")
        if not (key and values):
            self.fail(f"must be KEY=VALUES, got {value!r}", param, ctx)
        return key, values


class Shard(click.ParamType):
    """A part of a whole, i/n, the first being 1/n."""

    name = "i/n"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> tuple[int, int]:
        """Return i and n."""
        words = value.split("/")
        if len(words) != 2 or not all(word.isdecimal() for word in words):
            self.fail(f"must be i/n, such as 2/10, got {value!r}", param, ctx)
        i, n = map(int, words)
        if not 1 <= i <= n:
            self.fail(f"must lie between 1/{n} and {n}/{n}, got {value!r}", param, ctx)
        return i, n


class Written(NamedTuple):
    """The rows of a chunk as text, and how many they are and of each kind, by COUNTS; what a path keeps."""

    text: str
    rows_done: int = 0
    not_converged: int = 0
    bad: int = 0
    not_judged: int = 0
    no_jump: int = 0
    kept: dict[str, Any] | None = None


@dataclass(frozen=True)
class RowsWriting:
    """The work on a chunk: its rows as text, csv or jsonl."""

    plan: "Sweep"
    form: str

    def __call__(self, span: "Span") -> Written:
        """Solve a chunk."""
        block = self.plan.solved(span)
        counts = span.last - span.first, block.not_converged, block.bad, block.not_judged
        return Written(as_text(self.form, block.columns), *counts)


def as_text(form: str, columns: Mapping[str, Sequence[Any]]) -> str:
    """Return rows given as columns by name, without a header."""
    if form == "csv":
        from cgff_cli.report.csv_out import rows

        return "".join(rows(columns))
    from cgff_cli.report.json_out import lines

    return "".join(lines(columns))


def checked_form(scene: str, values: Mapping[str, Any]) -> str:
    """Return the form of the rows, csv or jsonl, after refusing outputs that cannot be."""
    path = values["output"]
    form = form_of_data(values["output_format"], path, _ROWS, "csv")
    if _is_a_file(path):
        own = ((path, "the rows"), (f"{path}.part", "rows under way"), (f"{path}.sweep.json", "its sidecar"))
        check_targets(own, files_of([scene]))
    elif values["resume"]:
        raise click.UsageError("--resume needs -o FILE")
    if values["follow"] and (values["jobs"] > 1 or values["shard"] != (1, 1) or values["dask"]):
        raise click.UsageError("--follow goes step by step: without --jobs, --shard and --dask")
    return form


def swept(name: str, plan: "Sweep", form: str, values: Mapping[str, Any]) -> ExitCode:
    """Work out all rows and write them; return how that ended."""
    rows, path = plan.rows_of(values["shard"]), None
    if values["follow"]:
        from cgff_cli.study.path import followed

        path = followed(plan)
    header = (path or plan).names if form == "csv" and not values["no_header"] else ()
    with _sink(plan, rows, values) as sink:
        left = rows[sink.counts["rows_done"] :]
        found = _walked(path, form, sink, name) if path else _worked_out(plan, form, left, values)
        try:
            code = _filled(sink, name, header, found, len(rows))
        except KeyboardInterrupt:
            say(f"cgff: {name}: interrupted")
            code = ExitCode.INTERRUPTED
        except CgffError as error:
            code = report_error(error)
        told = _told(name, sink.counts, len(rows), _is_a_file(values["output"]))
        if code is ExitCode.OK:
            sink.finish()
    return worst(code, told)


def _filled(sink: "Sink", name: str, header: Sequence[str], found: "Iterator[Done]", total: int) -> ExitCode:
    """Give a sink the rows it has not yet, the header before the first; return what ended that."""
    if header and not sink.counts["bytes"]:
        from cgff_cli.report.csv_out import columns

        sink.add("".join(columns(dict.fromkeys(header, ()))))
    before = sink.counts["rows_done"]
    with progress(name, delay=0.0) as line:
        for ended in found:
            code = failed(ended, name)
            if code is not None:
                return code
            sink.add(**ended.found._asdict())
            if line is not None:
                line.count(sink.counts["rows_done"], total, "rows", before)
    return ExitCode.OK


def _worked_out(plan: "Sweep", form: str, left: range, values: Mapping[str, Any]) -> "Iterator[Done]":
    """Yield what became of the chunks of the rows left."""
    from cgff_cli.study.machine import done

    processes = min(values["jobs"], max(1, -(-len(left) // plan.at_once)))
    work = RowsWriting(plan.for_workers, form)
    return done(plan.chunks(left), work, None, processes, _others(values["dask"], left))


def _walked(path: "Path", form: str, sink: "Sink", name: str) -> "Iterator[Done]":
    """Yield the rows of a path from where an earlier run left it, and say where an equilibrium is lost."""
    import numpy as np

    from cgff_cli.study.machine import Done
    from cgff_cli.study.path import PathPoint

    if (last := sink.kept.get("here")) is not None:
        path.here = PathPoint(last["value"], np.array(last["shape"]), last["stability"])
    for stop in path.stops(sink.counts["rows_done"]):
        for value in stop.lost:
            say(f"cgff: {name}: an equilibrium is lost at {path.axis.key} = {value:.9g}")
        here = stop.here
        kept = None if here is None else {"here": {**vars(here), "shape": here.shape.tolist()}}
        row = as_text(form, {column: [value] for column, value in stop.row.items()})
        missed = int(not stop.row["converged"]), 0, int(stop.not_judged), int(stop.no_jump)
        yield Done(path, Written(row, 1, *missed, kept))


def _others(address: str | None, left: range) -> AbstractContextManager[Any] | None:
    """Return who works elsewhere, where that is asked for and something is left to do."""
    if not address or not left:
        return None
    from cgff_cli.study.dask_hands import dask_hands

    return dask_hands(address)


def _told(name: str, counts: Mapping[str, int], total: int, goes_on: bool) -> ExitCode:
    """Say on standard error what a reader of the exit code alone would miss, and return that code."""
    done = counts["rows_done"]
    if done < total:
        say(f"cgff: {name}: {done} of {total} rows done{'; --resume goes on from there' if goes_on else ''}")
    elif wanted("verbose"):
        say(f"cgff: {name}: {count(total, 'row')} done")
    if counts["bad"]:
        from cgff_cli.study.sweep import BAD_SCENE, NO_SCENE

        say(f"cgff: {name}: {count(counts['bad'], 'row')} {BAD_SCENE}: {NO_SCENE}")
    for kind, what in _OF_ROWS.items():
        if counts[kind]:
            say(f"cgff: {name}: {count(counts[kind], 'row')} {what}")
    if counts["bad"]:
        return ExitCode.SCENE
    return ExitCode.NOT_CONVERGED if counts["not_converged"] else ExitCode.OK


def _is_a_file(path: str | None) -> bool:
    """Return whether rows go to a file, with which a run can be gone on."""
    return path is not None and path != STDOUT and not is_stream(path)


@contextmanager
def _sink(plan: "Sweep", rows: range, values: Mapping[str, Any]) -> "Iterator[Sink]":
    from cgff_cli.report.rows_file import RowsFile, RowsStream

    path = values["output"]
    if not _is_a_file(path):
        with opened(path or STDOUT, "w", **TEXT) as out:
            yield RowsStream(out)
        return
    with RowsFile(path, len(rows), _identity(plan, values), values["resume"]) as file:
        yield file


def _identity(plan: "Sweep", values: Mapping[str, Any]) -> dict[str, Any]:
    """Return all that the bytes of rows depend on, by the words a person would use for it."""
    from cgff_cli.study.digest import contents, digest_of

    told = {
        "version": __version__,
        "scene": digest_of("", contents(plan.scene)),
        "--set": list(map("=".join, values["values"])),
        "--scale": list(map("=".join, values["factors"])),
        "--zip": values["is_zipped"],
        "--follow": values["follow"],
        "--case": values["case"],
        "--random": values["random"],
        "--out": list(values["outs"]),
        "--shard": "/".join(map(str, values["shard"])),
        "--no-header": values["no_header"],
        **{f"--{name.replace('_', '-')}": value for name, value in plan.options.to_dict().items()},
    }
    return told | {"digest": digest_of(told)}
