"""`convert`: a file of another program to a scene, and a scene to a file of another."""

import os
import re
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cgff_cli.errors import CgffError, OptionError
from cgff_cli.formats.draft import Asked, Draft
from cgff_cli.formats.yaml_values import unreadable
from cgff_cli.hints import either
from cgff_cli.scene.fields import HUGE, LEAST_SIZE
from cgff_cli.scene.foreign import FOREIGN, FOREIGN_KEYS, foreign_format
from cgff_cli.scene.read import STDIN, load, loads
from cgff_cli.scene.results import is_result
from cgff_cli.scene.scene import KINDS, LAWS, Scene
from cgff_cli.scene.text import decoded, read_text
from cgff_cli.values import Rule

READABLE = ("scene", "ntrt", "byu", "obj", "csv")
WRITABLE = ("scene", "obj", "vtu", "dxf")
STIFFNESS = Rule(positive=True, smallest=LEAST_SIZE, largest=HUGE)

_CALLED = FOREIGN | {
    "obj": "an OBJ file",
    "csv": "a list of edges",
    "scene": "a scene or a result",
    "result": "a result",
}
_ASKS = {
    "result": ("law", "EA", "strut_EA"),
    "ntrt": ("strut_EA",),
    "obj": ("law", "EA", "strut_EA", "kind", "merge"),
    "csv": ("law", "EA", "strut_EA", "kind", "nodes"),
}
_NOT_KEPT = {
    "obj": ("OBJ holds points and lines", ("names of nodes", "kinds", "EA")),
    "vtu": ("VTU holds points, lines and numbers", ("names of nodes", "names of groups", "the law")),
    "dxf": ("DXF holds lines and layers", ("names of nodes", "EA")),
}
REFITTED = "law and EA are those given to cgff convert; pretensions are the forces of the result"
_MAYBE = re.compile("|".join(key for keys in FOREIGN_KEYS.values() for key in keys))


@dataclass(frozen=True, eq=False)
class Converted:
    """A scene out of a file.

    source  : the format it was in
    began   : of a result, the path of the scene that was solved
    assumed : sentences on what the file does not say, and the scene does
    lost    : sentences on what the file says, and the scene does not
    """

    scene: Scene
    source: str
    assumed: tuple[str, ...] = ()
    lost: tuple[str, ...] = ()
    began: str | None = None

    def written(self, form: str) -> str | bytes:
        """Return the scene in a format of WRITABLE; raises OptionError where its extra is not installed."""
        return _WRITERS[form](self)

    def not_kept(self, form: str) -> tuple[str, ...]:
        """Return sentences on what does not come as far as a format of WRITABLE."""
        if form not in _NOT_KEPT:
            return self.lost
        why, gone = _NOT_KEPT[form]
        more = {
            "rest lengths": form != "vtu" and not self.scene.is_geometry,
            "supports": bool(self.scene.supports),
            "loads": bool(self.scene.loads),
            "weight": self.scene.weights is not None,
            "load cases": bool(self.scene.cases),
        }
        what = either([*gone, *(name for name, there in more.items() if there)], "and")
        moved = (self.start[1],) if form == "vtu" and self.start[1] else ()
        return (*self.lost, f"{what}: {why}", *moved)

    @cached_property
    def start(self) -> tuple[np.ndarray | None, str]:
        """(n, d) where a result's nodes began, as its scene says today, or None; and why it is not known."""
        if self.began is None:
            return None, ""
        try:
            scene = load(self.began)
        except CgffError:
            return None, f"displacements: the scene {self.began} cannot be read"
        if (scene.node_names, scene.dimension) != (self.scene.node_names, self.scene.dimension):
            return None, f"displacements: the scene {self.began} has other nodes now"
        return scene.coordinates, ""


