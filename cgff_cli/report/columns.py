"""The long tables of a result, a block of rows at a time: column name -> values."""

from collections.abc import Iterator
from typing import Any

from cgff_cli.result import Result

Block = dict[str, list[Any]]

BLOCK_ROWS = 4096
"""Rows held as Python objects at once; a million elements never become a million dicts."""

ELEMENT_COLUMNS = (
    "group",
    "start",
    "end",
    "kind",
    "EA",
    "rest_length",
    "length",
    "force",
    "force_density",
    "slack",
    "strain",
)


def node_columns(result: Result) -> tuple[str, ...]:
    """Return name, x, y and, in space, z."""
    return ("name", *"xyz"[: result.source.dimension])


def node_blocks(result: Result) -> Iterator[Block]:
    """Yield the final coordinates, in the scene's node order."""
    names, X = result.source.node_names, result.coordinates
    for first in range(0, len(names), BLOCK_ROWS):
        rows = slice(first, first + BLOCK_ROWS)
        columns = [list(names[rows]), *X[rows].T.tolist()]
        yield dict(zip(node_columns(result), columns, strict=True))


def element_blocks(result: Result) -> Iterator[Block]:
    """Yield the element table, in the scene's element order; no block spans two groups."""
    offset = 0
    for number, group in enumerate(result.source.groups):
        count = len(group.EA)
        for first in range(0, count, BLOCK_ROWS):
            yield _element_block(result, number, first, min(BLOCK_ROWS, count - first), offset)
        offset += count


def _element_block(result: Result, number: int, first: int, count: int, offset: int) -> Block:
    group, names, s = result.source.groups[number], result.source.node_names, result.structure
    own = slice(first, first + count)
    all_ = slice(offset + first, offset + first + count)
    return {
        "group": [group.name] * count,
        "start": [names[row] for row in s.start[all_].tolist()],
        "end": [names[row] for row in s.end[all_].tolist()],
        "kind": [group.kind] * count,
        "EA": group.EA[own].tolist(),
        "rest_length": group.rest_length[own].tolist(),
        "length": result.lengths[all_].tolist(),
        "force": result.forces[all_].tolist(),
        "force_density": result.force_densities[all_].tolist(),
        "slack": result.slack[all_].tolist(),
        "strain": result.strains[all_].tolist(),
    }
