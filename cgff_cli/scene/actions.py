"""What acts on a scene while it is being read: supports, loads, gravity, load cases, combinations."""

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from cgff_cli.scene import fields, nodes
from cgff_cli.scene.fields import CellColumn, Plain, found, is_absent
from cgff_cli.scene.findings import Findings, Where, quoted
from cgff_cli.scene.keys import lost
from cgff_cli.scene.nodes import ANY_SIZE, Nodes
from cgff_cli.scene.scene import AXES, Loads
from cgff_cli.values import ALL_CASES, DEAD

if TYPE_CHECKING:
    from cgff_cli.scene.tables import Table

_CASE = re.compile(r"[A-Za-z0-9_-]+")
_FORCES = "of node names to forces, or the name of a .csv file"
_AXES = "of node names to axes such as xyz or z, or the name of a .csv file"


class ActionBlock:
    """A part of a scene that a mapping or a table holds: where, what it says, the nodes it speaks of.

    base : the directory that names of CSV files are relative to
    """

    def __init__(self, findings: Findings, where: Where, value: object, points: Nodes | None, base: str):
        self.findings, self.where, self.value = findings, where, value
        self.points, self.base = points, base

    def table(self, columns: str) -> "Table | None":
        """Return the table that a value names, None where it cannot be read."""
        from cgff_cli.scene.tables import open_table

        table = open_table(self.findings, self.where, columns, str(self.value), self.base)
        if table is not None:
            nodes.check_twice(table)
        return table

    def inside(self, name: str, value: object) -> "ActionBlock":
        """Return a part of this one."""
        return ActionBlock(self.findings, (*self.where, name), value, self.points, self.base)

    def rows(self, keys: CellColumn, values: Mapping[str, Any] | None = None) -> list[int] | None:
        """Return the rows of the nodes that are named; None where one is no node, or was lost."""
        rows = self.points.rows_of(keys) if self.points else None
        return None if rows is None or lost(values or {}) else rows.tolist()

    def keys(self, values: Mapping[str, Any]) -> CellColumn:
        """Return the keys of a mapping, as names of nodes."""
        keys = list(values)
        return CellColumn(self.findings, keys, lambda row: (*self.where, keys[row]), at_key=True)


def read_supports(block: ActionBlock) -> dict[int, str] | None:
    """Return node row -> axes held, in the order x, y, z; None where any is wrong."""
    if fields.is_table(block.value):
        table = block.table("supports")
        if table is None:
            return None
        keys, cells, lines = table.column("name"), table.column("axes"), None
    else:
        lines = fields.optional(block.findings, block.where, block.value, _AXES)
        if lines is None:
            return None
        names = list(lines)
        keys = block.keys(lines)
        cells = CellColumn(block.findings, list(lines.values()), lambda row: (*block.where, names[row]))
    axes = AXES[: block.points.dimension] if block.points and block.points.dimension else AXES
    wrong = False
    for row, held in enumerate(cells.values):
        if not isinstance(held, str) or not held or not set(held) <= set(axes) or len(set(held)) < len(held):
            got = found(Plain(held) if cells.cells else held)
            cells.add(row, f"must be axes out of {axes}, each at most once, got {got}", (block.where, got))
            wrong = True
    rows = block.rows(keys, lines)
    if rows is None or wrong:
        return None
    held_in_order = ("".join(axis for axis in AXES if axis in held) for held in cells.values)
    return dict(zip(rows, held_in_order, strict=True))


def read_loads(block: ActionBlock) -> Loads | None:
    """Return node row -> force; None where any is wrong."""
    if fields.is_table(block.value):
        return _loads_of_table(block)
    values = fields.optional(block.findings, block.where, block.value, _FORCES)
    if not values:
        return None if values is None or lost(values) else {}
    points = block.points
    forces = nodes.vectors(block.findings, block.where, values, points.dimension if points else None)
    return _by_row(block.rows(block.keys(values), values), forces)


