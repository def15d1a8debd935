"""Readers for single fields: a number, numbers, a name, a mapping. Each records what is wrong.

Values may come from YAML (`Plain` or quoted text), from JSON or from Python. Every reader returns
None where it recorded a problem.
"""

import math
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from cgff_cli.scene.findings import Findings, Where, quoted
from cgff_cli.scene.located import Plain

HUGE = 1e30
TINY = 1e-30
"""Limits of size: under law `hooke` the squared gradient of eq. (10) goes like (EA / l0)^4 l^2, a product
of ten quantities of the scene, and must stay inside the range of doubles, 1e308."""

NAME_LENGTH = 256
"""Longest name; a YAML key may not be much longer."""

_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")
_NUMBER_CHARACTERS = b"0123456789+-.eE"
_NOT_FINITE = ("nan", "inf", "infinity")
_NOT_IN_NAMES = "[^\x20-\x7e\xa0-\u2027\u202a-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]"


def is_absent(value: object) -> bool:
    """Return whether an optional key was written with nothing after it."""
    return value is None or (isinstance(value, Plain) and value in ("", "~", "null"))


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


def number_text_fault(text: str) -> str | None:
    """Return why a text is no number, or None where it is one."""
    if _NUMBER.fullmatch(text):
        return None
    if text.lower().lstrip("+-.") in _NOT_FINITE:
        return f"must be a finite number, got {found(Plain(text))}"
    return f"must be a number such as 2.98 or 1e-8, got {found(Plain(text))}"


def size_fault(number: float, lower: str, text: str) -> str | None:
    """Return why a number is outside its range, or None; lower is "", "> 0" or ">= 0"."""
    if (lower == "> 0" and number <= 0.0) or (lower and number < 0.0):
        return f"must be {lower}, got {text}"
    if abs(number) > HUGE:
        return f"must not exceed 1e30 in size, got {text}"
    if lower and 0.0 < number < TINY:
        return f"must be at least 1e-30, got {text}"
    return None


def sizes_fit(numbers: np.ndarray, lower: str) -> bool:
    """Return whether every number of an array is finite and inside its range."""
    if not np.all(np.abs(numbers) <= HUGE):
        return False
    if not lower:
        return True
    return bool(np.all((numbers >= TINY) | ((numbers == 0.0) & (lower == ">= 0"))))


def text_numbers(texts: Sequence[str]) -> np.ndarray | None:
    """Return the numbers of many texts at once, or None where one is no number."""
    if texts and texts.count(texts[0]) == len(texts):
        number = _each_number(texts[:1])
        return None if number is None else np.full(len(texts), number[0])
    return _each_number(texts)


def _each_number(texts: Sequence[str]) -> np.ndarray | None:
    """Return the numbers of texts that are not all alike, or None where one is no number."""
    try:
        if "".join(texts).encode().translate(None, _NUMBER_CHARACTERS):
            return None
        return np.fromiter(map(float, texts), float, len(texts))
    except ValueError:  # also where a text holds half a character
        return None


def number(findings: Findings, where: Where, value: object, lower: str = "") -> float | None:
    """Return a finite number in its range."""
    fault, result = None, 0.0
    if isinstance(value, Plain):
        fault = number_text_fault(value) if value else "must be a number, got nothing"
        result = 0.0 if fault else float(value)
    elif isinstance(value, str) and _NUMBER.fullmatch(value):
        fault = f"must be a number, got {found(value)}; write it without them"
    elif isinstance(value, bool) or not isinstance(value, (int, float)):
        fault = f"must be a number, got {found(value)}"
    elif isinstance(value, float) and not math.isfinite(value):
        fault = f"must be a finite number, got {value}"
    else:
        result = _as_double(value)
    size = None if fault else size_fault(result, lower, found(value))
    if fault or size:
        field = next((step for step in reversed(where) if isinstance(step, str)), "")
        zeros = ("zeros", field) if size and result == 0.0 else None
        findings.add(where, fault or size or "", alike=zeros)
        return None
    return result


def _as_double(value: int | float) -> float:
    try:
        return float(value)
    except OverflowError:
        return float("inf") if value > 0 else float("-inf")


def numbers(findings: Findings, where: Where, values: list[Any], lower: str = "") -> np.ndarray | None:
    """Return a list of numbers as an array; each bad one is a problem of its own."""
    result = numbers_at_once(values)
    if result is not None and sizes_fit(result, lower):
        return result
    read = [number(findings, (*where, i), value, lower) for i, value in enumerate(values)]
    return None if None in read else np.array(read, dtype=float)


def numbers_at_once(values: list[Any]) -> np.ndarray | None:
    """Return many numbers as an array, or None where one is no number."""
    kinds = set(map(type, values))
    if kinds == {Plain}:
        return text_numbers(values)
    if not kinds <= {int, float}:
        return None
    try:
        return np.array(values, dtype=float)
    except OverflowError:
        return None


def name_fault(value: object) -> str | None:
    """Return why a value cannot be a name, or None where it can."""
    if isinstance(value, int) and not isinstance(value, bool):
        return None
    if not isinstance(value, str):
        return f"must be a name, got {found(value)}"
    if not value:
        return "a name must not be empty"
    if len(value) > NAME_LENGTH:
        return f"a name has at most {NAME_LENGTH} characters, got {len(value)}"
    bad = re.search(_NOT_IN_NAMES, value)
    return f"a name may not contain the character U+{ord(bad.group()):04X}" if bad else None


def name(findings: Findings, where: Where, value: object, at_key: bool = False) -> str | None:
    """Return a name: any text of printable characters; whole numbers from JSON count as text."""
    if isinstance(value, str) and 0 < len(value) <= NAME_LENGTH and value.isprintable():
        return str(value)
    fault = name_fault(value)
    if fault:
        (findings.add_key if at_key else findings.add)(where, fault)
        return None
    return str(value)


def mapping(findings: Findings, where: Where, value: object, content: str) -> dict[str, Any] | None:
    """Return a mapping; `content` says in the message what it holds."""
    if isinstance(value, dict):
        return value
    findings.add(where, f"must be a mapping {content}, got {found(value)}")
    return None


def one_of(
    findings: Findings, where: Where, value: object, allowed: tuple[str, ...], explained: str
) -> str | None:
    """Return one of a few allowed words."""
    if isinstance(value, str) and value in allowed:
        return str(value)
    hint = findings.hint(value, allowed) if isinstance(value, str) else ""
    findings.add(where, f"must be {explained}, got {found(value)}{hint}")
    return None


def option_value(value: object) -> object:
    """Return a number where the text of an option is one, else the value as it is."""
    if isinstance(value, Plain) and _NUMBER.fullmatch(value):
        return int(value) if value.lstrip("+-").isdigit() and len(value) < 16 else float(value)
    if isinstance(value, int) and abs(value) > 2**63:
        return _as_double(value)
    return str(value)[:60] if isinstance(value, str) else value
