"""Text -> plain values that know where they stand.

YAML is read event by event, so that nothing is guessed: a scalar stays text (`Plain` where it was
written without quotes) and the field it fills decides what it means. YAML's own types would turn
`1e-8` into text, `no` into false and `1:30` into 90.
"""

from collections.abc import Hashable, Iterable, Iterator
from itertools import chain
from typing import Any

from cgff_cli.scene.fields import Plain
from cgff_cli.scene.findings import Mark, Where, counted, label, labelled, quoted
from cgff_cli.scene.keys import Holed

DEPTH = 40
"""A scene needs five levels; deeper nesting is a mistake or an attack."""

ALIASED = 100_000
"""How many values all aliases of a file together may stand for."""

_EMPTY = "the file is empty; a scene needs at least law, nodes and elements"


class Branch:
    """Where a mapping or list starts, and its keys and members."""

    __slots__ = ("at", "keys", "members")

    def __init__(self, at: Mark):
        self.at = at
        self.keys: dict[Any, Mark] = {}
        self.members: dict[Any, Any] = {}


Tree = Mark | Branch


class FormError(Exception):
    """The text cannot be read any further."""

    def __init__(self, at: Mark, message: str):
        self.at = at
        super().__init__(message)


class Document:
    """A text's values, the place of each, and the faults of its form.

    Made of its events: the one place that knows aliases, tags, duplicates and depth.

    value  : dict, list or text; None where the text could not be read to its end
    faults : (place, message) of everything that is wrong with the form
    """

    def __init__(self, events: Iterator[Any]):
        self.value: Any = None
        self.faults: list[tuple[Mark, str]] = []
        self.whole = True
        self._events = events
        self._tree: Tree = (1, 1)
        self._anchors: dict[str, tuple[Any, Tree, int] | None] = {}
        self._count = self._aliased = 0
        try:
            self.value, self._tree = self._root()
        except FormError as stop:
            self.whole = False
            self.faults.append((stop.at, str(stop)))

    def sharpened(self, wheres: Iterable[Where]) -> bool:
        """Return False: text was read as it is written."""
        return False

    def place(self, where: Where, at_key: bool = False) -> Mark:
        """Return the line and column of a value, or of its key; of its owner where it is missing."""
        tree, key = self._tree, None
        for step in where:
            if not isinstance(tree, Branch) or step not in tree.members:
                break
            key = tree.keys.get(step)
            tree = tree.members[step]
        if at_key and key:
            return key
        return tree.at if isinstance(tree, Branch) else tree

    def _root(self) -> tuple[Any, Tree]:
        """Return the only document of a stream."""
        next(self._events)
        if type(next(self._events)).__name__ == "StreamEndEvent":
            raise FormError((1, 1), _EMPTY)
        root = self._node(next(self._events), (), 1)
        next(self._events)
        event = next(self._events)
        if type(event).__name__ == "DocumentStartEvent":
            self.faults.append((_at(event), "a second document starts here; a scene file holds one"))
        return root

    def _node(self, event: Any, where: Where, depth: int) -> tuple[Any, Tree]:
        kind = type(event).__name__
        if kind == "AliasEvent":
            return self._alias(event)
        if event.tag is not None:
            self._tag(event, where)
        if kind == "ScalarEvent":
            node: tuple[Any, Tree] = (event.value if event.style else Plain(event.value), _at(event))
            size = 1
        else:
            if depth > DEPTH:
                raise FormError(_at(event), f"nested deeper than {DEPTH} levels")
            before = self._count
            if event.anchor is not None:
                self._anchors[event.anchor] = None
            read = self._mapping if kind == "MappingStartEvent" else self._sequence
            node = read(Branch(_at(event)), where, depth)
            size = self._count - before + 1
        self._count += 1
        if event.anchor is not None:
            self._anchors[event.anchor] = (*node, size)
        return node

    def _sequence(self, branch: Branch, where: Where, depth: int) -> tuple[list[Any], Branch]:
        values: list[Any] = []
        for event in self._events:
            if type(event).__name__ == "SequenceEndEvent":
                break
            index = len(values)
            value, branch.members[index] = self._node(event, (*where, index), depth + 1)
            values.append(value)
        return values, branch

    def _mapping(self, branch: Branch, where: Where, depth: int) -> tuple[dict[str, Any], Branch]:
        values: dict[str, Any] = {}
        wrong: list[tuple[Hashable, Mark, str]] = []
        missed = 0
        for event in self._events:
            if type(event).__name__ == "MappingEndEvent":
                break
            key, _ = self._node(event, where, depth + 1)
            at = _at(event)
            name = key if isinstance(key, str) else "?"
            value, tree = self._node(next(self._events), (*where, name), depth + 1)
            fault = _key_fault(key, value, branch)
            if fault:
                wrong.append(((fault.partition("'")[0], len(values)), at, fault))
                missed += _brought(value) if key == "<<" else 1
            else:
                values[key], branch.keys[key], branch.members[key] = value, at, tree
        self.faults += in_rows(where, wrong)
        return Holed(values, missed) if missed else values, branch

    def _alias(self, event: Any) -> tuple[Any, Tree]:
        name = event.anchor
        if name not in self._anchors:
            raise FormError(_at(event), f"alias *{name} has no anchor &{name} before it")
        known = self._anchors[name]
        if known is None:
            raise FormError(_at(event), f"alias *{name} stands inside its own anchor")
        value, tree, size = known
        self._count += size
        self._aliased += size
        if self._aliased > ALIASED:
            raise FormError(_at(event), f"aliases stand for more than {ALIASED} values; write them out")
        return value, tree

    def _tag(self, event: Any, where: Where) -> None:
        tag = event.tag.replace("tag:yaml.org,2002:", "!!")
        message = f"tags are not allowed, found {quoted(tag)}"
        self.faults.append((_at(event), labelled(label(where), message)))


