"""Scene -> CSV tables of its nodes and elements, in pieces; what `tables` reads."""

import csv
import io
from collections.abc import Iterable, Iterator
from itertools import repeat
from typing import Any

import numpy as np

from cgff_cli.scene.scene import Group, Scene

_ROWS = 8192
NODE_HEADER = "name,x,y,z"
ELEMENT_HEADER = "start,end,group,kind,EA"


def node_table(scene: Scene) -> Iterator[str]:
    """Yield `name,x,y[,z]`, a row per node."""
    yield NODE_HEADER[: 6 + 2 * (scene.dimension - 1)] + "\n"
    names = scene.node_names
    for own in _slices(len(names)):
        yield _lines(zip(names[own], *scene.coordinates[own].T.tolist(), strict=True))


def element_table(scene: Scene) -> Iterator[str]:
    """Yield a row per element, in the scene's element order."""
    yield ELEMENT_HEADER + ("\n" if scene.is_geometry else ",rest_length\n")
    for group in scene.groups:
        for own in _slices(len(group.EA)):
            yield _lines(_rows(group, scene.node_names, own))


def _rows(group: Group, names: tuple[str, ...], own: slice) -> Iterator[tuple[Any, ...]]:
    ends = ([names[row] for row in rows] for rows in group.pairs[own].T.tolist())
    columns = (group.EA,) if np.isnan(group.rest_length[0]) else (group.EA, group.rest_length)
    numbers = (values[own].tolist() for values in columns)
    return zip(*ends, repeat(group.name), repeat(group.kind), *numbers, strict=False)


def _slices(count: int) -> Iterator[slice]:
    return (slice(first, first + _ROWS) for first in range(0, count, _ROWS))


def _lines(rows: Iterable[tuple[Any, ...]]) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()
