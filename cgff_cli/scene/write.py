"""Scene -> YAML that reads back to the same scene, one node per line, numbers in full."""

import json
import re
from collections.abc import Iterable, Mapping

import numpy as np

from cgff_cli.scene.fields import NUMBER, Plain
from cgff_cli.scene.scene import Group, Scene

_WIDTH = 100
_PLAIN = re.compile(r"\w(?:[\w ./()+-]*[\w./()+-])?")
_PLAIN_TITLE = re.compile(r"\w(?:[\w ,./()+-]*[\w./()+-])?")


def to_yaml(scene: Scene, header: str = "", tables: tuple[str, str] | None = None) -> str:
    """Return a scene file with everything a scene says.

    header : put before it as comments
    tables : names of the CSV files that hold nodes and elements (`tables_out` has their contents); they
             become part of the scene file where None
    """
    lines = [f"# {line}".rstrip() for line in header.splitlines()]
    lines += [f"name: {_title(scene.name)}", f"law: {scene.law}"]
    names = [_word(name) for name in scene.node_names]
    if tables is not None:
        lines += [f"nodes: {_word(tables[0])}", f"elements: {_word(tables[1])}"]
    else:
        lines += _structure_lines(scene, names)
    if scene.gravity is not None:
        lines.append(f"gravity: {_flow(scene.gravity)}")
    if scene.supports:
        lines.append("supports:")
        lines += [f"  {names[row]}: {axes}" for row, axes in scene.supports.items()]
    if scene.loads:
        lines.append("loads:")
        lines += [f"  {names[row]}: {_flow(load)}" for row, load in scene.loads.items()]
    for name, loads in scene.load_cases.items():
        lines += ["load_cases:"] if name == next(iter(scene.load_cases)) else []
        lines += [f"  {name}:{'' if loads else ' {}'}"]
        lines += [f"    {names[row]}: {_flow(load)}" for row, load in loads.items()]
    if scene.combinations:
        lines.append("combinations:")
        lines += [f"  {name}: {_plain_value(factors)}" for name, factors in scene.combinations.items()]
    if scene.solver:
        lines.append("solver:")
        lines += [f"  {option}: {value}" for option, value in scene.solver.items()]
    lines += [f"{_word(key)}: {_plain_value(value)}" for key, value in scene.own.items()]
    return "\n".join(lines) + "\n"


def _structure_lines(scene: Scene, names: list[str]) -> list[str]:
    points = zip(names, scene.coordinates.tolist(), strict=True)
    lines = ["nodes:", *(f"  {name}: {_flow(point)}" for name, point in points), "elements:"]
    for group in scene.groups:
        lines += _group_lines(group, names)
    return lines


def _group_lines(group: Group, names: list[str]) -> list[str]:
    pairs = [f"[{names[start]}, {names[end]}]" for start, end in group.pairs.tolist()]
    return [
        f"  {_word(group.name)}:",
        f"    kind: {group.kind}",
        *_column("EA", group.EA),
        *_lengths(group),
        *(_column("weight", group.weight) if group.weight is not None else ()),
        *(f"    {_word(key)}: {_plain_value(value)}" for key, value in group.own.items()),
        *_wrapped("pairs", pairs),
    ]


def _lengths(group: Group) -> list[str]:
    """Return rest lengths, or the pretensions that they are to give."""
    if group.pretension is not None:
        return _column("pretension", group.pretension)
    return _column("rest_length", group.rest_length[~np.isnan(group.rest_length)])


def _plain_value(value: object) -> str:
    """Return plain values on one line, text as it was written."""
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_word(key)}: {_plain_value(own)}" for key, own in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_plain_value, value)) + "]"
    is_plain = isinstance(value, Plain) and (value in ("", "~") or _PLAIN.fullmatch(value))
    if is_plain or (isinstance(value, Plain) and NUMBER.fullmatch(value)):
        return str(value) or "null"
    return json.dumps(value, ensure_ascii=False)


def _column(key: str, numbers: np.ndarray) -> list[str]:
    if not len(numbers):
        return []
    if np.all(numbers == numbers[0]):
        return [f"    {key}: {float(numbers[0])!r}"]
    return _wrapped(key, [repr(number) for number in numbers.tolist()])


def _wrapped(key: str, items: list[str]) -> list[str]:
    """Return a list in brackets, broken where a line would be too long."""
    lines, line = [], f"    {key}: ["
    for i, item in enumerate(items):
        piece = item + ("," if i + 1 < len(items) else "]")
        if len(line) + len(piece) > _WIDTH and line.strip():
            lines.append(line.rstrip())
            line = "      "
        line += piece + " "
    return [*lines, line.rstrip()]


def _flow(numbers: Iterable[float]) -> str:
    return "[" + ", ".join(repr(float(number)) for number in numbers) + "]"


def _word(name: str) -> str:
    """Return a name as it may stand anywhere, in quotes only where YAML needs them."""
    return name if _PLAIN.fullmatch(name) else json.dumps(name, ensure_ascii=False)


def _title(name: str) -> str:
    """Return the scene's name as it may stand at the end of a line; null would mean no name."""
    plain = _PLAIN_TITLE.fullmatch(name) and name != "null"
    return name if plain else json.dumps(name, ensure_ascii=False)
