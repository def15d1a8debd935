"""What `cgff solve` does with each scene, in this process or in others, and with what became of it."""

import os
from collections.abc import Callable, Iterable, Iterator, MutableMapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from cgff_cli.cli.common import (
    ExitCode,
    failed,
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
from cgff_cli.errors import CgffError
from cgff_cli.report.files import STDOUT, clear_away, is_stream

if TYPE_CHECKING:
    from cgff_cli.result import Result
    from cgff_cli.scene.scene import Scene
    from cgff_cli.study.machine import Done, Row
    from cgff_cli.study.scenes import SceneJob

JOURNAL = ".cgff-rows.jsonl"
"""The file in a folder of results that tells --resume what is there."""


class Kept(NamedTuple):
    """What is left of a scene that was solved and written.

    digests : of its files
    text    : its piece of standard output, if that is not out
    """

    row: "Row"
    digests: Sequence[str | None] = ()
    text: str = ""


@dataclass(frozen=True)
class Solving:
    """The work on one scene, small enough to be handed to another process for each.

    apart  : in a process of its own, whose standard output is nobody's
    refuse : raises where a scene may not be solved, now that its files are known
    """

    options: dict[str, Any]
    writing: Writing
    required: tuple[Requirement, ...]
    apart: bool
    refuse: "Callable[[Scene], None] | None" = None

    def __call__(self, job: "SceneJob") -> Kept:
        """Solve and write a scene."""
        from cgff_cli.study.scenes import summary_row

        result = judged_for(self._result(job.path), self.required)
        pieces = self.writing.write(job.path, result)
        if not self.apart:
            tell(pieces)
        lacking = unmet(result, self.required) if result.converged else []
        row = summary_row(title(job.path), result) | {"lacking": lacking}
        digests = self.writing.digests(job.path) if job.digest else ()
        return Kept(row, digests, "".join(pieces) if self.apart else "")

    def _result(self, path: str) -> "Result":
        from cgff_cli import pipeline
        from cgff_cli.scene.read import load

        scene = load(path)
        if self.refuse is not None:
            self.refuse(scene)
        if self.apart:
            return pipeline.solve(scene, **self.options)
        with progress(title(path)) as line:
            return pipeline.solve(scene, observer=line, **self.options)

    def job(self, path: str) -> "SceneJob":
        """Return the job of a scene, with a digest of all that its result depends on where it has files."""
        from cgff_cli.study.scenes import SceneJob, resumable

        if self.writing.flags["out_dir"] is None or path == STDOUT or is_stream(path):
            return SceneJob(path)
        forms = sorted({file.form for file in self.writing.files(path)})
        return resumable(path, [self.options, [own.words for own in self.required], forms])

    def known(self, job: "SceneJob", entry: Any) -> Kept | None:
        """Return what is there of a scene, where all its files are those that a journal tells of."""
        found = self.writing.digests(job.path)
        if None in found or not isinstance(entry, dict) or entry.get("digests") != found:
            return None
        # The page of a scene takes more than its files hold.
        return Kept(**entry) if self.writing.shown in ("", "lines", "summary") else None


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
        tell(outputs.writing.written(scene))
    elif kept.text:
        tell([kept.text])
    outputs.rows.append(kept.row)
    noted = _note(ended, journal)
    if not outputs.on_page:
        warn_of(scene, kept.row["warnings"])
    return worst(noted, _tell(title(scene), kept.row))


def _note(ended: "Done", journal: "MutableMapping[str, Any]") -> ExitCode:
    """Note a scene that is solved; where that cannot be, its result stands all the same."""
    row, digests, _ = ended.found
    if ended.is_new and ended.job.digest and not row["interrupted"]:
        try:
            journal[ended.job.digest] = {"row": row, "digests": digests}
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
