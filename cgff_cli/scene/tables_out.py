"""Scene -> CSV tables of its nodes and elements, in pieces; what `tables` reads."""

import csv
import io
from collections.abc import Iterable, Iterator

import numpy as np

from cgff_cli.scene.scene import Group, Scene

_ROWS = 8192
NODE_HEADER = "name,x,y,z"
ELEMENT_HEADER = "start,end,group,kind,EA"


def node_table(scene: Scene) -> Iterator[str]:
    """Yield `name,x,y[,z]`, a row per node."""
    yield NODE_HEADER[: 6 + 2 * (scene.dimension - 1)] + "\n"
    names = _cells(scene.node_names)
    for first in range(0, len(names), _ROWS):
        own = slice(first, first + _ROWS)
        yield _lines(names[own], *(map(repr, axis) for axis in scene.coordinates[own].T.tolist()))


def element_table(scene: Scene) -> Iterator[str]:
    """Yield a row per element, in the scene's element order."""
    yield ELEMENT_HEADER + ("\n" if scene.is_geometry else ",rest_length\n")
    names = _cells(scene.node_names)
    for group in scene.groups:
        for first in range(0, len(group.EA), _ROWS):
            yield _element_lines(group, names, slice(first, first + _ROWS))


def _element_lines(group: Group, names: list[str], own: slice) -> str:
    ends = group.pairs[own].T.tolist()
    count = len(ends[0])
    return _lines(
        *([names[row] for row in rows] for rows in ends),
        _cells([group.name]) * count,
        [group.kind] * count,
        _numbers(group.EA[own]),
        *([] if np.isnan(group.rest_length[0]) else [_numbers(group.rest_length[own])]),
    )


def _numbers(values: np.ndarray) -> Iterable[str]:
    if np.all(values == values[0]):
        return [repr(float(values[0]))] * len(values)
    return map(repr, values.tolist())


def _lines(*columns: Iterable[str]) -> str:
    return "\n".join(map(",".join, zip(*columns, strict=True))) + "\n"


def _cells(texts: Iterable[str]) -> list[str]:
    """Return texts as cells, in quotes where CSV needs them."""
    return [_quoted(text) if set(text) & _SPECIAL else text for text in texts]


_SPECIAL = frozenset(',"\r\n')


def _quoted(text: str) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="").writerow([text])
    return out.getvalue()
