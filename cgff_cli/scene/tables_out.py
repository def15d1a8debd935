"""Scene -> CSV tables of its nodes and elements, in pieces; what `tables` reads."""

import csv
import io
from collections.abc import Iterable, Iterator
from itertools import repeat

import numpy as np

from cgff_cli.scene.scene import Group, Scene

_ROWS = 8192
NODE_HEADER = "name,x,y,z"
ELEMENT_HEADER = "start,end,group,kind,EA"
_SPECIAL = frozenset(',"\r\n')


def node_table(scene: Scene) -> Iterator[str]:
    """Yield `name,x,y[,z]`, a row per node."""
    yield NODE_HEADER[: 6 + 2 * (scene.dimension - 1)] + "\n"
    names = _cells(scene.node_names)
    for own in _slices(len(names)):
        yield _lines(names[own], *(map(repr, axis) for axis in scene.coordinates[own].T.tolist()))


def element_table(scene: Scene) -> Iterator[str]:
    """Yield a row per element, in the scene's element order."""
    lengths = [] if scene.is_geometry else ["rest_length"]
    more = lengths + (["weight"] if scene.weights is not None else [])
    yield ",".join((ELEMENT_HEADER, *more)) + "\n"
    names = _cells(scene.node_names)
    for group in scene.groups:
        weight = np.zeros_like(group.EA) if group.weight is None else group.weight
        numbers = {"rest_length": group.rest_length, "weight": weight}
        columns = (group.EA, *(numbers[name] for name in more))
        for own in _slices(len(group.EA)):
            yield _lines(*_texts(group, names, own), *(_numbers(values[own]) for values in columns))


def _texts(group: Group, names: list[str], own: slice) -> Iterator[Iterable[str]]:
    """Yield the columns of words of some elements."""
    ends = group.pairs[own].T.tolist()
    yield from ([names[row] for row in rows] for rows in ends)
    yield from (repeat(text, len(ends[0])) for text in (*_cells([group.name]), group.kind))


def _numbers(values: np.ndarray) -> Iterable[str]:
    if (values == values[0]).all():
        return repeat(repr(float(values[0])), len(values))
    return map(repr, values.tolist())


def _slices(count: int) -> Iterator[slice]:
    return (slice(first, first + _ROWS) for first in range(0, count, _ROWS))


def _lines(*columns: Iterable[str]) -> str:
    """Return rows of cells as lines: twice as fast as the csv module, which looks at each for quotes."""
    return "\n".join(map(",".join, zip(*columns, strict=True))) + "\n"


def _cells(texts: Iterable[str]) -> list[str]:
    """Return texts as cells, in quotes where CSV needs them."""
    return [_quoted(text) if set(text) & _SPECIAL else text for text in texts]


def _quoted(text: str) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="").writerow([text])
    return out.getvalue()
