"""CSV text -> a header and rows of cells, and the line and column of any cell once one is needed."""

import csv
import io
from collections.abc import Iterator
from contextlib import suppress
from functools import cached_property

from cgff_cli.errors import Problem
from cgff_cli.scene.findings import LISTED, Mark, counted, folded, listed, more

_NO_MARKS = bytes(byte for byte in range(256) if byte not in b",\n")
_BLANKS = [chr(code) for code in range(128) if chr(code).isspace() and chr(code) != "\n"]


class Table:
    """Rows of one CSV file, and the problems found in it.

    header : stripped names of the columns
    cells  : cells of all rows one after another, where every row has as many as the header
    rows   : cells of every row that is not blank, as they are written; not needed where `cells` are

    Text without quotes, in which commas and line ends alternate as the header says, is cut at them; any
    other text is left to the csv module, which takes five times as long.
    """

    def __init__(self, path: str, text: str):
        self.path = path
        self._text = text
        self._found: list[tuple[Mark, str, str | None]] = []
        self._broken: list[Problem] = []
        self.header: list[str] = []
        self.rows: list[list[str]] = []
        self.cells: list[str] | None = None
        self.blanks = True
        if not self._cut(text):
            self._parse(text)

    def _cut(self, text: str) -> bool:
        """Read a text that is as regular as a program writes it; return False where it is not."""
        first, _, body = text.partition("\n")
        header = [name.strip() for name in first.split(",")]
        if len(header) < 2 or '"' in text or "\r" in text:
            return False
        body = body.removesuffix("\n")
        marks = body.encode("utf-8").translate(None, _NO_MARKS)
        line = b"," * (len(header) - 1) + b"\n"
        if marks + b"\n" != line * (len(marks) // len(line) + 1):
            return False
        self.header, self.cells = header, body.replace("\n", ",").split(",")
        self.blanks = not body.isascii() or any(blank in body for blank in _BLANKS)
        return True

    def _parse(self, text: str) -> None:
        """Read any text by the rules of CSV."""
        reader = csv.reader(io.StringIO(text, newline=""), strict=True)
        try:
            self.header = [cell.strip() for cell in next((row for row in reader if not _blank(row)), [])]
            self.rows = list(reader)
        except csv.Error as error:
            self._broken.append(Problem(self.path, self._broken_line(), 1, f"not valid CSV: {error}"))

        if set(map(len, self.rows)) != {len(self.header)}:
            self.rows = [row for row in self.rows if not _blank(row)]

    @property
    def empty(self) -> bool:
        """Whether there is a header at most."""
        return not self.rows and not self.cells

    def add(self, row: int, column: int, message: str, alike: str | None = None) -> None:
        """Record a problem of one cell; row -1 is the header; those that are `alike` are told once."""
        self._found.append(((row, column), message, alike))

    @property
    def sound(self) -> bool:
        """Whether no problem was found."""
        return not self._found and not self._broken

    def problems(self) -> list[Problem]:
        """Return the problems with their places, the first LISTED of them and how many follow."""
        ordered = folded(self._found)
        shown = [self._problem(*item) for item in ordered[:LISTED]]
        if len(ordered) > LISTED:
            return [*shown, more(self._problem(*ordered[-1]), len(ordered) - LISTED)]
        return listed(shown + self._broken)

    def _problem(self, cell: Mark, message: str, others: list[Mark]) -> Problem:
        line, column = self.place(*cell)
        return Problem(self.path, line, column, counted(message, line, [self.place(*o)[0] for o in others]))

    def place(self, row: int, column: int) -> Mark:
        """Return line and column of the first character of a cell."""
        line = self._starts[row + 1]
        text = "".join(self._lines[line - 1 :][: self._spans[row + 1]])
        offset = _cell_offset(text, column)
        last_break = text.rfind("\n", 0, offset)
        return line + text.count("\n", 0, offset), offset - last_break

    def _broken_line(self) -> int:
        """Return where the row starts that csv cannot read; csv itself tells where it gave up."""
        line = 1
        reader = csv.reader(self._lines, strict=True)
        with suppress(csv.Error):
            for _ in reader:
                line = reader.line_num + 1
        return line

    @cached_property
    def _lines(self) -> list[str]:
        return list(io.StringIO(self._text, newline=""))

    @cached_property
    def _extents(self) -> list[Mark]:
        """First line and number of lines of the header and of every row that is not blank."""
        reader = csv.reader(self._lines)
        extents, before = [], 0
        for row in reader:
            if not _blank(row):
                extents.append((before + 1, reader.line_num - before))
            before = reader.line_num
        return extents or [(1, 1)]

    @cached_property
    def _starts(self) -> list[int]:
        return [first for first, _ in self._extents]

    @cached_property
    def _spans(self) -> list[int]:
        return [count for _, count in self._extents]


def _blank(row: list[str]) -> bool:
    return not row or (len(row) == 1 and not row[0].strip())


def _cell_offset(text: str, column: int) -> int:
    """Return where a cell starts: behind the column-th comma outside quotes, and behind blanks."""
    starts = _cell_starts(text)
    offset = 0
    for _ in range(column + 1):
        offset = next(starts, offset)
    while text[offset : offset + 1] in (" ", "\t"):
        offset += 1
    return offset


def _cell_starts(text: str) -> Iterator[int]:
    yield 0
    inside = False
    for offset, character in enumerate(text):
        if character == '"':
            inside = not inside
        elif character == "," and not inside:
            yield offset + 1
