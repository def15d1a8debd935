"""Nodes and elements from CSV files, column by column; a bad cell is reported at its own place."""

import os.path
from collections.abc import Collection, Sequence
from functools import partial
from itertools import chain

import numpy as np

from cgff_cli.errors import Problem, SceneError
from cgff_cli.scene.csv_text import Table
from cgff_cli.scene.fields import found, name_fault, number_text_fault, size_fault, sizes_fit, text_numbers
from cgff_cli.scene.findings import Findings, Where, quoted
from cgff_cli.scene.keys import key_faults
from cgff_cli.scene.located import Plain
from cgff_cli.scene.nodes import Nodes
from cgff_cli.scene.scene import KINDS, Group
from cgff_cli.scene.text import read_text, reason

NODE_COLUMNS = ("name", "x", "y", "z")
ELEMENT_COLUMNS = ("start", "end", "group", "kind", "EA", "rest_length")


class _Columns:
    """A table's cells by column name, stripped; rows that are too short are filled with ""."""

    def __init__(self, table: Table, required: Collection[str], allowed: Collection[str]):
        self.table = table
        self.ragged: set[int] = set()
        self.by_name: dict[str, list[str]] = {}
        self.complete = _check_header(table, required, allowed)
        if self.complete:
            self._even_out()

    def _even_out(self) -> None:
        table = self.table
        width = len(table.header)
        if table.cells is not None:
            self.by_name = {column: table.cells[i::width] for i, column in enumerate(table.header)}
            return
        if set(map(len, table.rows)) != {width}:
            self.ragged = {i for i, row in enumerate(table.rows) if len(row) != width}
        for i in sorted(self.ragged):
            row = table.rows[i]
            message = f"this row has {len(row)} cells, the header has {width}"
            table.add(i, min(len(row) - 1, width), message, alike=message)
            table.rows[i] = (row + [""] * width)[:width]
        cells = list(chain.from_iterable(table.rows))
        self.by_name = {column: cells[i::width] for i, column in enumerate(table.header)}

    def texts(self, column: str) -> list[str]:
        """Return the cells of a column without blanks around them."""
        cells = self.by_name[column]
        return list(map(str.strip, cells)) if self.table.blanks else cells

    def add(self, row: int, column: str, message: str, alike: str | None = None) -> None:
        """Record a problem of a cell, unless its whole row has been reported."""
        if row not in self.ragged:
            self.table.add(row, self.table.header.index(column), message, alike)

    def names(self, column: str) -> list[str]:
        """Return a column of names, recording every text that cannot be one."""
        texts = self.texts(column)
        if not all(texts) or not "".join(texts).isprintable() or max(map(len, texts), default=0) > 200:
            for row, text in enumerate(texts):
                if fault := name_fault(text):
                    self.add(row, column, f"{column}: {fault}")
        return texts

    def numbers(self, column: str, lower: str = "") -> np.ndarray | None:
        """Return a column of numbers, recording every cell that is none or out of its range."""
        texts = self.texts(column)
        result = text_numbers(texts)
        if result is not None and sizes_fit(result, lower):
            return result
        for row, text in enumerate(texts):
            fault = number_text_fault(text)
            size = None if fault else size_fault(float(text), lower, found(Plain(text)))
            if fault or size:
                zeros = column if size and float(text) == 0.0 else None
                self.add(row, column, f"{column}: {fault or size}", alike=zeros)
        return None


def open_table(findings: Findings, where: Where, file: str, base: str) -> Table | None:
    """Return the table in a file whose path is relative to `base`, or record why it cannot be read."""
    path = os.path.join(base, file)
    findings.tables.append(path)
    try:
        text = read_text(path)
    except SceneError as error:
        findings.other_files.append(Unreadable(error.problems))
        return None
    except (OSError, ValueError) as error:
        findings.add(where, f"cannot read {quoted(path)}: {reason(error)}")
        return None
    table = Table(path, text)
    findings.other_files.append(table)
    return table


class Unreadable:
    """A file that is no text."""

    sound = False

    def __init__(self, problems: Sequence[Problem]):
        self._problems = list(problems)

    def problems(self) -> list[Problem]:
        """Return where it stops being text."""
        return self._problems


def read_nodes(table: Table) -> Nodes | None:
    """Return the nodes of a table with columns name, x, y and perhaps z."""
    columns = _Columns(table, NODE_COLUMNS[:3], NODE_COLUMNS)
    if not columns.complete:
        return None
    names = columns.names("name")
    rows = dict(zip(names, range(len(names)), strict=True))
    table_rows: Sequence[int] = range(len(names))
    if len(rows) < len(names):
        table_rows = _first_rows(columns, names)
        rows = {names[row]: i for i, row in enumerate(table_rows)}
    axes = NODE_COLUMNS[1 : len(table.header)]
    read = [columns.numbers(axis) for axis in axes]
    good = [column for column in read if column is not None]
    coordinates = np.column_stack(good) if table.sound and len(good) == len(axes) else None
    nodes = Nodes(rows, coordinates, len(axes), lambda row, text: columns.add(table_rows[row], "name", text))
    if not table.sound:
        nodes.lost = len(columns.ragged) + sum(map(bool, map(name_fault, rows))) + len(names) - len(rows)
    return nodes


