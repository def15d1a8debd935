"""One file of the NASA Tensegrity Robotics Toolkit: its blocks, each fault recorded at its place.

Keys are those of the toolkit's page "YAML Model Builder". Like the toolkit it refuses a key given twice.
"""

from typing import NamedTuple

from cgff_cli.formats.yaml_values import Pair, Source
from cgff_cli.hints import nearest
from cgff_cli.scene.fields import CellColumn, found
from cgff_cli.scene.findings import Mark, Where, quoted
from cgff_cli.scene.keys import check_keys
from cgff_cli.scene.nodes import vectors
from cgff_cli.values import Rule

BLOCKS = ("nodes", "pair_groups", "builders", "substructures", "bond_groups")
_RODS = ("tgRodInfo",)
_CABLES = (
    *("tgBasicActuatorInfo", "tgBasicContactCableInfo"),
    *("tgKinematicActuatorInfo", "tgKinematicContactCableInfo"),
)
_SIZE = Rule(positive=True, smallest=1e-30, largest=1e30)


class Builder(NamedTuple):
    """What the pairs with all of some tags become; stiffness is that of cables, force per length."""

    tags: frozenset[str]
    kind: str
    stiffness: float = 1000.0
    pretension: float = 0.0


DEFAULT_BUILDERS = (Builder(frozenset({"rod"}), "strut"), Builder(frozenset({"string"}), "cable"))
"""Builders that a file need not define, with the toolkit's stiffness and pretension of a string."""


class Bond(NamedTuple):
    """Pairs between each structure of a row and the next; of a group of pairs there is no row."""

    tags: str
    row: tuple[str, ...]
    pairs: list[Pair]


class Attributes(NamedTuple):
    """Where some structures stand: what is None was not given."""

    names: tuple[str, ...]
    where: Where
    path: str | None = None
    rotation: tuple[list[float], float, list[float] | None] | None = None
    scale: float | None = None
    offset: list[float] | None = None
    translation: list[float] | None = None

    @property
    def moves(self) -> bool:
        """Whether it scales or shifts anything."""
        return any(own is not None for own in (self.scale, self.offset, self.translation))


