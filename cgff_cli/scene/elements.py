"""Groups of elements while a scene is being read: kind, EA, rest lengths and node pairs."""

from itertools import chain

import numpy as np

from cgff_cli.scene import fields
from cgff_cli.scene.fields import found
from cgff_cli.scene.findings import Findings, Where, quoted
from cgff_cli.scene.keys import check_keys
from cgff_cli.scene.located import Plain
from cgff_cli.scene.nodes import Nodes
from cgff_cli.scene.scene import KINDS, Group

GROUP_KEYS = ("kind", "EA", "rest_length", "pairs")
_PAIRS = "a list of node pairs such as [[a, b], [b, c]]"


def least(law: str | None) -> dict[str, str]:
    """Return the lower limits of EA and rest length; law `hooke` divides by the rest length."""
    return {"EA": "> 0", "rest_length": "> 0" if law == "hooke" else ">= 0"}


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
    groups = []
    for key, group in values.items():
        fields.name(findings, ("elements", key), key, at_key=True)
        if not outside or isinstance(group, dict):
            groups.append(_group(findings, ("elements", key), group, nodes, law))
    good = [group for group in groups if group is not None]
    return good if groups and len(good) == len(values) else None


def _group(
    findings: Findings, where: Where, value: object, nodes: Nodes | None, law: str | None
) -> Group | None:
    values = fields.mapping(findings, where, value, f"with the keys {', '.join(GROUP_KEYS)}")
    if values is None:
        return None
    check_keys(findings, where, values, GROUP_KEYS, dict.fromkeys(GROUP_KEYS, ""))
    kind = count = pairs = None
    if "kind" in values:
        kind = fields.one_of(findings, (*where, "kind"), values["kind"], KINDS, "cable or strut")
    if "pairs" in values:
        count, pairs = _pairs(findings, (*where, "pairs"), values["pairs"], nodes)
    columns = [
        _column(findings, (*where, key), values[key], count, lower)
        for key, lower in least(law).items()
        if key in values
    ]
    good = [column for column in columns if column is not None]
    if kind is None or pairs is None or len(good) < len(least(law)):
        return None
    return Group(str(where[-1]), kind, pairs, good[0], good[1])


def _column(
    findings: Findings, where: Where, value: object, count: int | None, lower: str
) -> np.ndarray | None:
    """Return one number per pair, from one number or a list."""
    if not isinstance(value, list):
        number = fields.number(findings, where, value, lower)
        return None if number is None or count is None else np.full(count, number)
    numbers = fields.numbers(findings, where, value, lower)
    if count is not None and len(value) != count:
        message = f"must be one number or a list of {count}, one per pair, got {found(value)}"
        findings.add(where, message, alike=(where[:-1], len(value)))
        return None
    return numbers


def _pairs(
    findings: Findings, where: Where, value: object, nodes: Nodes | None
) -> tuple[int | None, np.ndarray | None]:
    """Return how many pairs were written, and their (m, 2) node rows where all are right."""
    if not isinstance(value, list):
        findings.add(where, f"must be {_PAIRS}, got {found(value)}")
        return None, None
    if not value:
        findings.add(where, "must hold at least one pair, got an empty list")
        return None, None
    if not any(isinstance(pair, (list, dict)) for pair in value):
        findings.add(where, f"must be {_PAIRS}, got a list of {len(value)} names")
        return None, None
    if nodes and set(map(type, value)) == {list} and set(map(len, value)) == {2}:
        ends = list(chain.from_iterable(value))
        rows = nodes.look_up(ends) if set(map(type, ends)) <= {str, Plain} else None
        if rows is not None and np.all(rows[::2] != rows[1::2]):
            return len(value), rows.reshape(-1, 2)
    read = [_pair(findings, (*where, i), pair, nodes) for i, pair in enumerate(value)]
    return len(value), None if None in read else np.array(read, dtype=np.intp)


def _pair(findings: Findings, where: Where, value: object, nodes: Nodes | None) -> tuple[int, int] | None:
    if not isinstance(value, list) or len(value) != 2:
        findings.add(where, f"must be two node names, got {found(value)}", alike=(where[:-1], found(value)))
        return None
    names = [fields.name(findings, (*where, i), end) for i, end in enumerate(value)]
    if names[0] is not None and names[0] == names[1]:
        findings.add(where, f"node {quoted(names[0])} is joined to itself")
        return None
    if nodes is None or None in names:
        return None
    start, end = (nodes.row(findings, (*where, i), name) for i, name in enumerate(names))
    return None if start is None or end is None else (start, end)