def _first_rows(columns: _Columns, names: list[str]) -> list[int]:
    """Return where each name stands first, and record every name that stands again."""
    first: dict[str, int] = {}
    for row, name in enumerate(names):
        if first.setdefault(name, row) != row and name:
            line = columns.table.place(first[name], 0)[0]
            columns.add(row, "name", f"node {quoted(name)} is defined twice; first on line {line}")
    return list(first.values())


def read_elements(
    findings: Findings, table: Table, nodes: Nodes | None, law: str | None
) -> list[Group] | None:
    """Return the groups of a table, in order of first appearance; None where a cell is wrong."""
    columns = _Columns(table, ELEMENT_COLUMNS, ELEMENT_COLUMNS)
    if not columns.complete:
        return None
    ends = [_rows(findings, columns, column, nodes) for column in ("start", "end")]
    EA = columns.numbers("EA", "> 0")
    rest_length = columns.numbers("rest_length", "> 0" if law == "hooke" else ">= 0")
    groups, kinds = columns.names("group"), columns.texts("kind")
    _check_kinds(columns, groups, kinds)
    if ends[0] is None or ends[1] is None or EA is None or rest_length is None:
        return None
    pairs = np.column_stack((ends[0], ends[1]))
    names = columns.texts("start")
    for row in np.flatnonzero(pairs[:, 0] == pairs[:, 1]).tolist():
        columns.add(row, "end", f"node {quoted(names[row])} is joined to itself")
    return _split(groups, kinds, pairs, EA, rest_length) if table.sound else None


def _split(
    groups: list[str], kinds: list[str], pairs: np.ndarray, EA: np.ndarray, rest_length: np.ndarray
) -> list[Group]:
    order = {group: code for code, group in enumerate(dict.fromkeys(groups))}
    codes = np.fromiter(map(order.__getitem__, groups), np.intp, len(groups))
    rows = np.argsort(codes, kind="stable")
    ends = np.cumsum(np.bincount(codes))[:-1]
    return [
        Group(name, kinds[rows_of[0]], pairs[rows_of], EA[rows_of], rest_length[rows_of])
        for name, rows_of in zip(order, np.split(rows, ends), strict=True)
    ]


def _rows(findings: Findings, columns: _Columns, column: str, nodes: Nodes | None) -> np.ndarray | None:
    rows = nodes.look_up(columns.texts(column)) if nodes else None
    if rows is None:
        names = columns.names(column)
        if nodes is None:
            return None
        for row, name in enumerate(names):
            if name and name not in nodes.rows:
                nodes.stranger(name, partial(columns.add, row, column))
    return rows


def _check_kinds(columns: _Columns, groups: list[str], kinds: list[str]) -> None:
    of_group: dict[str, str] = {}
    uses = set(zip(groups, kinds, strict=True))
    if len(uses) == len({group for group, _ in uses}) and {kind for _, kind in uses} <= set(KINDS):
        return
    for row, (group, kind) in enumerate(zip(groups, kinds, strict=True)):
        if kind not in KINDS:
            message = f"kind: must be cable or strut, got {quoted(kind) if kind else 'nothing'}"
            columns.add(row, "kind", message, alike=message)
        elif of_group.setdefault(group, kind) != kind:
            columns.add(row, "kind", f"group {quoted(group)} is of kind {of_group[group]} above, here {kind}")


def _check_header(table: Table, required: Collection[str], allowed: Collection[str]) -> bool:
    """Record what is wrong with the header and return whether every row can be read by it."""
    if not table.sound:
        return False
    header = table.header
    faults, missing = key_faults(header, allowed, required, "column")
    if not set(map(str.lower, header)) & set(map(str.lower, allowed)):  # no header at all
        faults, missing = {}, list(required)
    for column, fault in faults.items():
        table.add(-1, header.index(column), fault)
    twice = [i for i, column in enumerate(header) if column in allowed and column in header[:i]]
    for i in twice:
        table.add(-1, i, f"column {quoted(header[i])} stands here twice")
    if len(missing) > len(twice):
        first = header[0] if len(header) == 1 else ""
        hint = next((f"; cells are split by commas, not by {mark!r}" for mark in ";\t|" if mark in first), "")
        table.add(-1, 0, f"the first line must name the columns, missing: {', '.join(missing)}{hint}")
    elif table.empty:
        table.add(-1, 0, "the table has no rows")
    return table.sound
