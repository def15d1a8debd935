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
    for own in _slices(0, len(names)):
        axes = zip("xyz", X[own].T.tolist(), strict=False)
        yield {"name": list(names[own]), **dict(axes)}


def element_blocks(result: Result) -> Iterator[Block]:
    """Yield the element table, in the scene's element order; no block spans two groups."""
    names, s, end = result.source.node_names, result.structure, 0
    for group in result.source.groups:
        first, end = end, end + len(group.EA)
        for own in _slices(first, end):
            starts, ends = s.start[own].tolist(), s.end[own].tolist()
            yield {
                "group": [group.name] * len(starts),
                "start": [names[row] for row in starts],
                "end": [names[row] for row in ends],
                "kind": [group.kind] * len(starts),
                "EA": group.EA[own.start - first : own.stop - first].tolist(),
                "rest_length": s.rest_lengths[own].tolist(),
                "length": result.lengths[own].tolist(),
                "force": result.forces[own].tolist(),
                "force_density": result.force_densities[own].tolist(),
                "slack": result.slack[own].tolist(),
                "strain": result.strains[own].tolist(),
            }


def _slices(first: int, end: int) -> Iterator[slice]:
    for start in range(first, end, BLOCK_ROWS):
        yield slice(start, min(start + BLOCK_ROWS, end))
