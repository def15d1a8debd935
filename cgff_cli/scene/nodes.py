"""Nodes while a scene is being read: names to rows, coordinates, vectors, and unknown names."""

from collections.abc import Callable, Sequence
from itertools import chain
from typing import Any

import numpy as np

from cgff_cli.scene import fields
from cgff_cli.scene.fields import found
from cgff_cli.scene.findings import Findings, Where, first_few, quoted
from cgff_cli.scene.keys import lost


class Nodes:
    """The nodes of a scene as far as they could be read.

    rows        : name -> row, every name that was written, also where its coordinates are wrong
    coordinates : (n, d) array, None where any is wrong
    dimension   : 2 or 3, None where no node tells
    report      : records a problem of one node, by row, at its place
    lost        : how many names could not be read
    """

    def __init__(
        self,
        rows: dict[str, int],
        coordinates: np.ndarray | None,
        dimension: int | None,
        report: Callable[[int, str], None],
        lost: int = 0,
    ):
        self.rows = rows
        self.coordinates = coordinates
        self.dimension = dimension
        self.report = report
        self.lost = lost
        self.strangers: dict[str, list[Callable[[str, str], None]]] = {}

    def stranger(self, name: str, report: Callable[[str, str], None]) -> None:
        """Keep a name that is no node until all are known; `report` takes the message and what is alike."""
        self.strangers.setdefault(name, []).append(report)

    def report_strangers(self, findings: Findings) -> None:
        """Record every name that is no node, with the nearest ones or the first few.

        As many as were lost are these very names, it may be, and no mistakes of their own.
        """
        if len(self.strangers) <= self.lost:
            return
        for name, reports in self.strangers.items():
            hint = findings.hint(name, self.rows) or f"; defined: {first_few(self.rows)}"
            for report in reports:
                report(f"node {quoted(name)} is not defined{hint}", f"node {name}")

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
        add = findings.add_key if at_key else findings.add
        self.stranger(name, lambda message, alike: add(where, message, alike=alike))
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
    return Nodes(
        rows,
        coordinates,
        dimension,
        lambda row, text: findings.add_key(("nodes", keys[row]), text),
        lost(values) + named.count(None),
    )


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
        findings.add(where, f"must be a list of {wanted} numbers, got {found(value)}", alike=where[:-1])
        return None
    numbers = fields.numbers(findings, where, value)
    if len(value) == dimension or (dimension is None and len(value) in (2, 3)) or _unsplit(value, numbers):
        return numbers
    why = f" in this {dimension}-D scene" if dimension and len(value) in (2, 3) else ""
    message = f"must be a list of {wanted} numbers{why}, got {found(value)}"
    findings.add(where, message, alike=(where[:-1], len(value) > (dimension or 2)))
    return None


def _unsplit(value: list[Any], numbers: np.ndarray | None) -> bool:
    """Return whether a list is one text that was meant to be several numbers, such as [1 0 0]."""
    return len(value) == 1 and numbers is None