def convert(
    path: str,
    *,
    source: str | None = None,
    nodes: str | None = None,
    law: str | None = None,
    EA: float | None = None,
    strut_EA: float | None = None,
    kind: str | Mapping[str, str] = (),  # type: ignore[assignment]
    merge: float | None = None,
) -> Converted:
    """Read a file: NTRT or BYU YAML, OBJ, a CSV of edges, a scene, or a result; `-` is standard input.

    source       : one of READABLE, by suffix and content where None
    nodes        : beside a CSV of edges the CSV of its nodes
    law, EA, ... : what the format does not say; EA in the units of the law, kind for all groups or for each.
                   Of a result they stand in place of its own, and its forces become pretensions
    merge        : distance up to which points of an OBJ are one node; those of one place are in any case

    Raises SceneError with every fault of the file, OptionError for what it needs, or has no place for.
    """
    kinds = {"": kind} if isinstance(kind, str) else dict(kind)
    text, shown = _read(path)
    form = source or _form(text, shown)
    asked = {"law": law, "EA": EA, "strut_EA": strut_EA, "nodes": nodes, "kind": kinds or None}
    asked |= {"merge": merge}
    asked = {name: value for name, value in asked.items() if value is not None}
    began = _began(text) if form == "scene" else None
    _check(form if began is None else "result", asked, kinds)
    given = Asked(law, EA, strut_EA, kinds, nodes, merge or 0.0)
    if form == "scene":
        scene = loads(text, shown, os.path.dirname(path), results=True)
        scene = replace(scene, files=(shown, *scene.files))
        if not asked:
            return Converted(scene, form, began=began)
        from cgff_cli.formats.refit import refitted

        return Converted(refitted(scene, given), form, (REFITTED,), began=began)
    draft = _readers()[form](text, shown, given)
    scene = draft.scene()
    return Converted(scene, form, tuple(draft.assumed), tuple(draft.lost))


def _read(path: str) -> tuple[str, str]:
    """Return the text of a file, and what it is called in messages."""
    try:
        return (decoded(sys.stdin.buffer.read(), STDIN), STDIN) if path == "-" else (read_text(path), path)
    except (OSError, ValueError) as error:
        raise unreadable(STDIN if path == "-" else path, error) from None


def _form(text: str, path: str) -> str:
    """Return the format of a text, by the suffix of its name, then by its keys."""
    from cgff_cli.scene.located import Document
    from cgff_cli.scene.yaml_text import yaml_events

    suffix = os.path.splitext(path)[1].lower()
    if suffix in (".obj", ".csv"):
        return suffix[1:]
    if suffix in (".vtu", ".dxf"):
        raise OptionError(f"{path}: {suffix[1:].upper()} can be written, not read")
    return (_MAYBE.search(text) and foreign_format(Document(yaml_events(text)).value)) or "scene"


def _check(form: str, given: Mapping[str, object], kinds: Mapping[str, str]) -> None:
    """Raise OptionError for values that are none, or that a format has no place for."""
    if form not in (*READABLE, "result"):
        raise OptionError(f"unknown format {form!r}; there are {', '.join(READABLE)}")
    for name, value in given.items():
        flag = f"--{name.replace('_', '-')}"
        if name not in _ASKS.get(form, ()):
            raise OptionError(f"{flag} has no place: {_CALLED[form]} needs none")
        if name in ("EA", "strut_EA", "merge"):
            STIFFNESS.checked(flag, value)
        if name == "law" and value not in LAWS:
            raise OptionError(f"{flag} must be {either(LAWS)}, got {value!r}")
    for group, own in kinds.items():
        if own not in KINDS:
            of = f" {group}=" if group else ""
            raise OptionError(f"--kind{of} must be {either(KINDS)}, got {own!r}")


def _readers() -> dict[str, Callable[[str, str, Asked], Draft]]:
    from cgff_cli.formats.byu import read_byu
    from cgff_cli.formats.edges import read_edges
    from cgff_cli.formats.ntrt import read_ntrt
    from cgff_cli.formats.obj import read_obj

    return {"byu": read_byu, "csv": read_edges, "ntrt": read_ntrt, "obj": read_obj}


def _began(text: str) -> str | None:
    """Return the path of the scene that a result is of; None of a scene."""
    if '"cgff-result/' not in text:
        return None
    import json

    value = json.loads(text)
    return str(value["scene"].get("path")) if is_result(value) else None


def _scene_text(converted: Converted) -> str:
    from cgff_cli.scene.write import to_yaml

    path = converted.scene.path
    name = path if path.isprintable() else ascii(path)
    header = [f"converted from {name}, {_CALLED[converted.source]}", *converted.assumed]
    header += [f"left out: {what}" for what in converted.lost]
    return to_yaml(converted.scene, "\n".join(" ".join(line.split()) for line in header))


def _obj(converted: Converted) -> str:
    from cgff_cli.formats.obj import obj_text

    return obj_text(converted.scene)


def _vtu(converted: Converted) -> bytes:
    from cgff_cli.formats.vtu import vtu_bytes

    return vtu_bytes(converted.scene, converted.start[0])


def _dxf(converted: Converted) -> str:
    from cgff_cli.formats.dxf import dxf_text

    return dxf_text(converted.scene)


_WRITERS: dict[str, Callable[[Converted], str | bytes]] = {
    "scene": _scene_text,
    "obj": _obj,
    "vtu": _vtu,
    "dxf": _dxf,
}
