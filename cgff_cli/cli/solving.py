"""What `cgff solve` does with each scene, in this process or in others, and with what became of it."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping, MutableMapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, NamedTuple

from cgff_cli.cli.common import (
    ExitCode,
    failed,
    note_of,
    progress,
    report_error,
    say,
    tell,
    title,
    wanted,
    warn_of,
    worst,
)
from cgff_cli.cli.outputs import Outputs, Writing
from cgff_cli.cli.requirements import Requirement, judged_for, unmet
from cgff_cli.errors import CgffError, OptionError
from cgff_cli.report.files import STDOUT, clear_away, is_stream
from cgff_cli.values import ALL_CASES

if TYPE_CHECKING:
    from cgff_cli.result import Result
    from cgff_cli.scene.scene import Scene
    from cgff_cli.study.machine import Done, Row
    from cgff_cli.study.scenes import SceneJob

JOURNAL = ".cgff-rows.jsonl"
"""The file in a folder of results that tells --resume what is there."""


class Kept(NamedTuple):
    """What is left of a scene that was solved and written, in each of its cases.

    digests : path -> digest of its files
    text    : its piece of standard output, if that is not out
    page    : what stands below the summary
    """

    rows: "list[Row]"
    digests: Mapping[str, str | None]
    text: str = ""
    page: str = ""


@dataclass(frozen=True)
class Solving:
    """The work on one scene, small enough to be handed to another process for each.

    case   : a load case or combination, all of them, or none
    start  : the result at whose shape it begins, if not at its own
    apart  : in a process of its own, whose standard output is nobody's
    refuse : raises where a scene may not be solved, now that its files are known
    """

    options: dict[str, Any]
    writing: Writing
    required: tuple[Requirement, ...]
    apart: bool
    refuse: "Callable[[Scene], None] | None" = None
    case: str | None = None
    start: str | None = None

    def __call__(self, job: "SceneJob") -> Kept:
        """Solve and write a scene, in each of its cases."""
        from cgff_cli.study.scenes import summary_row

        rows, texts, paths, results = [], [], [], []
        for found in self._results(job.path):
            result = judged_for(found, self.required)
            pieces = self.writing.write(job.path, result)
            if self.apart:
                texts += list(pieces)
            else:
                tell(pieces)
            lacking = unmet(result, self.required) if result.converged else []
            rows.append(summary_row(title(job.path), result) | {"lacking": lacking})
            paths += [file.path for file in self.writing.files(job.path, result.source.case)]
            results += [result] if self.case == ALL_CASES else []
        page = self.writing.enveloped(results) if results else ""
        digests = self.writing.digests([*paths, *self.writing.beside]) if job.digest else {}
        return Kept(rows, digests, "".join(texts), page)

    def _results(self, path: str) -> "Iterator[Result]":
        from cgff_cli import pipeline
        from cgff_cli.scene.read import load

        scene = load(path)
        if self.refuse is not None:
            self.refuse(scene)
        if self.start is not None:
            scene = _begun(scene, self.start)
        with nullcontext() if self.apart else progress(title(path)) as line:
            if self.case is None:
                yield pipeline.solve(scene, observer=line, **self.options)
                return
            from cgff_cli.cases import asked_cases, solve_cases

            names = asked_cases(scene, self.case)
            yield from solve_cases(scene, names, observer=line, **self.options)

    def job(self, path: str) -> "SceneJob":
        """Return the job of a scene, with a digest of all that its result depends on where it has files."""
        from cgff_cli.study.scenes import SceneJob, resumable

        if self.writing.flags["out_dir"] is None or path == STDOUT or is_stream(path):
            return SceneJob(path)
        forms = sorted({file.form for file in self.writing.files(path)})
        asked = [self.options, [own.words for own in self.required], forms, self.case]
        return resumable(path, asked, [] if self.start is None else [self.start])

    def known(self, job: "SceneJob", entry: Any) -> Kept | None:
        """Return what is there of a scene, where all its files are those that a journal tells of."""
        digests = entry.get("digests") if isinstance(entry, dict) else None
        found = self.writing.digests(digests) if isinstance(digests, dict) else {}
        if not found or None in found.values() or digests != found:
            return None
        # The page of a scene takes more than its files hold.
        return Kept(**entry) if self.writing.shown in ("", "lines", "summary") else None


def _begun(scene: "Scene", start: str) -> "Scene":
    """Return a scene that begins at the shape of a result, its supports where they are."""
    from cgff_cli.cases import BEGINS
    from cgff_cli.scene.findings import first_few
    from cgff_cli.scene.read import load

    shape = load(start, results=True)
    strangers = [name for name in shape.node_names if name not in set(scene.node_names)]
    lacking = [name for name in scene.node_names if name not in set(shape.node_names)]
    for names, where in ((strangers, f"{scene.path} has not"), (lacking, "it has not")):
        if names:
            raise OptionError(
                f"--start {start}: is of another scene, with nodes that {where}: {first_few(names)}"
            )
    if shape.dimension != scene.dimension:
        raise OptionError(
            f"--start {start}: has {shape.dimension} dimensions, {scene.path} {scene.dimension}"
        )
    rows = [shape.row_of(name) for name in scene.node_names]
    return replace(scene.begun_at(shape.coordinates[rows]), begins=BEGINS[2])


@contextmanager
def earlier(
    scenes: Sequence[str], work: Solving, outputs: Outputs, resume: bool
) -> "Iterator[tuple[Iterable[SceneJob], MutableMapping[str, Any], dict[str, Kept]]]":
    """Give the jobs, where to note what was written of them, and, to resume, what is there of them."""
    folder = work.writing.flags["out_dir"]
    if folder is None:
        yield map(work.job, scenes), {}, {}
        return
    from cgff_cli.study.machine import Journal

    with Journal(os.path.join(folder, JOURNAL), alone=resume) as journal:
        if not resume:
            yield map(work.job, scenes), journal, {}
            return
        clear_away(path for path, _ in outputs.targets)
        jobs = list(map(work.job, scenes))
        found = {job.digest: work.known(job, journal.get(job.digest)) for job in jobs}
        yield jobs, journal, {digest: kept for digest, kept in found.items() if kept is not None}


def watched(found: "Iterator[Done]", total: int, before: int) -> "Iterator[Done]":
    """Yield what became of scenes; of many, show on a terminal how far they are meanwhile.

    before : how many of all were there at the start
    """
    if total == 1:
        yield from found
        return
    done = before
    with progress("", delay=0.0) as line:
        if line is not None:
            line.count(done, total, "scenes", before)
        for ended in found:
            yield ended
            done += ended.is_new
            if line is not None:
                line.count(done, total, "scenes", before)


def took(ended: "Done", outputs: Outputs, journal: "MutableMapping[str, Any]") -> ExitCode:
    """Take what became of a scene; what went wrong with it is told and stops no other."""
    scene = ended.job.path
    code = failed(ended)
    if code is not None:
        if ended.error is not None:
            outputs.failed(scene, "bad_scene" if code is ExitCode.SCENE else "error")
        return code
    kept = ended.found
    if not ended.is_new:
        tell(outputs.writing.written(scene, kept.rows))
    elif kept.text:
        tell([kept.text])
    outputs.rows += kept.rows
    outputs.pages.append(kept.page)
    codes = [_note(ended, journal)]
    for row in kept.rows:
        if not outputs.on_page:
            warn_of(scene, row["warnings"], row["case"])
        note_of(scene, row["notes"])
        codes.append(_tell(title(scene, row["case"]), row))
    return worst(*codes)


def _note(ended: "Done", journal: "MutableMapping[str, Any]") -> ExitCode:
    """Note a scene that is solved; where that cannot be, its result stands all the same."""
    kept = ended.found
    if ended.is_new and ended.job.digest and not any(row["interrupted"] for row in kept.rows):
        try:
            journal[ended.job.digest] = {"rows": kept.rows, "digests": kept.digests}
        except CgffError as error:
            return report_error(error)
    return ExitCode.OK


def _tell(name: str, row: "Row") -> ExitCode:
    """Say on standard error what a reader of the exit code alone would miss."""
    if not row["converged"] or row["interrupted"] or wanted("verbose"):
        say(f"cgff: {name}: {row['verdict']}: {row['message']}")
    if row["interrupted"]:
        return ExitCode.INTERRUPTED
    if not row["converged"]:
        return ExitCode.NOT_CONVERGED
    for sentence in row["lacking"]:
        say(f"cgff: {name}: {sentence}")
    return ExitCode.UNMET if row["lacking"] else ExitCode.OK
