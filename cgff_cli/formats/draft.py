"""What a file of another program describes, gathered in a scene's own values; then checked as a scene is."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from cgff_cli.errors import OptionError, Problem, SceneError
from cgff_cli.hints import count, either
from cgff_cli.scene.findings import NOWHERE, Findings, Mark, Where, first_few, listed
from cgff_cli.scene.scene import Scene
from cgff_cli.scene.schema import read_scene


class Asked(NamedTuple):
    """What the user says of elements, where a format has no words for it.

    kinds : group -> cable or strut; "" is every other group
    """

    law: str | None = None
    EA: float | None = None
    strut_EA: float | None = None
    kinds: Mapping[str, str] = {}
    nodes: str | None = None

    def asked_law(self, what: str) -> str:
        """Return the law; raises OptionError where it was not told."""
        if self.law is None:
            raise OptionError(f"{what} says no law: give --law hooke or --law paper")
        return self.law

    def stiffness_of(self, what: str, kind: str) -> float:
        """Return the EA of an element of a kind, that of cables where struts have none of their own."""
        own = self.strut_EA if kind == "strut" and self.strut_EA is not None else self.EA
        if own is None:
            flag = "--EA or --strut-EA" if kind == "strut" else "--EA"
            raise OptionError(f"{what} says no EA of its {kind}s: give {flag}")
        return own

    def asked_kinds(self, what: str, groups: Iterable[str]) -> dict[str, str]:
        """Return the kind of every group; raises OptionError of those that were not told, or are none."""
        names = list(dict.fromkeys(groups))
        strangers = [name for name in self.kinds if name and name not in names]
        if strangers:
            raise OptionError(f"--kind {strangers[0]}=...: there is no such group in {what}: {named(names)}")
        open_ones = [name for name in names if name not in self.kinds and "" not in self.kinds]
        if open_ones:
            raise OptionError(
                f"{what} does not say what is a cable and what is a strut: "
                f"give --kind cable or --kind GROUP=strut, for {named(open_ones)}"
            )
        return {name: self.kinds.get(name) or self.kinds[""] for name in names}


class Draft:
    """A scene in the making.

    files   : paths it was read from
    assumed : sentences on what the file does not say, and the scene does
    lost    : sentences on what the file says, and the scene does not
    """

    def __init__(self, path: str, law: str):
        self.path, self.law = path, law
        self.nodes: dict[str, list[float]] = {}
        self.supports: dict[str, str] = {}
        self.groups: dict[str, dict[str, Any]] = {}
        self.places: dict[Where, Mark] = {}
        self.files = [path]
        self.assumed: list[str] = []
        self.lost: list[str] = []

    def node(self, name: str, point: list[float], at: Mark) -> None:
        """Add a node, 2 or 3 coordinates, in the file's unit of length."""
        self.nodes[name] = point
        self.places["nodes", name] = at

    def element(
        self, name: str, kind: str, ends: tuple[str, str], at: Mark, EA: float, rest_length: float | None
    ) -> None:
        """Add an element to a group, to one beside it where the group is of the other kind."""
        while self.groups.get(name, {"kind": kind})["kind"] != kind:
            name = f"{name} ({kind})"
        group = self.groups.setdefault(name, {"kind": kind, "EA": [], "rest_length": [], "pairs": []})
        self.places["elements", name, len(group["pairs"])] = at
        group["EA"].append(EA)
        group["pairs"].append(list(ends))
        if rest_length is not None:
            group["rest_length"].append(rest_length)

    def scene(self) -> Scene:
        """Return the scene; raises SceneError with every problem found, placed in the file."""
        if not self.groups:
            raise SceneError([Problem(self.path, 1, 1, "there is no element in this file")])
        used = {end for group in self.groups.values() for pair in group["pairs"] for end in pair}
        idle = [name for name in self.nodes if name not in used and name not in self.supports]
        if idle:
            self.lost.append(f"{count(len(idle), 'node')} that no element joins: {first_few(idle)}")
        gone = set(idle)
        value = {
            "law": self.law,
            "nodes": {name: point for name, point in self.nodes.items() if name not in gone},
            "elements": {
                name: {key: own for key, own in group.items() if own or key == "kind"}
                for name, group in self.groups.items()
            },
            "supports": self.supports,
        }
        findings = Findings(label_of=_last_key)
        scene = read_scene(findings, value, self.path, "")
        if scene is None or not findings.none:
            raise SceneError(findings.problems(self.path, self._place))
        return replace(scene, files=tuple(self.files))

    def _place(self, where: Where, at_key: bool) -> Mark:
        row = next((step for step in where[2:] if isinstance(step, int)), 0)
        return self.places.get(where[:2]) or self.places.get((*where[:2], row), NOWHERE)


def _last_key(where: Where) -> str:
    """Return what a value is called in the words of a scene: EA, rest_length."""
    return where[2] if len(where) > 2 and isinstance(where[2], str) and where[2] != "pairs" else ""


def refused(path: str, faults: Iterable[tuple[Mark, str]]) -> SceneError:
    """Return the error of a file with these faults, each with its place."""
    return SceneError(listed([Problem(path, *at, message) for at, message in faults]))


def named(groups: list[str]) -> str:
    """Return the groups of a file in words."""
    return either([repr(name) for name in groups[:10]], "and") + (", ..." if len(groups) > 10 else "")
