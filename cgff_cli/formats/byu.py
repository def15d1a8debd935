"""BYU TensegritySim YAML: nodes, connections, builders, pins. Its force is k (l - l0), law `paper`."""

from math import dist
from typing import Any

from cgff_cli.formats.draft import Asked, Draft
from cgff_cli.formats.rest import rest_length_of
from cgff_cli.formats.yaml_values import Source
from cgff_cli.hints import count
from cgff_cli.scene.elements import rules
from cgff_cli.scene.fields import CellColumn, Plain, found
from cgff_cli.scene.findings import Where, first_few, quoted
from cgff_cli.scene.keys import check_keys
from cgff_cli.scene.nodes import Nodes, read_nodes

_KEYS = ("nodes", "connections", "builders", "pin", "control")
_REQUIRED = dict.fromkeys(_KEYS[:3], "")
_KINDS = {"string": "cable", "bar": "strut"}
_LAWFUL = rules("paper")
_NO, _YES = ("false", "no", "off"), ("true", "yes", "on")
"""Words of YAML's own for a boolean, as the program that reads these files takes them."""


def read_byu(text: str, path: str, given: Asked) -> Draft:
    """Return what a BYU file says, all that a scene needs; raises SceneError with every fault."""
    source, draft = Source(text, path), Draft(path, "paper")
    if "surface" in source.values:
        message = "surface: a structure wrapped round a cylinder cannot be converted"
        source.findings.add_key(("surface",), message)
    known = {key: own for key, own in source.values.items() if key != "surface"}
    if source.document.whole:
        check_keys(source.findings, (), known, _KEYS, _REQUIRED)
    points = _points(source, draft)
    builders = {name: _builder(source, name) for name in source.block("builders")}
    for name, members in source.block("connections").items():
        if name not in builders:
            source.findings.add_key(("connections", name), f"{quoted(name)} has no builder of its name")
        elif points:
            _take_members(source, draft, points, name, members, builders[name])
    _take_pins(source, draft)
    if points:
        points.report_strangers(source.findings)
    source.refuse()
    draft.assumed += [
        "force = k (l - l0): law paper, EA is the stiffness k, a force per length",
        "a string is a cable, a bar a strut; l0 = ratio x length, or length - pretension / k",
    ]
    if source.values.get("control"):
        draft.lost.append("control: which strings change their length, and when")
    return draft


def _points(source: Source, draft: Draft) -> Nodes | None:
    """Add the nodes to a draft, plane where one of them is, as in the program."""
    values = source.block("nodes")
    if not values:
        return None
    plane = any(isinstance(point, list) and len(point) == 2 for point in values.values())
    cut = {
        name: point[:2] if plane and isinstance(point, list) and len(point) == 3 else point
        for name, point in values.items()
    }
    heights = sum(len(point) == 3 for point in values.values() if isinstance(point, list)) if plane else 0
    if heights:
        draft.lost.append(f"the third coordinate of {count(heights, 'node')}: others have two")
    nodes = read_nodes(source.findings, cut)
    if nodes is None or nodes.coordinates is None:
        return nodes
    for name, point in zip(nodes.rows, nodes.coordinates.tolist(), strict=True):
        draft.node(name, point, source.document.place(("nodes", name)))
    return nodes


def _builder(source: Source, name: str) -> dict[str, Any] | None:
    """Return kind, stiffness, ratio and pretension of a builder; None where any is wrong."""
    where: Where = ("builders", name)
    values = source.block("builders", name)
    allowed = ("type", "stiffness", "initial_length_ratio", "pretension")
    good = check_keys(source.findings, where, values, allowed, {"type": "; bar or string", "stiffness": ""})
    kind = values.get("type")
    if kind is not None and kind not in _KINDS:
        source.findings.add((*where, "type"), f"must be bar or string, got {found(kind)}")
        good = False
    if "initial_length_ratio" in values and "pretension" in values:
        message = "initial_length_ratio and pretension both say the rest length; give one"
        source.findings.add_key((*where, "pretension"), message)
    limits = {"stiffness": _LAWFUL["EA"], "initial_length_ratio": _LAWFUL["rest_length"]}
    given = {
        key: source.number((*where, key), values[key], *([limits[key]] if key in limits else []))
        for key in allowed[1:]
        if key in values
    }
    return {"kind": _KINDS[str(kind)], **given} if good and None not in given.values() else None


def _take_members(
    source: Source, draft: Draft, points: Nodes, name: str, members: object, builder: dict[str, Any] | None
) -> None:
    """Add the connections of one name; members: a list of [a, b], each with a name of its own or none."""
    where: Where = ("connections", name)
    if not isinstance(members, list):
        source.findings.add(where, f"must be a list of node pairs, got {found(members)}")
        return
    for i, entry in enumerate(members):
        own: Where = (*where, i)
        if isinstance(entry, dict) and len(entry) == 1:
            label = next(iter(entry))
            entry, own = entry[label], (*own, label)
        ends = source.names(own, entry, "two node names such as [a, b]")
        if ends is None:
            continue
        if len(ends) > 2:
            message = f"a string over {len(ends)} nodes has one force all along, which a scene cannot say"
            source.findings.add(own, message)
        elif len(ends) < 2 or ends[0] == ends[1]:
            source.findings.add(own, "must join two different nodes")
        else:
            _take_one(source, draft, points, name, (ends[0], ends[1]), own, builder)


def _take_one(
    source: Source,
    draft: Draft,
    points: Nodes,
    name: str,
    ends: tuple[str, str],
    where: Where,
    builder: dict[str, Any] | None,
) -> None:
    rows = points.rows_named(CellColumn(source.findings, ends, lambda i: (*where, i)), ends)
    if rows is None or points.coordinates is None or builder is None:
        return
    length = dist(*points.coordinates[rows].tolist())
    k, ratio = builder["stiffness"], builder.get("initial_length_ratio", 1.0)
    l0 = rest_length_of(source, where, ratio * length, builder.get("pretension", 0.0), k)
    if l0 is not None:
        draft.element(name, builder["kind"], ends, source.document.place(where), k, l0)


def _take_pins(source: Source, draft: Draft) -> None:
    """Add supports: node -> three booleans, or two; the third says nothing in the plane."""
    pins = source.block("pin")
    axes = "xyz"[: len(next(iter(draft.nodes.values()), (0, 0, 0)))]
    for name, held in pins.items():
        where: Where = ("pin", name)
        if name not in source.block("nodes"):
            hint = source.findings.hint(name, draft.nodes) or f"; defined: {first_few(draft.nodes)}"
            source.findings.add_key(where, f"node {quoted(name)} is not defined{hint}")
        words = [_boolean(word) for word in held] if isinstance(held, list) else []
        if len(words) not in (len(axes), 3) or None in words:
            source.findings.add(
                where, f"must be three booleans such as [True, True, False], got {found(held)}"
            )
            continue
        support = "".join(axis for axis, word in zip(axes, words, strict=False) if word)
        if support:
            draft.supports[name] = support


def _boolean(word: object) -> bool | None:
    text = word.lower() if isinstance(word, Plain) else None
    return None if text not in (*_NO, *_YES) else text in _YES