def _loads_of_table(block: ActionBlock) -> Loads | None:
    table = block.table("loads")
    if table is None:
        return None
    axes = [axis for axis in AXES if axis in table.header]
    d = block.points.dimension if block.points else None
    if d is not None and len(axes) != d:
        wanted, got = (", ".join(own) for own in (AXES[:d], axes))
        table.add(-1, 0, f"forces of this {d}-D scene need the columns {wanted}, got {got}")
        return None
    columns = [table.column(axis).numbers(ANY_SIZE) for axis in axes]
    good = [column for column in columns if column is not None]
    rows = block.rows(table.column("name"))
    return _by_row(rows, np.column_stack(good) if table.findings.none else None)


def _by_row(rows: list[int] | None, forces: np.ndarray | None) -> Loads | None:
    if forces is None or rows is None:
        return None
    return dict(zip(rows, map(tuple, forces.tolist()), strict=True))


def read_gravity(block: ActionBlock) -> tuple[float, ...] | None:
    """Return the direction of weight; None where none is given, or it is wrong."""
    if is_absent(block.value):
        return None
    d = block.points.dimension if block.points else None
    found_one = nodes.vectors(block.findings, (), {str(block.where[0]): block.value}, d)
    if found_one is None:
        return None
    if not found_one.any():
        block.findings.add(block.where, "must point somewhere, got a direction of no length")
        return None
    return tuple(found_one[0].tolist())


def read_cases(block: ActionBlock) -> dict[str, Loads] | None:
    """Return the load cases, name -> node row -> force; None where any is wrong."""
    content = "of names of load cases to their forces"
    values = fields.optional(block.findings, block.where, block.value, content)
    if values is None:
        return None
    _check_names(block, values)
    read = {name: read_loads(block.inside(name, own)) for name, own in values.items()}
    good = {name: loads for name, loads in read.items() if loads is not None}
    return good if len(good) == len(values) and not lost(values) else None


def read_combinations(block: ActionBlock, cases: object, known: bool) -> dict[str, dict[str, float]] | None:
    """Return the combinations, name -> case or "dead" -> factor.

    cases: the block of load cases as given; known: where it is absent, it is so under no other name
    """
    content = "of names of combinations to factors"
    values = fields.optional(block.findings, block.where, block.value, content)
    if values is None:
        return None
    _check_names(block, values)
    names = list(cases) if isinstance(cases, dict) else []
    parts = [DEAD, *names]
    is_sure = not lost(cases) if isinstance(cases, dict) else known and is_absent(cases)
    combinations = {}
    for name, factors in values.items():
        where = (*block.where, name)
        if name in names:
            block.findings.add_key(where, f"{quoted(name)} is a load case already")
        own = fields.mapping(block.findings, where, factors, "of load cases to factors")
        if own is not None and not own and not lost(own):
            block.findings.add(where, "must hold at least one factor, got none")
        for case in own or ():
            if is_sure and case not in parts:
                hint = block.findings.hint(case, parts) or f"; allowed: {', '.join(parts)}"
                block.findings.add_key((*where, case), f"no load case is named {quoted(case)}{hint}")
        numbers = _numbers(block.inside(name, factors), own or {})
        if numbers is not None:
            combinations[name] = dict(zip(own or (), numbers.tolist(), strict=True))
    return combinations


def _numbers(block: ActionBlock, values: Mapping[str, Any]) -> np.ndarray | None:
    """Return the numbers of a mapping; None where one is none."""
    keys = list(values)
    cells = CellColumn(block.findings, list(values.values()), lambda row: (*block.where, keys[row]))
    return cells.numbers(ANY_SIZE)


def _check_names(block: ActionBlock, values: Mapping[str, Any]) -> None:
    """Record names that no file and no `--case` could have."""
    for name in values:
        if not _CASE.fullmatch(name):
            message = f"a name here holds letters, digits, - and _ alone, got {quoted(name)}"
            block.findings.add_key((*block.where, name), message)
        elif name in (DEAD, ALL_CASES):
            what = "weight and loads" if name == DEAD else "every case"
            block.findings.add_key((*block.where, name), f"{quoted(name)} stands for {what} already")
