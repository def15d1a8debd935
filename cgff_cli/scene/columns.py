"""Values one below the other that know their places: what all forms of a scene are turned into.

A list or mapping of YAML, JSON or Python is a column, and so is a column of a CSV table. Whole columns
are judged at once; only what is wrong is looked at singly, and has its place worked out.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from cgff_cli.scene.fields import NUMBER, Plain, name_fault, number_fault
from cgff_cli.scene.findings import Findings, Where
from cgff_cli.values import LONGEST, Rule, as_number

_NUMBER_CHARACTERS = b"0123456789+-.eE"


class CellColumn:
    """A column of a scene, read as numbers, as names or as ends of elements.

    where  : leads from a row to its value
    at_key : the values are keys
    cells  : the values are cells of a table: text without quotes, whatever its type
    """

    def __init__(
        self,
        findings: Findings,
        values: Sequence[Any],
        where: Callable[[int], Where],
        at_key: bool = False,
        cells: bool = False,
    ):
        self.findings = findings
        self.values = values
        self.where = where
        self.at_key = at_key
        self.cells = cells

    def add(self, row: int, message: str, alike: object = None) -> None:
        """Record a problem of a value."""
        add = self.findings.add_key if self.at_key else self.findings.add
        add(self.where(row), message, alike=alike)

    def add_bare(self, row: int, message: str, alike: object = None) -> None:
        """Record a problem of a value; that of a cell without the name of its column."""
        add = self.findings.add_key if self.at_key or self.cells else self.findings.add
        add(self.where(row), message, alike=alike)

    def numbers(self, rule: Rule) -> np.ndarray | None:
        """Return the numbers of a column, recording every value that is none or out of its range."""
        numbers = self._at_once()
        if numbers is None:
            numbers = np.array([self._double(value) for value in self.values], dtype=float)
        wrong = np.flatnonzero(~rule.fits(numbers)).tolist()
        for row in wrong:
            value = Plain(self.values[row]) if self.cells else self.values[row]
            field = next((step for step in reversed(self.where(row)) if isinstance(step, str)), "")
            zeros = ("zeros", field) if numbers[row] == 0.0 else None
            self.add(row, number_fault(value, rule, self.cells) or "", alike=zeros)
        return None if wrong else numbers

    def _at_once(self) -> np.ndarray | None:
        """Return the numbers of a column, or None where a value is none."""
        kinds = set(map(type, self.values))
        if self.cells or kinds == {Plain}:
            return _text_numbers(self.values)
        if not kinds <= {int, float}:
            return None
        try:
            return np.array(self.values, dtype=float)
        except OverflowError:
            return None

    def _double(self, value: object) -> float:
        """Return a value as a number, nan where it is none."""
        if isinstance(value, Plain) or self.cells:
            return float(str(value)) if NUMBER.fullmatch(str(value)) else np.nan
        number = as_number(value)
        return np.nan if number is None else float(number)

    def names(self) -> Sequence[str | None]:
        """Return the names of a column, None for every value that can be none, which is recorded."""
        values, kinds = self.values, set(map(type, self.values))
        short = kinds <= {str, Plain} and all(values) and max(map(len, values), default=0) <= LONGEST
        if short and "".join(values).isprintable():
            return list(map(str, values)) if Plain in kinds else values
        read: list[str | None] = []
        for row, value in enumerate(values):
            fault = name_fault(value)
            if fault:
                self.add(row, fault)
            read.append(None if fault else str(value))
        return read


def _text_numbers(texts: Sequence[str]) -> np.ndarray | None:
    """Return the numbers of texts, or None where one is no number."""
    if texts and texts.count(texts[0]) == len(texts):
        return np.full(len(texts), float(texts[0])) if NUMBER.fullmatch(texts[0]) else None
    try:
        if "".join(texts).encode().translate(None, _NUMBER_CHARACTERS):
            return None
        return np.fromiter(map(float, texts), float, len(texts))
    except ValueError:  # also where a text holds half a character
        return None
