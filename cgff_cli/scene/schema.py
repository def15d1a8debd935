"""Plain values -> Scene: what a scene may say, block by block."""

import os.path
from collections.abc import Collection
from functools import partial
from itertools import chain
from typing import Any

from cgff_cli.hints import meant_or_all, nearest
from cgff_cli.options import OPTIONS
from cgff_cli.scene import elements, fields, nodes, physics
from cgff_cli.scene.fields import CellColumn, is_absent
from cgff_cli.scene.findings import Findings, quoted
from cgff_cli.scene.keys import Holed, check_keys, is_own, lost
from cgff_cli.scene.nodes import Nodes
from cgff_cli.scene.scene import LAWS, Group, Scene

_ACTING = ("supports", "loads", "gravity", "load_cases", "combinations")
SCENE_KEYS = ("name", "law", "nodes", "elements", *_ACTING, "solver")
OPTION_RULES = {name: option.metadata["rule"] for name, option in OPTIONS.items()}
_BLOCKS = ("nodes", "elements", "supports", "loads", "load_cases", "combinations")
_LAWS_EXPLAINED = "paper (force = EA (l - l0)) or hooke (force = EA (l - l0) / l0)"
_REQUIRED = {
    "law": f"; it must be {_LAWS_EXPLAINED}",
    "nodes": "; it maps node names to coordinates, or names a .csv file",
    "elements": "; it maps group names to groups, or names a .csv file",
}


def read_scene(findings: Findings, value: object, path: str, base: str) -> Scene | None:
    """Return the scene that plain values describe, or None where they hold a problem.

    `base` is the directory that names of CSV files are relative to.
    """
    values = _of_a_scene(findings, value, path)
    if values is None:
        return None
    values = _without_sunken(findings, _without_spilt(findings, values, SCENE_KEYS), SCENE_KEYS)
    known = check_keys(findings, (), values, SCENE_KEYS, _REQUIRED)
    law = None
    if "law" in values:
        law = fields.one_of(findings, ("law",), values["law"], LAWS, _LAWS_EXPLAINED)
    read = partial(_block, findings, values, base)
    points: Nodes | None = read("nodes", nodes.read_nodes, nodes.nodes_of_table)
    groups = read("elements", elements.read_elements, elements.groups_of_table, points, law)
    supports, loads, gravity, cases, combinations = _acting(findings, values, points, base, known)
    solver = _solver(findings, values.get("solver"))
    name = _name(findings, values.get("name"), path)
    if points is None:
        return None
    points.report_strangers(findings)
    if points.coordinates is None or groups is None or supports is None or loads is None:
        return None
    if known and not findings.faults:
        _check_use(points, groups, {*supports, *loads, *chain.from_iterable((cases or {}).values())})
    if law is None or cases is None or combinations is None or not findings.none:
        return None
    names = tuple(points.rows)
    pairs = physics.all_pairs(groups)
    labels = physics.component_labels(len(names), pairs)
    d = points.coordinates.shape[1]
    physics.check_weight(findings, names, labels, supports, groups, gravity or (*[0.0] * (d - 1), -1.0))
    for where, own in ((("loads",), loads), *((("load_cases", name), own) for name, own in cases.items())):
        physics.check_net_loads(findings, where, names, labels, supports, own)
    said = physics.warnings(names, d, groups, labels, supports, gravity)
    X, files = points.coordinates, tuple(dict.fromkeys(findings.tables))
    return Scene(
        *(name, law, names, X, tuple(groups), supports, loads, solver, path, said, files),
        gravity=gravity,
        load_cases=cases,
        combinations=combinations,
        own={key: entry for key, entry in values.items() if is_own(key)},
        notes=tuple(dict.fromkeys(findings.notes)),
    )


def _acting(
    findings: Findings, values: dict[str, Any], points: Nodes | None, base: str, known: bool
) -> tuple[Any, ...]:
    """Return supports, loads, gravity, load cases and combinations, None for what is wrong."""
    if not any(key in values for key in _ACTING):
        return {}, {}, None, {}, {}
    from cgff_cli.scene import actions

    blocks = {key: actions.ActionBlock(findings, (key,), values.get(key), points, base) for key in _ACTING}
    return (
        actions.read_supports(blocks["supports"]),
        actions.read_loads(blocks["loads"]),
        actions.read_gravity(blocks["gravity"]),
        actions.read_cases(blocks["load_cases"]),
        actions.read_combinations(blocks["combinations"], values.get("load_cases"), known),
    )


