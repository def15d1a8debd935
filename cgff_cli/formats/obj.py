"""Wavefront OBJ: points (`v`), lines and polylines (`l`), groups (`g`, `o`). It knows geometry alone."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from cgff_cli.formats.draft import Asked, Draft, refused
from cgff_cli.formats.names import distinct
from cgff_cli.hints import count
from cgff_cli.scene.fields import HUGE, NUMBER
from cgff_cli.scene.findings import Mark, quoted
from cgff_cli.scene.physics import component_labels
from cgff_cli.scene.scene import Scene

_WHAT = "an OBJ file"
_WORDS = {"f": "face", "p": "point", "curv": "curve", "surf": "surface"}


class _Line(NamedTuple):
    """One `l`: its group, and the rows it joins, in order, each with its place."""

    group: str
    rows: list[tuple[int, Mark]]


class _Reading:
    """The points and lines of a text, and what is wrong with it; rows count from 0."""

    def __init__(self, text: str):
        self.points: list[tuple[list[float], Mark]] = []
        self.lines: list[_Line] = []
        self.faults: list[tuple[Mark, str]] = []
        self.others: dict[str, int] = {}
        self.more = 0
        self._group = "lines"
        for words in _statements(text):
            self._take(words)
        n = len(self.points)
        self.faults += [
            (at, f"there is no vertex {row + 1}; the file has {count(n, 'vertex', 'vertices')}")
            for line in self.lines
            for row, at in line.rows
            if row >= n
        ]

    def _take(self, words: list[tuple[str, Mark]]) -> None:
        (key, at), *rest = words
        if key == "v":
            self.points.append((self._point(rest, at), at))
        elif key == "l":
            if len(rest) < 2:
                self.faults.append((at, "a line joins at least two vertices"))
            self.lines.append(_Line(self._group, [self._row(word, at) for word, at in rest]))
        elif key in ("g", "o"):
            self._group = " ".join(word for word, _ in rest) or "lines"
        elif key in _WORDS:
            self.others[key] = self.others.get(key, 0) + 1

    def _point(self, words: list[tuple[str, Mark]], at: Mark) -> list[float]:
        if len(words) < 3:
            self.faults.append((at, f"a vertex has three coordinates, got {len(words)}"))
        for word, place in words[:3]:
            if not NUMBER.fullmatch(word) or not abs(float(word)) <= HUGE:
                self.faults.append((place, f"must be a number such as 2.98 or 1e-8, got {quoted(word)}"))
        self.more += len(words) > 3
        return [0.0] * 3 if self.faults else [float(word) for word, _ in words[:3]]

    def _row(self, word: str, at: Mark) -> tuple[int, Mark]:
        """Return the row of a vertex such as 3, -1 (the last so far) or 3/1 (with a texture)."""
        text = word.partition("/")[0]
        digits = text.removeprefix("-")
        if not (digits.isascii() and digits.isdigit()) or len(digits) > 12 or int(digits) == 0:
            self.faults.append((at, f"must be the number of a vertex, from 1, got {quoted(word)}"))
            return 0, at
        row = int(text) - 1 if text == digits else len(self.points) + int(text)
        if row < 0:
            self.faults.append((at, f"there are not so many vertices before this line, got {quoted(word)}"))
        return max(row, 0), at


def _statements(text: str) -> Iterator[list[tuple[str, Mark]]]:
    """Yield the words of each statement with their places; a backslash at its end continues a line."""
    words: list[tuple[str, Mark]] = []
    for number, line in enumerate(text.split("\n"), 1):
        bare, offset = line.partition("#")[0].rstrip(), 0
        goes_on = bare.endswith("\\")
        for word in bare.removesuffix("\\").split():
            offset = bare.index(word, offset)
            words.append((word, (number, offset + 1)))
            offset += len(word)
        if words and not goes_on:
            yield words
            words = []
    if words:
        yield words


def read_obj(text: str, path: str, given: Asked) -> Draft:
    """Return the geometry of an OBJ text; raises SceneError, and OptionError for what it asks."""
    read = _Reading(text)
    if read.faults:
        raise refused(path, read.faults)
    law, kinds = given.told(_WHAT, (line.group for line in read.lines))
    draft = Draft(path, law)
    firsts = _first_at([point for point, _ in read.points], given.merge)
    names = [f"n{first + 1}" for first in firsts]
    for name, first in zip(names, firsts, strict=True):
        draft.node(name, *read.points[first])
    for line in read.lines:
        kind = kinds[line.group]
        for (a, at), (b, _) in zip(line.rows, line.rows[1:], strict=False):
            draft.element(line.group, kind, (names[a], names[b]), at, given.stiffness_of(kind), None)
    draft.assumed.append("vertex number k is node nk; law, EA and kinds are those given to cgff convert")
    merged = len(names) - len(set(names))
    where = f"within {given.merge:g}" if given.merge else "at the very point"
    draft.lost += [f"{count(merged, 'vertex', 'vertices')} {where} of another"] * (merged > 0)
    draft.lost += [f"{count(number, _WORDS[key])}" for key, number in read.others.items()]
    draft.lost += [f"what {count(read.more, 'vertex', 'vertices')} say beyond x, y, z"] * (read.more > 0)
    return draft


def _first_at(points: list[list[float]], merge: float) -> list[int]:
    """Return for each point the row of the first at its place; merge: distance up to which places are one."""
    if not merge:
        first: dict[tuple[float, ...], int] = {}
        return [first.setdefault(tuple(point), row) for row, point in enumerate(points)]
    from scipy.spatial import KDTree

    near = KDTree(np.array(points)).query_pairs(merge, output_type="ndarray")
    label = component_labels(len(points), near)
    return np.unique(label, return_index=True)[1][label].tolist()


def obj_text(scene: Scene) -> str:
    """Return points and lines of a scene, a group each; z is 0 where the scene is plane."""
    flat = [0.0] * (3 - scene.dimension)
    lines = [f"# {' '.join(scene.name.split())}; node k of the scene is vertex k"]
    lines += ["v " + " ".join(map(repr, point + flat)) for point in scene.coordinates.tolist()]
    groups = distinct((group.name for group in scene.groups), r"[^\w.()+-]")
    for name, group in zip(groups, scene.groups, strict=True):
        lines.append(f"g {name}")
        lines += [f"l {start + 1} {end + 1}" for start, end in group.pairs.tolist()]
    return "\n".join(lines) + "\n"