class NtrtFile:
    """What one file says.

    nodes    : name -> three coordinates         marks : the place of each
    builders : in order; of several that match, the last counts
    bonds    : pairs within the structure, then those between its substructures
    lost     : parameters of builders that a scene has no place for
    """

    def __init__(self, source: Source):
        self.source = source
        self.lost: set[str] = set()
        check_keys(source.findings, (), source.values, BLOCKS)
        self.nodes = self._nodes()
        self.marks = {name: source.document.place(("nodes", name)) for name in self.nodes}
        self.builders = [own for tags in source.block("builders") if (own := self._builder(tags)) is not None]
        groups = source.block("pair_groups")
        self.bonds = [
            Bond(tags, (), source.pairs(("pair_groups", tags), pairs)) for tags, pairs in groups.items()
        ]
        for key in source.block("bond_groups"):
            self.bonds += self._bonds(key)
        self.substructures = [self._attributes(key) for key in source.block("substructures")]

    def place(self, where: Where) -> Mark:
        """Return line and column of a value."""
        return self.source.document.place(where)

    def _nodes(self) -> dict[str, list[float]]:
        values = self.source.block("nodes")
        for name in values:
            if "/" in name or "." in name:
                message = f"the name {quoted(name)} may not contain . or /"
                self.source.findings.add_key(("nodes", name), message)
        names = CellColumn(self.source.findings, list(values), lambda i: ("nodes", list(values)[i]), True)
        names.names()
        read = vectors(self.source.findings, ("nodes",), values, 3) if values else None
        points = [[0.0] * 3] * len(values) if read is None else read.tolist()
        return dict(zip(values, points, strict=True))

    def _builder(self, tags: str) -> Builder | None:
        where: Where = ("builders", tags)
        values = self.source.block(*map(str, where))
        if not check_keys(self.source.findings, where, values, ("class", "parameters"), {"class": ""}):
            return None
        made = str(values["class"])
        if made not in (*_RODS, *_CABLES):
            message = (
                f"no builder of class {quoted(made)} can be converted; {', '.join((*_RODS, *_CABLES))} can"
            )
            self.source.findings.add((*where, "class"), message)
            return None
        is_rod = made in _RODS
        return Builder(
            frozenset(tags.split()), "strut" if is_rod else "cable", **self._parameters(tags, is_rod)
        )

    def _parameters(self, tags: str, is_rod: bool) -> dict[str, float]:
        """Return stiffness and pretension of a cable where they are given; what else there is, is lost."""
        where: Where = ("builders", tags, "parameters")
        ours = {} if is_rod else {"stiffness": _SIZE, "pretension": Rule(least=0.0, largest=1e30)}
        read: dict[str, float] = {}
        for key, value in self.source.block("builders", tags, "parameters").items():
            if key in ours:
                number = self.source.number((*where, key), value, ours[key])
                read[key] = 1.0 if number is None else number
            elif meant := nearest(key, ours):
                message = f"unknown parameter {quoted(key)}; did you mean {meant[0]!r}?"
                self.source.findings.add_key((*where, key), message)
            else:
                self.lost.add(key)
        return read

    def _bonds(self, key: str) -> list[Bond]:
        """Return the bonds below a key: tags hold rows, or a row holds tags; a row is one with slashes."""
        read = []
        for inner, pairs in self.source.block("bond_groups", key).items():
            where: Where = ("bond_groups", key, inner)
            slashed = [word for word in (key, inner) if "/" in word]
            if len(slashed) != 1:
                message = "one of the two keys of a bond must be tags, the other a/b/node_node"
                self.source.findings.add_key(where, message)
                continue
            *row, kind = slashed[0].split("/")
            at = where if slashed[0] == inner else where[:2]
            if kind == "node_edge":
                message = "node_edge: a node tied into the middle of a string cannot be converted"
                self.source.findings.add_key(at, message)
            elif kind != "node_node":
                self.source.findings.add_key(at, f"must end in /node_node, got {quoted(slashed[0])}")
            elif len(row) < 2:
                self.source.findings.add_key(at, "a bond joins two or more structures, as in a/b/node_node")
            else:
                tags = inner if slashed[0] == key else key
                read.append(Bond(tags, tuple(row), self.source.pairs(where, pairs)))
        return read

    def _attributes(self, key: str) -> Attributes:
        where: Where = ("substructures", key)
        source, values = self.source, self.source.block("substructures", key)
        check_keys(source.findings, where, values, ("path", "rotation", "scale", "offset", "translation"))
        path = values.get("path")
        if path is not None and (not isinstance(path, str) or not path):
            source.findings.add((*where, "path"), f"must be the name of a file, got {found(path)}")
            path = None
        steps = {
            name: source.vector((*where, name), values[name])
            for name in ("offset", "translation")
            if name in values
        }
        scale = source.number((*where, "scale"), values["scale"], _SIZE) if "scale" in values else None
        rotation = self._rotation((*where, "rotation")) if "rotation" in values else None
        return Attributes(tuple(key.split("/")), where, path, rotation, scale, **steps)

    def _rotation(self, where: Where) -> tuple[list[float], float, list[float] | None] | None:
        """Return axis, angle in degrees and reference point of a rotation; None where any is wrong."""
        values = self.source.block(*map(str, where))
        required = {"axis": "", "angle": ""}
        if not check_keys(self.source.findings, where, values, ("axis", "angle", "reference"), required):
            return None
        axis = self.source.vector((*where, "axis"), values["axis"])
        angle = self.source.number((*where, "angle"), values["angle"])
        if axis is not None and not any(axis):
            self.source.findings.add((*where, "axis"), "must not be zero in all directions")
            return None
        at = values.get("reference")
        reference = None if at is None else self.source.vector((*where, "reference"), at)
        return None if axis is None or angle is None else (axis, angle, reference)
