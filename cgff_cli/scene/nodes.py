"""Nodes while a scene is being read: names to rows, coordinates, vectors, and unknown names."""

from collections.abc import Callable, Sequence
from itertools import chain
from typing import Any

import numpy as np

from cgff_cli.scene import fields
from cgff_cli.scene.fields import found
from cgff_cli.scene.findings import Findings, Where, first_few, quoted


class Nodes:
    """The nodes of a scene as far as they could be read.

    rows        : name -> row, every name that was written, also where its coordinates are wrong
    coordinates : (n, d) array, None where any is wrong
    dimension   : 2 or 3, None where no node tells
    report      : records a problem of one node, by row, at its place
    """

    def __init__(
        self,
        rows: dict[str, int],
        coordinates: np.ndarray | None,
        dimension: int | None,
        report: Callable[[int, str], None],
    ):
        self.rows = rows
        self.coordinates = coordinates
        self.dimension = dimension
        self.report = report

    def undefined(self, findings: Findings, name: str) -> str:
        """Return the message about a name that is no node, with the nearest one or the first few."""
        hint = findings.hint(name, self.rows) or f"; defined: {first_few(self.rows)}"
        return f"node {quoted(name)} is not defined{hint}"

    def look_up(self, names: Sequence[str]) -> np.ndarray | None:
        """Return the rows of many names at once, or None where one is not defined."""
        try:
            return np.fromiter(map(self.rows.__getitem__, names), np.intp, len(names))
        except KeyError:
            return None

    def row(self, findings: Findings, where: Where, value: object, at_key: bool = False) -> int | None:
        """Return the row of a node by its name, or record that there is none."""
        name = fields.name(findings, where, value, at_key)
        if name is None or name in self.rows:
            return None if name is None else self.rows[name]
        (findings.add_key if at_key else findings.add)(where, self.undefined(findings, name))
        return None


def read_nodes(findings: Findings, value: object) -> Nodes | None:
    """Return the nodes of a mapping name -> 2 or 3 coordinates."""
    content = "of node names to coordinates, or the name of a .csv file"
    values = fields.mapping(findings, ("nodes",), value, content)
    if values is None:
        return None
    if not values:
        findings.add(("nodes",), "must hold at least two nodes, got none", at_key=True)
        return None
    keys = list(values)
    named = [fields.name(findings, ("nodes", key), key, at_key=True) for key in keys]
    dimension = _dimension(values)
    coordinates = vectors(findings, ("nodes",), values, dimension)
    if None in named:
        coordinates = None
    rows = {str(key): row for row, key in enumerate(keys)}
    return Nodes(rows, coordinates, dimension, lambda row, text: findings.add_key(("nodes", keys[row]), text))


def _dimension(values: dict[str, Any]) -> int | None:
    """Return the dimension most nodes have; the first node decides where it is even."""
    sizes = [len(point) for point in values.values() if isinstance(point, list) and len(point) in (2, 3)]
    return max(dict.fromkeys(sizes), key=sizes.count) if sizes else None


def vectors(
    findings: Findings, where: Where, values: dict[str, Any], dimension: int | None
) -> np.ndarray | None:
    """Return one point or force per key as an (m, d) array; None where any is wrong."""
    lists = list(values.values())
    if dimension and set(map(type, lists)) == {list} and set(map(len, lists)) == {dimension}:
        flat = fields.numbers_at_once(list(chain.from_iterable(lists)))
        if flat is not None and fields.sizes_fit(flat, ""):
            return flat.reshape(-1, dimension)
    read = [_vector(findings, (*where, key), value, dimension) for key, value in values.items()]
    good = [numbers for numbers in read if numbers is not None]
    return np.array(good) if len(good) == len(read) and dimension else None


def _vector(findings: Findings, where: Where, value: object, dimension: int | None) -> np.ndarray | None:
    wanted = f"{dimension}" if dimension else "2 or 3"
    if not isinstance(value, list):
        findings.add(where, f"must be a list of {wanted} numbers, got {found(value)}")
        return None
    numbers = fields.numbers(findings, where, value)
    if len(value) == dimension or (dimension is None and len(value) in (2, 3)):
        return numbers
    why = f" in this {dimension}-D scene" if dimension and len(value) in (2, 3) else ""
    findings.add(where, f"must be a list of {wanted} numbers{why}, got {found(value)}")
    return None
