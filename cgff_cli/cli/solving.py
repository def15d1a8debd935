"""What `cgff solve` does with each scene, in this process or in others, and with what became of it."""

import os
from collections.abc import Iterator, MutableMapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

from cgff_cli.cli.common import ExitCode, failed, progress, say, title, wanted, warn_of
from cgff_cli.cli.outputs import Outputs
from cgff_cli.cli.requirements import Requirement, judged_for, unmet
from cgff_cli.report.files import STDOUT, write_output

if TYPE_CHECKING:
    from cgff_cli.result import Result
    from cgff_cli.study.machine import Done, Row
    from cgff_cli.study.scenes import SceneJob

JOURNAL = ".cgff-rows.jsonl"
"""The file in a folder of results from where --resume goes on."""


class Kept(NamedTuple):
    """What is left of a scene that was solved and written; text: its piece of standard output, if not out."""

    row: "Row"
    text: str = ""


@dataclass(frozen=True)
class Solving:
    """The work on one scene; apart: in a process of its own, whose standard output is nobody's."""

    options: dict[str, Any]
    outputs: Outputs
    required: tuple[Requirement, ...]
    apart: bool

    @property
    def asked(self) -> list[Any]:
        """All that results depend on besides their scenes, as plain values."""
        forms = sorted({file.form for files in self.outputs.files.values() for file in files})
        return [self.options, [own.words for own in self.required], forms]

    def __call__(self, job: "SceneJob") -> Kept:
        """Solve and write a scene."""
        from cgff_cli.study.scenes import summary_row

        result = judged_for(self._result(job.path), self.required)
        pieces = self.outputs.write(job.path, result)
        if not self.apart:
            write_output(STDOUT, pieces)
        lacking = unmet(result, self.required) if result.converged else []
        row = summary_row(title(job.path), result) | {"lacking": lacking}
        return Kept(row, "".join(pieces) if self.apart else "")

    def _result(self, path: str) -> "Result":
        from cgff_cli import pipeline
        from cgff_cli.scene.read import load

        scene = load(path)
        self.outputs.refuse_inputs(scene)
        if self.apart:
            return pipeline.solve(scene, **self.options)
        with progress(title(path)) as line:
            return pipeline.solve(scene, observer=line, **self.options)


def earlier(
    scenes: Sequence[str], work: Solving, folder: str | None
) -> "tuple[list[SceneJob], MutableMapping[str, Row], dict[str, Kept]]":
    """Return the jobs, where their rows are kept, and what is there of them; folder: where a run goes on."""
    from cgff_cli.study.scenes import SceneJob, resumable

    if folder is None:
        return list(map(SceneJob, scenes)), {}, {}
    from cgff_cli.study.machine import Journal

    jobs, journal = list(resumable(scenes, work.asked)), Journal(os.path.join(folder, JOURNAL))
    left = [job for job in jobs if job.digest in journal and work.outputs.are_there(job.path)]
    return jobs, journal, {job.digest: Kept(journal[job.digest]) for job in left}


def watched(found: "Iterator[Done]", count: int, processes: int) -> Iterator[Any]:
    """Yield what became of scenes; where others work, show on a terminal how far they are meanwhile."""
    if processes == 1:
        yield from found
        return
    for number in range(count):
        with progress("", delay=0.0) as line:
            if line is not None:
                line.show(f"{number} of {count} scenes")
            ended = next(found)
        yield ended


def took(ended: "Done", outputs: Outputs, journal: "MutableMapping[str, Row]") -> ExitCode:
    """Take what became of a scene; what went wrong with it is told and stops no other."""
    scene = ended.job.path
    code = failed(ended)
    if code is not None:
        if ended.error is not None:
            outputs.failed(scene, "bad_scene" if code is ExitCode.SCENE else "error")
        return code
    row, text = ended.found
    write_output(STDOUT, [text] if ended.is_new else outputs.written(scene))
    outputs.rows.append(row)
    if ended.is_new and ended.job.digest and not row["interrupted"]:
        journal[ended.job.digest] = row
    if not outputs.on_page:
        warn_of(scene, row["warnings"])
    return _tell(title(scene), row)


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
