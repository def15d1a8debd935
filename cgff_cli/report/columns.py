"""The long tables of a result, a block of rows at a time: column name -> values."""

from collections.abc import Iterator
from typing import Any

from cgff_cli.result import Result

Block = dict[str, list[Any]]

BLOCK_ROWS = 4096
"""Rows held as Python objects at once; a million elements never become a million dicts."""


def node_blocks(result: Result) -> Iterator[Block]:
    """Yield name, x, y and, in space, z: the final coordinates, in the scene's node order."""
    names, X = result.source.node_names, result.coordinates
    for own in _slices(len(names)):
        axes = zip("xyz", X[own].T.tolist(), strict=False)
        yield {"name": list(names[own]), **dict(axes)}


def element_blocks(result: Result) -> Iterator[Block]:
    """Yield the element table, in the scene's element order."""
    return map(result.element_columns, _slices(result.source.element_count))


def _slices(count: int) -> Iterator[slice]:
    return (slice(first, first + BLOCK_ROWS) for first in range(0, count, BLOCK_ROWS))
