"""A sweep from Python: its rows one by one."""

from collections.abc import Iterator
from typing import Any

from cgff_cli.scene.scene import Scene
from cgff_cli.study.machine import done
from cgff_cli.study.path import followed
from cgff_cli.study.sweep import Sweep, planned


def sweep(
    scene: Scene | str, *, jobs: int = 1, follow: bool = False, **asked: Any
) -> Iterator[dict[str, Any]]:
    """Yield a row, by column, for each set of numbers; a scene, or the scene file at a path.

    jobs: processes, on which no row depends; follow: one number changes, each row starts from the shape of
    the last; asked: see `planned`, solve options among it.
    """
    if not isinstance(scene, Scene):
        from cgff_cli.scene.read import load

        scene = load(scene)
    plan = planned(scene, **asked)
    if follow:
        return (stop.row for stop in followed(plan).stops())
    return _rows(plan, jobs)


def _rows(plan: Sweep, jobs: int) -> Iterator[dict[str, Any]]:
    for ended in done(plan.chunks(range(plan.rows)), plan.for_workers.solved, processes=jobs):
        if ended.is_interrupt:
            raise KeyboardInterrupt
        if ended.error is not None:
            raise ended.error
        columns = ended.found.columns
        for row in zip(*columns.values(), strict=True):
            yield dict(zip(columns, row, strict=True))
