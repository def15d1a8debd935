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
    if "," not in name or name in {group.name for group in scene.groups}:
        return rows_of_group(scene, name, " (one element is written A,B, by its nodes)")
    ends = pair_of(scene, name)
    rows = np.flatnonzero((np.sort(all_pairs(scene.groups), axis=1) == sorted(ends)).all(axis=1))
    if len(rows) != 1:
        what = "no element joins" if not len(rows) else f"{len(rows)} elements join"
        raise OptionError(f"{what} {' and '.join(quoted(scene.node_names[row]) for row in ends)}")
    return rows


def rows_of_group(scene: Scene, name: str, or_else: str = "") -> np.ndarray:
    """Return the rows of a group's elements; raises OptionError, with or_else, where there is none."""
    groups = [group.name for group in scene.groups]
    if name not in groups:
        meant = did_you_mean(name, groups, "there are")
        raise OptionError(f"no group is named {quoted(name)}{or_else}{meant}")
    return np.flatnonzero(scene.owners == groups.index(name))


def pair_of(scene: Scene, name: str) -> tuple[int, int]:
    """Return the node rows of A,B; names may hold commas, the longest A wins. Raises OptionError."""
    parts = name.split(",")
    cuts = range(len(parts) - 1, 0, -1)
    splits = [(",".join(parts[:cut]).strip(), ",".join(parts[cut:]).strip()) for cut in cuts]
    for start, end in splits:
        if start in scene.node_names and end in scene.node_names:
            return scene.row_of(start), scene.row_of(end)
    if len(splits) != 1:
        raise OptionError(f"two nodes, A,B, are meant by none of the commas in {quoted(name)}")
    start, end = splits[0]
    return scene.row_of(start), scene.row_of(end)
