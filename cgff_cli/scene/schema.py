"""Plain values -> Scene: what a scene may say, block by block."""

import os.path
from typing import Any

from cgff_cli.errors import OptionError
from cgff_cli.options import OPTIONS, checked
from cgff_cli.scene import elements, fields, nodes, physics
from cgff_cli.scene.fields import found, is_absent
from cgff_cli.scene.findings import Findings, Where
from cgff_cli.scene.indents import well_indented
from cgff_cli.scene.keys import check_keys, lost
from cgff_cli.scene.nodes import Nodes
from cgff_cli.scene.scene import AXES, LAWS, Group, Scene

SCENE_KEYS = ("name", "law", "nodes", "elements", "supports", "loads", "solver")
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
    values = fields.mapping(findings, (), value, "with law, nodes and elements")
    if values is None:
        return None
    values = well_indented(findings, values, SCENE_KEYS)
    known = check_keys(findings, (), values, SCENE_KEYS, _REQUIRED)
    law = _law(findings, values)
    points = _nodes(findings, values, base)
    groups = _elements(findings, values, base, points, law)
    supports = _supports(findings, values.get("supports"), points)
    loads = _loads(findings, values.get("loads"), points)
    solver = _solver(findings, values.get("solver"))
    name = _name(findings, values.get("name"), path)
    if points is None:
        return None
    points.report_strangers(findings)
    if points.coordinates is None or groups is None or supports is None or loads is None:
        return None
    if known and not findings.faults:
        _check_use(points, groups, supports, loads)
    if law is None or not findings.none:
        return None
    names = tuple(points.rows)
    pairs = physics.all_pairs(groups)
    labels = physics.component_labels(len(names), pairs)
    physics.check_net_loads(findings, names, labels, supports, loads)
    said = physics.warnings(names, points.coordinates.shape[1], groups, labels, supports)
    X, files = points.coordinates, tuple(findings.tables)
    return Scene(name, law, names, X, tuple(groups), supports, loads, solver, path, said, files)


def _name(findings: Findings, value: object, path: str) -> str:
    if is_absent(value):
        return os.path.splitext(os.path.basename(path))[0].strip("<>") or "scene"
    text = value.rstrip("\n") if type(value) is str else value
    return fields.name(findings, ("name",), text) or ""


def _law(findings: Findings, values: dict[str, Any]) -> str | None:
    if "law" not in values:
        return None
    return fields.one_of(findings, ("law",), values["law"], LAWS, _LAWS_EXPLAINED)


def _nodes(findings: Findings, values: dict[str, Any], base: str) -> Nodes | None:
    if "nodes" not in values:
        return None
    value = values["nodes"]
    if not is_table(value):
        return nodes.read_nodes(findings, value)
    from cgff_cli.scene import tables

    table = tables.open_table(findings, ("nodes",), value, base)
    return tables.read_nodes(table) if table else None


def _elements(
    findings: Findings, values: dict[str, Any], base: str, points: Nodes | None, law: str | None
) -> list[Group] | None:
    if "elements" not in values:
        return None
    value = values["elements"]
    if not is_table(value):
        return elements.read_elements(findings, value, points, law)
    from cgff_cli.scene import tables

    table = tables.open_table(findings, ("elements",), value, base)
    return tables.read_elements(findings, table, points, law) if table else None


def is_table(value: object) -> bool:
    """Tell whether a value names a CSV file."""
    return isinstance(value, str) and os.path.splitext(value)[1].lower() == ".csv"


def _optional(findings: Findings, where: Where, value: object, content: str) -> dict[str, Any] | None:
    """Return a mapping that may be left out."""
    return {} if is_absent(value) else fields.mapping(findings, where, value, content)


def _supports(findings: Findings, value: object, points: Nodes | None) -> dict[int, str] | None:
    """Return node row -> axes held, in the order x, y, z; None where any is wrong."""
    axes = AXES[: points.dimension] if points and points.dimension else AXES
    supports: dict[int, str] = {}
    values = _optional(findings, ("supports",), value, "of node names to axes such as xyz or z")
    if values is None:
        return None
    for key, held in values.items():
        row = points.row(findings, ("supports", key), key, at_key=True) if points else None
        if not isinstance(held, str) or not held or not set(held) <= set(axes) or len(set(held)) < len(held):
            message = f"must be axes out of {axes}, each at most once, got {found(held)}"
            findings.add(("supports", key), message, alike=("supports", found(held)))
        elif row is not None:
            supports[row] = "".join(axis for axis in AXES if axis in held)
    return supports if len(supports) == len(values) + lost(values) else None


def _loads(findings: Findings, value: object, points: Nodes | None) -> dict[int, tuple[float, ...]] | None:
    """Return node row -> force; None where any is wrong."""
    values = _optional(findings, ("loads",), value, "of node names to forces")
    if not values:
        return None if values is None or lost(values) else {}
    forces = nodes.vectors(findings, ("loads",), values, points.dimension if points else None)
    if points is None:
        return None
    rows = [points.row(findings, ("loads", key), key, at_key=True) for key in values]
    known = [row for row in rows if row is not None]
    if forces is None or len(known) < len(rows) + lost(values):
        return None
    return dict(zip(known, map(tuple, forces.tolist()), strict=True))


def _solver(findings: Findings, value: object) -> dict[str, object]:
    """Return the solve options a scene asks for, each checked like a command-line flag."""
    values = _optional(findings, ("solver",), value, "of solve options to values")
    options: dict[str, object] = {}
    for key, setting in (values or {}).items():
        where = ("solver", key)
        if isinstance(setting, (list, dict)):
            findings.add(where, f"must be one value, got {found(setting)}")
            continue
        try:
            options[str(key)] = checked(str(key), fields.option_value(setting))
        except OptionError as error:
            if key in OPTIONS:
                findings.add(where, str(error).removeprefix(f"{key} "))
            else:
                findings.add_key(where, str(error))
    return options


def _check_use(
    points: Nodes, groups: list[Group], supports: dict[int, str], loads: dict[int, tuple[float, ...]]
) -> None:
    names = list(points.rows)
    for row in physics.isolated_nodes(len(names), physics.all_pairs(groups)).tolist():
        if row not in supports and row not in loads:
            points.report(
                row, f"no element joins node {fields.quoted(names[row])}, and no support or load uses it"
            )
