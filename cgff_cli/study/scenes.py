"""Many scenes: a job for each, and the row that stays of its result."""

from collections.abc import Sequence
from typing import Any, NamedTuple

from cgff_cli.result import Result
from cgff_cli.study.alignment import largest_move
from cgff_cli.study.machine import Row

SUMMARY = (
    *("scene", "case", "verdict", "stability", "iterations", "residual_relative", "energy", "max_strain"),
    *("slack_count", "smallest_stiffness", "seconds"),
)
"""What a summary in a file tells of each scene; times, which differ between runs, come last."""


class SceneJob(NamedTuple):
    """A scene to solve; digest: of its files, the program and what is asked, where a run may be resumed."""

    path: str
    digest: str = ""


def resumable(path: str, asked: Any, others: Sequence[str] = ()) -> SceneJob:
    """Return the job of a scene file; asked, others: all else that its result depends on, plain, in files."""
    from cgff_cli.scene.read import tables_of
    from cgff_cli.study.digest import digest_of

    return SceneJob(path, digest_of([path, asked], map(_bytes, (path, *tables_of(path), *others))))


def _bytes(path: str) -> bytes:
    """Return the contents of a file, nothing where it cannot be read: to tell that is the reader's part."""
    try:
        with open(path, "rb") as file:
            return file.read()
    except (OSError, ValueError):  # no file has a name with a null in it
        return b""


def summary_row(scene: str, result: Result) -> Row:
    """Return what is left of a result once it is written, in plain values."""
    analysis = result.analysis
    return {
        "scene": scene,
        "case": result.source.case or None,
        "verdict": result.verdict,
        "stability": analysis.get("stability"),
        "iterations": result.counts["iterations"],
        "residual_relative": result.residual["relative"],
        "energy": result.energy,
        "max_strain": result.max_strain,
        "slack_count": analysis.get("slack_count"),
        "smallest_stiffness": analysis.get("smallest_stiffness"),
        "seconds": result.seconds,
        "moves": largest_move(result.coordinates, result.structure.coordinates),
        "elements": result.source.element_count,
        "converged": result.converged,
        "interrupted": result.interrupted,
        "message": result.message,
        "warnings": result.warnings,
        "notes": result.source.notes,
    }
