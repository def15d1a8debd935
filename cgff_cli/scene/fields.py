"""Values, singly and in columns: what was found in one, and why it is no number, name, word or mapping.

Values may come from YAML (`Plain` or quoted text), from JSON or from Python. A list or mapping of any of them
is a column, and so is a column of a CSV table. Whole columns are judged at once; only what is wrong is looked
at singly, and has its place worked out.
"""

import math
import os.path
import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.scene.findings import Findings, Where, quoted
from cgff_cli.values import LONGEST, Rule, as_number

HUGE = 1e30
LEAST_SIZE = 1e-30
"""Limits of size: under law `hooke` the squared gradient of eq. (10) goes like (EA / l0)^4 l^2, a product
of ten quantities of the scene, and must stay inside the range of doubles, 1e308."""

NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_NUMBER_CHARACTERS = b"0123456789+-.eE"
_NOT_FINITE = ("nan", "inf", "infinity")
_NOT_IN_NAMES = "[^\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]"


class Plain(str):
    """A scalar written without quotes."""

    __slots__ = ()


def is_absent(value: object) -> bool:
    """Return whether an optional key was written with nothing after it."""
    return value is None or (isinstance(value, Plain) and value in ("", "~", "null"))


def is_table(value: object) -> bool:
    """Tell whether a value names a CSV file."""
    return isinstance(value, str) and os.path.splitext(value)[1].lower() == ".csv"


def found(value: object) -> str:
    """Return what was found, in words short enough for a message."""
    if value is None or (isinstance(value, Plain) and value == ""):
        return "nothing"
    if isinstance(value, Plain):
        return str(value) if len(value) <= 60 and value.isprintable() else quoted(value)
    if isinstance(value, str):
        return f"{quoted(value)} in quotes"
    if isinstance(value, list):
        return f"a list of {len(value)}" if value else "an empty list"
    if isinstance(value, dict):
        return "a mapping" if value else "an empty mapping"
    if isinstance(value, float) or (isinstance(value, int) and abs(value) < 10**30):
        return str(value)
    return "a huge number" if isinstance(value, int) else f"a value of type {type(value).__name__}"


def number_fault(value: object, rule: Rule, cell: bool = False) -> str | None:
    """Return why a value is no number that a rule allows, or None where it is one; `cell`: of a table."""
    got = found(value)
    if isinstance(value, Plain) and (value or cell):
        if NUMBER.fullmatch(value):
            return rule.fault(float(value), got)
        finite = value.lower().lstrip("+-.") in _NOT_FINITE
        return f"must be a {'finite number' if finite else 'number such as 2.98 or 1e-8'}, got {got}"
    if isinstance(value, str) and NUMBER.fullmatch(value):
        return f"must be a number, got {got}; write it without them"
    number = as_number(value)
    if number is None:
        return f"must be a number, got {got}"
    if isinstance(value, float) and not math.isfinite(value):
        return f"must be a finite number, got {value}"
    return rule.fault(number, got)


def name_fault(value: object) -> str | None:
    """Return why a value cannot be a name, or None where it can; whole numbers from JSON count as text."""
    if isinstance(value, int) and not isinstance(value, bool):
        value = str(value)
    if not isinstance(value, str):
        return f"must be a name, got {found(value)}"
    if not value:
        return "a name must not be empty"
    if len(value) > LONGEST:
        return f"a name has at most {LONGEST} characters, got {len(value)}"
    bad = re.search(_NOT_IN_NAMES, value)
    return f"a name may not contain the character U+{ord(bad.group()):04X}" if bad else None


def mapping(findings: Findings, where: Where, value: object, content: str) -> dict[str, Any] | None:
    """Return a mapping; `content` says in the message what it holds."""
    if isinstance(value, dict):
        return value
    findings.add(where, f"must be a mapping {content}, got {found(value)}")
    return None


def optional(findings: Findings, where: Where, value: object, content: str) -> dict[str, Any] | None:
    """Return a mapping that may be left out."""
    return {} if is_absent(value) else mapping(findings, where, value, content)


def one_of(
    findings: Findings, where: Where, value: object, allowed: tuple[str, ...], explained: str
) -> str | None:
    """Return one of a few allowed words, or record that it is none."""
    if isinstance(value, str) and value in allowed:
        return str(value)
    hint = findings.hint(value, allowed) if isinstance(value, str) else ""
    findings.add(where, f"must be {explained}, got {found(value)}{hint}")
    return None


def ruled(
    findings: Findings, where: Where, values: Mapping[str, Any], rules: Mapping[str, Rule]
) -> dict[str, Any]:
    """Return the values that rules speak of, each in its own type, and record those they do not allow."""
    allowed: dict[str, Any] = {}
    for key in (key for key in values if key in rules):
        if isinstance(values[key], (list, dict)):
            findings.add((*where, key), f"must be one value, got {found(values[key])}")
            continue
        try:
            allowed[str(key)] = rules[key].checked(key, option_value(values[key]))
        except OptionError as error:
            findings.add((*where, key), str(error).removeprefix(f"{key} "))
    return allowed


def option_value(value: object) -> object:
    """Return a number where the text of an option is one, else the value as it is."""
    if isinstance(value, Plain) and NUMBER.fullmatch(value):
        return int(value) if value.lstrip("+-").isdigit() and len(value) < 16 else float(value)
    if isinstance(value, int) and abs(value) > 2**63:
        number = as_number(value)
        return None if number is None else float(number)
    return str(value)[:60] if isinstance(value, str) else value


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

    def add(self, row: int, message: str, alike: object = None, bare: bool = False) -> None:
        """Record a problem of a value; bare: that of a cell without the name of its column."""
        add = self.findings.add_key if self.at_key or (self.cells and bare) else self.findings.add
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
