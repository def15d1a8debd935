"""Groups of elements while a scene is being read: kind, EA, rest lengths and node pairs."""

from collections.abc import Callable, Mapping, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any

import numpy as np

from cgff_cli.scene import fields
from cgff_cli.scene.fields import CellColumn, found
from cgff_cli.scene.findings import Findings, Where, quoted
from cgff_cli.scene.keys import check_keys, is_own
from cgff_cli.scene.laws import check_pull, checked_rest_lengths, rules
from cgff_cli.scene.nodes import Nodes
from cgff_cli.scene.scene import KINDS, Group
from cgff_cli.values import Rule

if TYPE_CHECKING:
    from cgff_cli.scene.tables import Table

GROUP_KEYS = ("kind", "EA", "rest_length", "pretension", "weight", "pairs")
_LENGTHS = ("rest_length", "pretension")
"""A group has one of these, in a geometry none."""
_PAIRS = "a list of node pairs such as [[a, b], [b, c]]"


def read_elements(
    findings: Findings, value: object, nodes: Nodes | None, law: str | None
) -> list[Group] | None:
    """Return the groups of a mapping; None where any of them is wrong."""
    content = "of group names to groups, or the name of a .csv file"
    values = fields.mapping(findings, ("elements",), value, content)
    if values is None:
        return None
    if not values:
        findings.add(("elements",), "must hold at least one group, got none", at_key=True)
    outside = [key for key, group in values.items() if key in GROUP_KEYS and not isinstance(group, dict)]
    if outside:
        message = f"{outside[0]} is a key of a group: indent it below the name of its group"
        findings.add_key(("elements", outside[0]), message)
    keys = list(values)
    CellColumn(findings, keys, lambda row: ("elements", keys[row]), at_key=True).names()
    given = {key for group in values.values() if isinstance(group, dict) for key in group}
    is_geometry = "EA" in given and not given.intersection(_LENGTHS)
    groups = [
        _group(findings, ("elements", key), group, nodes, law, is_geometry)
        for key, group in values.items()
        if not outside or isinstance(group, dict)
    ]
    good = [group for group in groups if group is not None]
    return good if groups and len(good) == len(values) else None


def _group(
    findings: Findings, where: Where, value: object, nodes: Nodes | None, law: str | None, is_geometry: bool
) -> Group | None:
    """Return a group; None where anything of it is wrong."""
    values = fields.mapping(findings, where, value, f"with the keys {', '.join(GROUP_KEYS)}")
    if values is None:
        return None
    optional = _LENGTHS if is_geometry or "pretension" in values else _LENGTHS[1:]
    required = [key for key in GROUP_KEYS if key not in (*optional, "weight")]
    said = {"rest_length": ", or 'pretension' in its place"}
    check_keys(findings, where, values, GROUP_KEYS, {key: said.get(key, "") for key in required})
    kind = count = pairs = None
    if "kind" in values:
        kind = fields.one_of(findings, (*where, "kind"), values["kind"], KINDS, "cable or strut")
    if "pairs" in values:
        count, pairs = _pairs(findings, (*where, "pairs"), values["pairs"], nodes)
    columns = {
        key: _column(findings, (*where, key), values[key], count, rule)
        for key, rule in rules(law).items()
        if key in values
    }
    if all(key in values for key in _LENGTHS):
        findings.add_key((*where, "pretension"), "a group has rest_length or pretension, not both")
        return None
    at, one_each = (*where, "pretension"), isinstance(values.get("pretension"), list)

    def tell(row: int, message: str) -> None:
        findings.add((*at, row) if one_each else at, message)

    t = columns.get("pretension")
    if t is not None and check_pull(t if one_each else t[:1], kind == "cable", tell):
        return None
    if kind is None or pairs is None or (not is_geometry and not any(key in columns for key in _LENGTHS)):
        return None
    own = {key: entry for key, entry in values.items() if is_own(key)}
    read = _completed(columns, pairs, nodes, law, tell, not one_each)
    return None if read is None else Group(str(where[-1]), kind, pairs, own=own, **read)


def _completed(
    columns: Mapping[str, np.ndarray | None],
    pairs: np.ndarray,
    nodes: Nodes | None,
    law: str | None,
    tell: Callable[[int, str], None],
    is_one: bool = False,
) -> dict[str, Any] | None:
    """Return the numbers of elements with their rest lengths, NaN in a geometry; None where any is wrong.

    is_one: one pretension stands for all, and is wrong once
    """
    read = {key: column for key, column in columns.items() if column is not None}
    if len(read) < len(columns) or "EA" not in read:
        return None
    t = read.get("pretension")
    if t is None:
        return read if "rest_length" in read else {"rest_length": np.full_like(read["EA"], np.nan), **read}
    if nodes is None or nodes.coordinates is None or law is None:
        return None
    X = nodes.coordinates
    l = np.linalg.norm(X[pairs[:, 0]] - X[pairs[:, 1]], axis=1)
    names = list(nodes.rows)

    def told(row: int, message: str) -> None:
        ends = " and ".join(quoted(names[end]) for end in pairs[row].tolist())
        tell(row, message.format(ends))

    rest = checked_rest_lengths(law, l, t, read["EA"], told, is_one)
    return None if rest is None else {**read, "rest_length": rest}


