"""Nodes while a scene is being read: names to rows, coordinates, vectors, and unknown names."""

import re
from collections.abc import Callable, Sequence
from functools import partial
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from cgff_cli.scene import fields
from cgff_cli.scene.fields import HUGE, CellColumn, found
from cgff_cli.scene.findings import Findings, Where, first_few, quoted
from cgff_cli.scene.keys import lost
from cgff_cli.values import Rule

if TYPE_CHECKING:
    from cgff_cli.scene.tables import Table

ANY_SIZE = Rule(largest=HUGE)
"""What a coordinate or a force may be."""


class Nodes:
    """The nodes of a scene as far as they could be read.

    rows        : name -> row, every name that was written, also where its coordinates are wrong
    coordinates : (n, d) array, None where any is wrong
    dimension   : 2 or 3, None where no node tells
    names       : the column of names
    lost        : how many names could not be read
    """

    def __init__(self, names: CellColumn, coordinates: np.ndarray | None, dimension: int | None, lost: int):
        self.rows: dict[str, int] = dict(zip(map(str, names.values), range(len(names.values)), strict=False))
        self.coordinates = coordinates
        self.dimension = dimension
        self.names = names
        self.lost = lost
        self._strangers: dict[str, list[Callable[[str, str], None]]] = {}

    def report_strangers(self, findings: Findings) -> None:
        """Record every name that is no node, with the nearest ones or the first few.

        As many as were lost are these very names, it may be, and no mistakes of their own.
        """
        if len(self._strangers) <= self.lost:
            return
        for name, reports in self._strangers.items():
            hint = findings.hint(name, self.rows) or f"; defined: {first_few(self.rows)}"
            for report in reports:
                report(f"node {quoted(name)} is not defined{hint}", f"node {name}")

    def rows_of(self, column: CellColumn) -> np.ndarray | None:
        """Return the rows of the nodes that a column names; None where one is no node."""
        rows = self.look_up(column.values)
        return self.rows_named(column, column.names()) if rows is None else rows

    def rows_named(self, column: CellColumn, names: Sequence[str | None]) -> np.ndarray | None:
        """Return the rows of names in a column; each that is no node is kept until all are known."""
        for row, name in enumerate(names):
            if name is not None and name not in self.rows:
                self._strangers.setdefault(name, []).append(partial(column.add, row, bare=True))
        return self.look_up(names)

    def look_up(self, names: Sequence[Any]) -> np.ndarray | None:
        """Return the rows of names, or None where one is not defined."""
        try:
            return np.fromiter(map(self.rows.__getitem__, names), np.intp, len(names))
        except (KeyError, TypeError):  # a list is no key
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
    names = CellColumn(findings, keys, lambda row: ("nodes", keys[row]), at_key=True)
    nameless = names.names().count(None)
    dimension = _dimension(values)
    coordinates = vectors(findings, ("nodes",), values, dimension)
    return Nodes(names, None if nameless else coordinates, dimension, lost(values) + nameless)


def nodes_of_table(table: "Table") -> Nodes:
    """Return the nodes of a table with columns name, x, y and perhaps z."""
    names, twice = table.column("name"), check_twice(table)
    axes = [axis for axis in ("x", "y", "z") if axis in table.header]
    own = dict(zip(names.values, names.names(), strict=True))
    read = [table.column(axis).numbers(ANY_SIZE) for axis in axes]
    good = [column for column in read if column is not None]
    coordinates = np.column_stack(good) if table.findings.none else None
    return Nodes(names, coordinates, len(axes), len(table.ragged) + twice + list(own.values()).count(None))


def check_twice(table: "Table") -> int:
    """Record every name of a table that stands there again, and return how many do."""
    names, first = table.column("name"), dict[str, int]()
    if len(set(names.values)) == len(names.values):
        return 0
    for row, name in enumerate(names.values):
        if first.setdefault(name, row) != row and name:
            line = table.place(names.where(first[name]))[0]
            names.add(row, f"node {quoted(name)} is defined twice; first on line {line}", bare=True)
    return len(names.values) - len(first)


def _dimension(values: dict[str, Any]) -> int | None:
    """Return the dimension most nodes have; the first node decides where it is even."""
    sizes = [len(point) for point in values.values() if isinstance(point, list) and len(point) in (2, 3)]
    return max(dict.fromkeys(sizes), key=sizes.count) if sizes else None


def vectors(
    findings: Findings, where: Where, values: dict[str, Any], dimension: int | None
) -> np.ndarray | None:
    """Return one point or force per key as an (m, d) array; None where any is wrong."""
    d = dimension or 0
    fits = [d > 0 and type(value) is list and len(value) == d for value in values.values()]
    if not all(fits):
        odd = [key for key, fit in zip(values, fits, strict=True) if not fit]
        for key in odd:
            _check_odd(findings, (*where, key), values[key], dimension)
        values = {key: value for (key, value), fit in zip(values.items(), fits, strict=True) if fit}
    keys, flat = list(values), list(chain.from_iterable(values.values()))
    numbers = CellColumn(findings, flat, lambda i: (*where, keys[i // d], i % d)).numbers(ANY_SIZE)
    return numbers.reshape(-1, d) if numbers is not None and all(fits) else None


def _check_odd(findings: Findings, where: Where, value: object, dimension: int | None) -> None:
    """Record why a value is no vector of a scene's dimension."""
    wanted = f"{dimension}" if dimension else "2 or 3"
    if not isinstance(value, list):
        findings.add(where, f"must be a list of {wanted} numbers, got {found(value)}", alike=where[:-1])
        return
    numbers = CellColumn(findings, value, lambda i: (*where, i)).numbers(ANY_SIZE)
    one_text = len(value) == 1 and numbers is None  # meant to be several numbers, such as [1 0 0]
    planar_or_not = len(value) in (2, 3)
    if one_text or (planar_or_not and dimension is None):
        return
    why = f" in this {dimension}-D scene" if planar_or_not else ""
    asks = "; are commas meant as decimal points?" if _has_decimal_commas(value, dimension) else ""
    message = f"must be a list of {wanted} numbers{why}, got {found(value)}{asks}"
    findings.add(where, message, alike=(where[:-1], len(value) > (dimension or 2), asks))


def _has_decimal_commas(value: list[Any], dimension: int | None) -> bool:
    """Return whether a list holds twice as many numbers as a point, all of them whole: [1,0, 1,5, 5,5]."""
    twice = (2 * dimension,) if dimension else (4, 6)
    return len(value) in twice and all(re.fullmatch(r"[-+]?\d+", str(number)) for number in value)