def _of_a_scene(findings: Findings, value: object, path: str) -> dict[str, Any] | None:
    """Return a mapping that is not the file of another program."""
    values = fields.mapping(findings, (), value, "with law, nodes and elements")
    if values is None or "law" in values or "elements" in values:
        return values
    from cgff_cli.scene.foreign import how_to_convert

    stranger = how_to_convert(values, path)
    if stranger is not None:
        findings.add((), stranger)
        return None
    return values


def _without_spilt(findings: Findings, values: dict[str, Any], keys: Collection[str]) -> dict[str, Any]:
    """Take out empty blocks with the unknown keys behind them, which were meant to stand inside."""
    spilt: dict[str, list[str]] = {}
    block = ""
    for key, value in values.items():
        if key in keys or (block and block not in spilt and nearest(key, keys)):
            block = key if key in _BLOCKS and is_absent(value) else ""
        elif block:
            spilt.setdefault(block, []).append(key)
    for block, inside in spilt.items():
        message = f"nothing belongs to {block}: indent what follows, from {quoted(inside[0])}"
        findings.add_key((block,), message)
    return _without(values, {*spilt, *chain.from_iterable(spilt.values())}, len(spilt))


def _without_sunken(findings: Findings, values: dict[str, Any], keys: Collection[str]) -> dict[str, Any]:
    """Take out keys of the scene that were indented into the block before them."""
    for block in _BLOCKS:
        inside = values.get(block)
        if isinstance(inside, dict):
            sunken = [key for key in keys if key not in values and _is_block(inside.get(key))]
            for key in sunken:
                findings.add_key((block, key), f"{key} belongs to the scene itself: indent it less")
            if sunken:
                values = Holed({**values, block: _without(inside, sunken)}, lost(values) + len(sunken))
    return values


def _is_block(value: object) -> bool:
    """Return whether a value is a mapping, and not a group of elements that has the name of a block."""
    return isinstance(value, dict) and not set(value) & set(elements.GROUP_KEYS)


def _without(values: dict[str, Any], gone: Collection[str], more_lost: int = 0) -> dict[str, Any]:
    if not gone:
        return values
    return Holed({key: value for key, value in values.items() if key not in gone}, lost(values) + more_lost)


def _name(findings: Findings, value: object, path: str) -> str:
    if is_absent(value):
        return os.path.splitext(os.path.basename(path))[0].strip("<>") or "scene"
    text = value.rstrip("\n") if type(value) is str else value
    return CellColumn(findings, [text], lambda _: ("name",)).names()[0] or ""


def _block(findings: Findings, values: dict[str, Any], base: str, key: str, *readers: Any) -> Any:
    """Return what a block is read as; readers: of a mapping, of a table, then what both are told besides."""
    of_values, of_table, *known = readers
    if key not in values:
        return None
    if not fields.is_table(values[key]):
        return of_values(findings, values[key], *known)
    from cgff_cli.scene.tables import open_table

    table = open_table(findings, (key,), key, values[key], base)
    return of_table(table, *known) if table else None


def _solver(findings: Findings, value: object) -> dict[str, object]:
    """Return the solve options a scene asks for, each checked like a command-line flag."""
    values = fields.optional(findings, ("solver",), value, "of solve options to values") or {}
    for key in [key for key in values if key not in OPTIONS]:
        findings.add_key(("solver", key), f"unknown solve option {key!r}{meant_or_all(key, OPTIONS)}")
    return fields.ruled(findings, ("solver",), values, OPTION_RULES)


def _check_use(points: Nodes, groups: list[Group], used: Collection[int]) -> None:
    """Record nodes that no element joins and nothing else uses."""
    names = list(points.rows)
    for row in physics.isolated_nodes(len(names), physics.all_pairs(groups)).tolist():
        if row not in used:
            message = f"no element joins node {quoted(names[row])}, and no support or load uses it"
            points.names.add(row, message, bare=True)