def _column(
    findings: Findings, where: Where, value: object, count: int | None, rule: Rule
) -> np.ndarray | None:
    """Return one number per pair, from one number or a list."""
    if not isinstance(value, list):
        number = CellColumn(findings, [value], lambda _: where).numbers(rule)
        return None if number is None or count is None else np.full(count, number)
    numbers = CellColumn(findings, value, lambda i: (*where, i)).numbers(rule)
    if count is not None and len(value) != count:
        message = f"must be one number or a list of {count}, one per pair, got {found(value)}"
        findings.add(where, message, alike=(where[:-1], len(value)))
        return None
    return numbers


def _pairs(
    findings: Findings, where: Where, value: object, nodes: Nodes | None
) -> tuple[int | None, np.ndarray | None]:
    """Return how many pairs were written, and their (m, 2) node rows where all are right."""
    got = f"got {found(value)}"
    if isinstance(value, list) and not value:
        findings.add(where, "must hold at least one pair, got an empty list")
        return None, None
    if not isinstance(value, list) or not any(isinstance(pair, (list, dict)) for pair in value):
        names = " names" if isinstance(value, list) else ""
        findings.add(where, f"must be {_PAIRS}, {got}{names}")
        return None, None
    odd = {i for i, pair in enumerate(value) if type(pair) is not list or len(pair) != 2}
    for i in odd:
        alike = (where, found(value[i]))
        findings.add((*where, i), f"must be two node names, got {found(value[i])}", alike=alike)
    good: Sequence[int] = [i for i in range(len(value)) if i not in odd] if odd else range(len(value))
    ends = list(chain.from_iterable(value[i] for i in good) if odd else chain.from_iterable(value))
    rows = _joined(CellColumn(findings, ends, lambda k: (*where, good[k // 2], k % 2)), nodes)
    return len(value), None if odd else rows


def groups_of_table(table: "Table", nodes: Nodes | None, law: str | None) -> list[Group] | None:
    """Return the groups of a table, in order of first appearance; None where a cell is wrong."""
    sides = ("start", "end")
    ends = [""] * (2 * table.count)
    for i, side in enumerate(sides):
        ends[i::2] = table.column(side).values
    cells = CellColumn(table.findings, ends, lambda k: (k // 2, sides[k % 2]), cells=True)
    pairs = _joined(cells, nodes)
    columns = {key: table.column(key) for key in rules(law) if key in table.header}
    numbers = {key: column.numbers(rules(law)[key]) for key, column in columns.items()}
    groups, kinds = table.column("group"), table.column("kind")
    groups.names()
    _check_kinds(groups.values, kinds)
    if all(key in columns for key in _LENGTHS):
        message = "elements have rest_length or pretension, not both"
        table.add(-1, table.header.index("pretension"), message)
    t = numbers.get("pretension")
    if t is not None:
        check_pull(t, np.array(kinds.values) == "cable", columns["pretension"].add)
    if pairs is None or not table.findings.none:
        return None
    tell = columns["pretension"].add if "pretension" in columns else lambda row, message: None
    read = _completed(numbers, pairs, nodes, law, tell)
    return None if read is None else _split(groups.values, kinds.values, pairs, read)


def _check_kinds(groups: Sequence[str], kinds: CellColumn) -> None:
    """Record every kind of a table that is none, or another than that of its group above."""
    uses = set(zip(groups, kinds.values, strict=True))
    if len(uses) == len({group for group, _ in uses}) and {kind for _, kind in uses} <= set(KINDS):
        return
    of_group: dict[str, str] = {}
    for row, (group, kind) in enumerate(zip(groups, kinds.values, strict=True)):
        if kind not in KINDS:
            message = f"must be cable or strut, got {quoted(kind) if kind else 'nothing'}"
            kinds.add(row, message, alike=message)
        elif of_group.setdefault(group, kind) != kind:
            message = f"group {quoted(group)} is of kind {of_group[group]} above, here {kind}"
            kinds.add(row, message, bare=True)


def _split(
    groups: Sequence[str], kinds: Sequence[str], pairs: np.ndarray, read: Mapping[str, Any]
) -> list[Group]:
    """Return the rows of a table by group."""
    order = {group: code for code, group in enumerate(dict.fromkeys(groups))}
    codes = np.fromiter(map(order.__getitem__, groups), np.intp, len(groups))
    rows = np.argsort(codes, kind="stable")
    ends = np.cumsum(np.bincount(codes))[:-1]
    return [
        Group(name, kinds[own[0]], pairs[own], **{key: column[own] for key, column in read.items()})
        for name, own in zip(order, np.split(rows, ends), strict=True)
    ]


def _joined(ends: CellColumn, nodes: Nodes | None) -> np.ndarray | None:
    """Return the (m, 2) node rows of start, end, start, end; None where one is none or joined to itself."""
    rows = nodes.look_up(ends.values) if nodes else None
    names = [] if rows is not None else list(ends.names())
    twins = [i for i in range(0, len(names), 2) if names[i] == names[i + 1] and names[i] is not None]
    if rows is not None:
        twins = (2 * np.flatnonzero(rows[::2] == rows[1::2])).tolist()
    told = set(twins)
    for i in twins:
        message = f"node {quoted(str(ends.values[i]))} is joined to itself"
        if ends.cells:
            ends.add(i + 1, message, bare=True)
        else:
            ends.findings.add(ends.where(i)[:-1], message)
    if rows is None and nodes:
        for i in range(0, len(names), 2):
            if i in told or (None in names[i : i + 2] and not ends.cells):
                names[i] = names[i + 1] = None
        rows = nodes.rows_named(ends, names)
    return None if twins or rows is None else rows.reshape(-1, 2)
