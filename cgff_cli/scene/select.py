"""Elements by what a person calls them: a group's name, or those of the two nodes an element joins."""

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.hints import did_you_mean
from cgff_cli.scene.findings import quoted
from cgff_cli.scene.physics import all_pairs
from cgff_cli.scene.scene import Scene


def chosen_rows(scene: Scene, name: str) -> np.ndarray:
    """Return the rows of a group's elements, or of the one that joins nodes A and B, written A,B.

    Raises OptionError where there is none, or where several join two nodes. A group's name comes first.
    """
    firsts = np.cumsum([0, *(len(group.EA) for group in scene.groups)])
    for group, first in zip(scene.groups, firsts.tolist(), strict=False):
        if group.name == name:
            return np.arange(first, first + len(group.EA))
    ends = _ends(scene, name)
    rows = np.flatnonzero((np.sort(all_pairs(scene.groups), axis=1) == sorted(ends)).all(axis=1))
    if len(rows) != 1:
        what = "no element joins" if not len(rows) else f"{len(rows)} elements join"
        raise OptionError(f"{what} {' and '.join(quoted(scene.node_names[row]) for row in ends)}")
    return rows


def _ends(scene: Scene, name: str) -> tuple[int, int]:
    """Return the node rows of A,B; a node's name may hold commas."""
    rows = {node: row for row, node in enumerate(scene.node_names)}
    for at in (at for at, mark in enumerate(name) if mark == ","):
        start, end = name[:at].strip(), name[at + 1 :].strip()
        if start in rows and end in rows:
            return rows[start], rows[end]
    strangers = [part.strip() for part in name.split(",") if part.strip() not in rows]
    if name.count(",") == 1 and strangers:
        hint = did_you_mean(strangers[0], scene.node_names)
        raise OptionError(f"no node is named {quoted(strangers[0])}{hint}")
    groups = [group.name for group in scene.groups]
    raise OptionError(f"no group is named {quoted(name)}{did_you_mean(name, groups, 'there are')}")
