"""Structures of structures, as NTRT lays them out: each turned, scaled and moved, then joined to others."""

from collections.abc import Iterator, Sequence

import numpy as np

from cgff_cli.errors import Problem, SceneError
from cgff_cli.formats.draft import Draft
from cgff_cli.formats.ntrt_file import DEFAULT_BUILDERS, Attributes, Bond, Builder, NtrtFile
from cgff_cli.formats.yaml_values import beside, open_source
from cgff_cli.scene.findings import Where, first_few, quoted

MOST_LAID_OUT = 300_000
"""Structures, nodes and pairs that one file may stand for: files that name each other multiply."""

_DEEPEST = 20


class _Structure:
    """A structure laid out: its nodes by name, rows of all; and the range of rows that is its own."""

    def __init__(self, first: int):
        self.first = self.end = first
        self.nodes: dict[str, int] = {}
        self.children: dict[str, _Structure] = {}

    def found(self, path: str) -> list[int]:
        """Return the rows of the nodes that a path names: a.b.node, or node alone where it stands nearest."""
        *steps, name = path.split(".")
        level: list[_Structure] = [self]
        for step in steps:
            level = [own.children[step] for own in level if step in own.children]
        while level:
            rows = [own.nodes[name] for own in level if name in own.nodes]
            if rows:
                return rows
            level = [child for own in level for child in own.children.values()]
        return []


class Layout:
    """All structures of a file: nodes by name, points (n, 3), and the pairs between them."""

    def __init__(self, draft: Draft):
        self.draft = draft
        self.names: list[str] = []
        self.points: list[list[float]] = []
        self.pairs: list[tuple[str, str, int, int, NtrtFile, Where]] = []
        self.builders: list[Builder] = list(DEFAULT_BUILDERS)
        self.files: dict[str, NtrtFile | None] = {}
        self.size = 0

    def lay(self, file: NtrtFile, prefix: str, above: Sequence[str]) -> _Structure:
        """Lay out a file's structure, children first; above: the files it stands in."""
        own = _Structure(len(self.points))
        self._count(file, 1 + len(file.nodes))
        for attributes in file.substructures:
            for name in attributes.names if attributes.path is not None else ():
                if name in own.children:
                    message = f"substructure {quoted(name)} is given a path twice"
                    file.source.findings.add_key(attributes.where, message)
                child = self._child(file, attributes, above)
                if child is not None:
                    own.children[name] = self.lay(child, f"{prefix}{name}.", (*above, child.source.path))
        for attributes in file.substructures:
            self._check_children(file, attributes, own)
        self._place(own, file.substructures)
        for name, point in file.nodes.items():
            own.nodes[name] = len(self.points)
            self.names.append(prefix + name)
            self.points.append(list(point))
            if not prefix:
                self.draft.places["nodes", name] = file.marks[name]
        own.end = len(self.points)
        self.builders += file.builders
        for bond in file.bonds:
            self._join(own, file, bond)
        return own

    def _count(self, file: NtrtFile, more: int) -> None:
        """Count what is laid out; raises SceneError where it is too much."""
        self.size += more
        if self.size > MOST_LAID_OUT:
            message = f"substructures stand for more than {MOST_LAID_OUT} structures, nodes and pairs"
            at = file.source.document.place(("substructures",), True)
            raise SceneError([Problem(file.source.path, *at, message)])

    def _child(self, file: NtrtFile, attributes: Attributes, above: Sequence[str]) -> NtrtFile | None:
        path = beside(file.source.path, str(attributes.path))
        where = (*attributes.where, "path")
        if path in above or len(above) > _DEEPEST:
            message = f"{quoted(path)} holds itself" if len(above) <= _DEEPEST else "nested too deep"
            file.source.findings.add(where, message)
            return None
        if path not in self.files:
            source = open_source(path, file.source, where)
            self.files[path] = NtrtFile(source) if source and source.document.whole else None
        return self.files[path]

    def _check_children(self, file: NtrtFile, attributes: Attributes, own: _Structure) -> None:
        pathless = [
            name
            for name in attributes.names
            if name not in own.children and all(name not in a.names or not a.path for a in file.substructures)
        ]
        for name in pathless:
            file.source.findings.add_key(attributes.where, f"substructure {quoted(name)} has no path")

    def _place(self, own: _Structure, substructures: Sequence[Attributes]) -> None:
        """Move children: all rotations first, then entry by entry scale, offset times index, translation."""
        for _, child, attributes in _each(own, substructures):
            if attributes.rotation is not None and child.end > child.first:
                axis, degrees, reference = attributes.rotation
                X = np.array(self.points[child.first : child.end])
                centre = X.mean(axis=0) if reference is None else np.array(reference)
                self.points[child.first : child.end] = (
                    (X - centre) @ _turn(axis, degrees).T + centre
                ).tolist()
        for index, child, attributes in _each(own, substructures):
            if child.end > child.first and attributes.moves:
                X = np.array(self.points[child.first : child.end])
                centre = X.mean(axis=0)
                X = (X - centre) * attributes.scale + centre if attributes.scale is not None else X
                X = X + index * np.array(attributes.offset or [0.0] * 3)
                X = X + np.array(attributes.translation or [0.0] * 3)
                self.points[child.first : child.end] = X.tolist()

    def _join(self, own: _Structure, file: NtrtFile, bond: Bond) -> None:
        """Keep the pairs of a group, or those between each two neighbours of a row."""
        if not bond.row:
            self._pairs(file, bond, (own, own), "")
        for a, b in zip(bond.row, bond.row[1:], strict=False):
            strangers = [name for name in (a, b) if name not in own.children]
            for name in strangers:
                where = (*bond.pairs[0][2][:-1],) if bond.pairs else ("bond_groups",)
                hint = file.source.findings.hint(name, own.children)
                file.source.findings.add_key(where, f"there is no substructure {quoted(name)}{hint}")
            if not strangers:
                self._pairs(file, bond, (own.children[a], own.children[b]), f" {a} {b} {a}/{b}")

    def _pairs(self, file: NtrtFile, bond: Bond, sides: tuple[_Structure, _Structure], more: str) -> None:
        self._count(file, len(bond.pairs))
        for a, b, where in bond.pairs:
            rows = [
                self._row(side, file, name, (*where, i))
                for i, (side, name) in enumerate(zip(sides, (a, b), strict=True))
            ]
            if rows[0] is not None and rows[0] == rows[1]:
                file.source.findings.add(where, f"node {quoted(a)} is joined to itself")
            elif rows[0] is not None and rows[1] is not None:
                self.pairs.append((bond.tags, bond.tags + more, rows[0], rows[1], file, where))

    def _row(self, side: _Structure, file: NtrtFile, name: str, where: Where) -> int | None:
        rows = side.found(name)
        if len(rows) == 1:
            return rows[0]
        if rows:
            which = first_few([self.names[row] for row in rows])
            file.source.findings.add(where, f"node {quoted(name)} may be each of {which}; write which")
        else:
            hint = file.source.findings.hint(name, side.nodes)
            file.source.findings.add(where, f"node {quoted(name)} is not defined{hint}")
        return None


def _each(own: _Structure, entries: Sequence[Attributes]) -> Iterator[tuple[int, _Structure, Attributes]]:
    """Yield every child that an entry speaks of, with its place in the entry's row."""
    for attributes in entries:
        for index, name in enumerate(attributes.names):
            if name in own.children:
                yield index, own.children[name], attributes


def _turn(axis: Sequence[float], degrees: float) -> np.ndarray:
    """Return the (3, 3) rotation about an axis by an angle, right-handed (Rodrigues)."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    K = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * (K @ K)
