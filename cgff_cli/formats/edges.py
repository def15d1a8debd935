"""A CSV list of edges beside a CSV list of nodes."""

from collections.abc import Mapping
from typing import Any

from cgff_cli.errors import SceneError
from cgff_cli.formats.draft import Asked, Draft
from cgff_cli.scene.elements import rules
from cgff_cli.scene.findings import NOWHERE, Findings, quoted
from cgff_cli.scene.nodes import Nodes, nodes_of_table
from cgff_cli.scene.scene import KINDS
from cgff_cli.scene.tables import Table, open_table

_WHAT = "this list of edges"
_NO_NODES = "needs its nodes: give --nodes FILE.csv with columns name,x,y[,z]"
_ENDS = ("start", "end")
_OWN = ("group", "kind", "EA", "rest_length")


def read_edges(text: str, path: str, given: Asked) -> Draft:
    """Return what a table of edges and one of nodes say; raises SceneError, and OptionError for what it asks.

    Columns start and end; group, kind, EA and rest_length where there are any.
    """
    table, beside = Table(text), Findings()
    can_be_read = _has_ends(table)
    law, kinds = given.told(_WHAT, **_untold(table, can_be_read), lacking="" if given.nodes else _NO_NODES)
    nodes_table = open_table(beside, ("nodes",), "nodes", str(given.nodes), "")
    nodes = nodes_of_table(nodes_table) if nodes_table else None
    draft = Draft(path, law)
    draft.files.append(str(given.nodes))
    if can_be_read:
        _take_edges(draft, table, nodes, given, kinds)
    problems = table.findings.problems(path, table.place) + beside.problems(path, lambda *_: NOWHERE)
    if problems:
        raise SceneError(problems)
    return draft


def _has_ends(table: Table) -> bool:
    """Record what is wrong with header and rows; return whether columns can be read, two of them the ends."""
    header = table.header
    missing = [name for name in _ENDS if name not in header]
    if missing:
        table.add(-1, 0, f"the first line must name the columns, missing: {', '.join(missing)}")
    for i, name in enumerate(header):
        if name in header[:i] and name in (*_ENDS, *_OWN):
            table.add(-1, i, f"column {quoted(name)} stands here twice")
    for row, cells in table.ragged.items():
        message = f"this row has {cells} cells, the header has {len(header)}"
        table.add(row, min(cells - 1, len(header)), message, alike=message)
    table.findings.closed.update(table.ragged)
    if not table.count and not missing:
        table.add(-1, 0, "the table has no rows")
    return not missing and len(set(header)) == len(header) and table.count > 0


def _untold(table: Table, can_be_read: bool) -> dict[str, Any]:
    """Return what a table does not say: groups without a kind, and EA; and the kinds that it has."""
    if not can_be_read:
        return {"groups": (), "EA": False}
    kinds = table.column("kind").values if "kind" in table.header else ()
    return {"groups": () if kinds else _groups(table), "kinds": kinds, "EA": "EA" not in table.header}


def _groups(table: Table) -> list[str]:
    return list(table.column("group").values) if "group" in table.header else ["elements"] * table.count


def _take_edges(
    draft: Draft, table: Table, nodes: Nodes | None, given: Asked, told: Mapping[str, str]
) -> None:
    columns = {name: table.column(name) for name in (*_ENDS, *_OWN) if name in table.header}
    numbers = {
        name: columns[name].numbers(rule) for name, rule in rules(draft.law).items() if name in columns
    }
    for row, kind in enumerate(columns["kind"].values if "kind" in columns else ()):
        if kind not in KINDS:
            columns["kind"].add(row, f"must be cable or strut, got {quoted(kind)}", alike=kind)
    if nodes is None or nodes.coordinates is None:
        return
    for name in _ENDS:
        nodes.rows_of(columns[name])
    nodes.report_strangers(table.findings)
    if not table.findings.none:
        return
    for name, point in zip(nodes.rows, nodes.coordinates.tolist(), strict=True):
        draft.node(name, point, NOWHERE)
    groups = _groups(table)
    kinds = list(columns["kind"].values) if "kind" in columns else [told[group] for group in groups]
    ends = zip(columns["start"].values, columns["end"].values, strict=True)
    EA, rest = numbers.get("EA"), numbers.get("rest_length")
    for row, (start, end) in enumerate(ends):
        k = given.stiffness_of(kinds[row]) if EA is None else float(EA[row])
        at = table.place((row, "start"))
        l0 = None if rest is None else float(rest[row])
        draft.element(groups[row], kinds[row], (start, end), at, k, l0)
    draft.assumed.append("law, and EA and kinds where the table has none, are those given to cgff convert")
    others = [name for name in table.header if name not in columns]
    draft.lost += [f"the columns {', '.join(map(quoted, others))}"] * bool(others)