def too_deep(value: Any) -> bool:
    """Return whether mappings and lists nest deeper than a scene's may."""
    level = [value] if isinstance(value, (dict, list)) else []
    for _ in range(DEPTH):
        members = list(chain.from_iterable(own.values() if isinstance(own, dict) else own for own in level))
        if not any(issubclass(kind, (dict, list)) for kind in set(map(type, members))):
            return False
        level = [inside for inside in members if isinstance(inside, (dict, list))]
    return bool(level)


def in_rows(where: Where, wrong: Iterable[tuple[Hashable, Mark, str]]) -> Iterator[tuple[Mark, str]]:
    """Yield (place, message) of keys that are wrong; those of one row of wrong keys are told once."""
    rows: dict[Hashable, list[tuple[Mark, str]]] = {}
    for row, at, fault in wrong:
        rows.setdefault(row, []).append((at, fault))
    for (at, fault), *others in rows.values():
        message = counted(fault, at[0], [line for (line, _), _ in others], "in a row")
        yield at, labelled(label(where), message)


def mark_of(text: str, offset: int) -> Mark:
    """Return line and column of a position in a text."""
    return text.count("\n", 0, offset) + 1, offset - (text.rfind("\n", 0, offset) + 1) + 1


def _at(event: Any) -> Mark:
    mark = event.start_mark
    return mark.line + 1, mark.column + 1


def _brought(value: Any) -> int:
    """Return how many keys a merge key would have brought."""
    return sum(map(len, value if isinstance(value, list) else [value]))


def _key_fault(key: object, value: object, branch: Branch) -> str | None:
    if not isinstance(key, str):
        return "a key must be a word, not a list or mapping"
    if isinstance(key, Plain) and key == "<<":
        return "merge keys (<<) are not allowed; write the values out"
    if isinstance(key, Plain) and ":" in key and isinstance(value, Plain) and not value:
        return "a blank must follow the colon of a key"
    if key in branch.keys:
        return f"duplicate key {quoted(key)}; first on line {branch.keys[key][0]}"
    return None
