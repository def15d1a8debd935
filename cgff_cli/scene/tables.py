"""CSV tables: a header and columns of cells, and the line and column of any cell once one is needed."""

import csv
import io
import os.path
import re
from array import array
from collections.abc import Collection, Iterator
from functools import cached_property
from itertools import accumulate

from cgff_cli import hints
from cgff_cli.errors import SceneError
from cgff_cli.scene.fields import CellColumn
from cgff_cli.scene.findings import NOWHERE, Findings, Mark, Where, quoted
from cgff_cli.scene.keys import key_faults, meant_by
from cgff_cli.scene.text import read_text, reason

HEADERS = {
    "nodes": ("name", "x", "y", "z"),
    "elements": ("start", "end", "group", "kind", "EA", "rest_length", "pretension", "weight"),
    "supports": ("name", "axes"),
    "loads": ("name", "x", "y", "z"),
}
"""What a table is of -> its columns; others are passed over."""

_OPTIONAL = ("z", "rest_length", "pretension", "weight")
_LENGTHS = ("rest_length", "pretension")
_BLANKS = [chr(code) for code in range(128) if chr(code).isspace() and chr(code) not in "\r\n"]
_CELL = re.compile(r'(?:[^",]++|"[^"]*+")*+,')


class Table:
    """The rows of one CSV file that are not blank, read in one pass, and what is wrong with them.

    header : stripped names of the columns
    cells  : cells of all rows one after another; every row has as many as the header
    ragged : row -> how many cells it has, where not as many as the header
    """

    def __init__(self, text: str):
        self._text = text
        self._begins = array("l")  # the line of every row, the header's first
        self._faults: list[tuple[Mark, str]] = []
        self.findings = Findings(self._faults, lambda where: str(where[1]) if len(where) > 1 else "")
        self.header: list[str] = []
        self.cells: list[str] = []
        self.ragged: dict[int, int] = {}
        rows = self._rows(text)
        self.header = [cell.strip() for cell in next(rows, [])]
        width = len(self.header)
        for row in rows:
            if len(row) != width:
                self.ragged[len(self._begins) - 2] = len(row)
                row = (row + [""] * width)[:width]
            self.cells += row

    def _rows(self, text: str) -> Iterator[list[str]]:
        """Yield the rows that are not blank, and keep the line on which each begins."""
        reader = csv.reader(io.StringIO(text, newline=""), strict=True)
        begin = 1
        try:
            for row in reader:
                if len(row) > 1 or (row and row[0].strip()):
                    self._begins.append(begin)
                    yield row
                begin = reader.line_num + 1
        except csv.Error as error:
            self._faults.append(((begin, 1), f"not valid CSV: {error}"))

    @property
    def count(self) -> int:
        """How many rows there are below the header."""
        return max(len(self._begins) - 1, 0)

    def add(self, row: int, column: int, message: str, alike: str | None = None) -> None:
        """Record a problem of one cell, without the name of its column; row -1 is the header."""
        self.findings.add_key((row, column), message, alike)

    def column(self, name: str) -> CellColumn:
        """Return a column of cells without blanks around them."""
        index = self.header.index(name)
        cells = self.cells[index :: len(self.header)]
        if self._blanks:
            cells = list(map(str.strip, cells))
        return CellColumn(self.findings, cells, lambda row: (row, name), cells=True)

    @cached_property
    def _blanks(self) -> bool:
        """Whether a cell may begin or end with a blank."""
        return '"' in self._text or not self._text.isascii() or any(b in self._text for b in _BLANKS)

    def place(self, where: Where, at_key: bool = False) -> Mark:
        """Return line and column of the first character of a cell."""
        row, column = int(where[0]), where[1]
        line, *after = self._begins[row + 1 : row + 3] or (1,)
        start = offset = self._offsets[line - 1]
        end = self._offsets[after[0] - 1] if after else len(self._text)
        for _ in range(self.header.index(column) if isinstance(column, str) else column):
            cell = _CELL.match(self._text, offset, end)
            offset = cell.end() if cell else offset
        while self._text[offset : offset + 1] in (" ", "\t"):
            offset += 1
        begin = max(start, self._text.rfind("\n", start, offset) + 1)
        return line + self._text.count("\n", start, offset), offset - begin + 1

    @cached_property
    def _offsets(self) -> "array[int]":
        """Where each line begins."""
        return array("l", accumulate(map(len, io.StringIO(self._text, newline="")), initial=0))


def open_table(findings: Findings, where: Where, kind: str, file: str, base: str) -> Table | None:
    """Return the table, of a kind of HEADERS, in a file below `base`; None where a row cannot be read."""
    path = os.path.join(base, file)
    findings.tables.append(path)
    try:
        text = read_text(path)
    except SceneError as error:
        faults = [((line, column), message) for _, line, column, message in error.problems]
        findings.of_file(path, lambda where, at_key: NOWHERE, Findings(faults))
        return None
    except (OSError, ValueError) as error:
        findings.add(where, f"cannot read {quoted(path)}: {reason(error)}")
        return None
    table = Table(text)
    findings.of_file(path, table.place, table.findings)
    if not table.findings.none or not _has_header(table, HEADERS[kind]):
        return None
    unused = [column for column in table.header if column not in HEADERS[kind]]
    if unused:
        findings.notes.append(f"{path}: not used: {hints.count(len(unused), 'column')}, {', '.join(unused)}")
    for row, count in table.ragged.items():
        message = f"this row has {count} cells, the header has {len(table.header)}"
        table.add(row, min(count - 1, len(table.header)), message, alike=message)
    table.findings.closed.update(table.ragged)
    return table


def _has_header(table: Table, allowed: Collection[str]) -> bool:
    """Record what is wrong with the header and return whether every row can be read by it."""
    header = table.header
    required = [column for column in allowed if column not in _OPTIONAL]
    absent = [column for column in allowed if column not in header]
    if set(_LENGTHS) & set(header):
        absent = [column for column in absent if column not in _LENGTHS]
    known = [column for column in header if column in allowed or meant_by(column, absent)]
    faults, missing = key_faults(known, allowed, required, "column")
    if not set(map(str.lower, header)) & set(map(str.lower, allowed)):  # no header at all
        faults, missing = {}, required
    for column, fault in faults.items():
        table.add(-1, header.index(column), fault)
    twice = [i for i, column in enumerate(header) if column in allowed and column in header[:i]]
    for i in twice:
        table.add(-1, i, f"column {quoted(header[i])} stands here twice")
    if len(missing) > len(twice):
        first = header[0] if len(header) == 1 else ""
        hint = next((f"; cells are split by commas, not by {mark!r}" for mark in ";\t|" if mark in first), "")
        table.add(-1, 0, f"the first line must name the columns, missing: {', '.join(missing)}{hint}")
    elif not table.cells:
        table.add(-1, 0, "the table has no rows")
    return table.findings.none
