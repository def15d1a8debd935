"""What a file of another program describes, gathered in a scene's own values; then checked as a scene is."""

from collections.abc import Collection, Iterable, Iterator, Mapping
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
    merge : distance up to which points of an OBJ are one
    """

    law: str | None = None
    EA: float | None = None
    strut_EA: float | None = None
    kinds: Mapping[str, str] = {}
    nodes: str | None = None
    merge: float = 0.0

    def told(
        self, what: str, groups: Iterable[str], kinds: Iterable[str] = (), EA: bool = True, lacking: str = ""
    ) -> tuple[str, dict[str, str]]:
        """Return the law and the kind of each group; raises OptionError with all that was not told.

        groups : those whose kind the file does not say     kinds   : those that it says
        EA     : whether it says none                       lacking : what else is not told
        """
        names = list(dict.fromkeys(groups))
        strangers = [name for name in self.kinds if name and name not in names]
        if strangers and names:
            raise OptionError(f"--kind {strangers[0]}=...: there is no such group in {what}: {named(names)}")
        asked = [lacking] if lacking else []
        if self.law is None:
            asked.append("says no law: give --law hooke or --law paper")
        found = {name: self.kinds.get(name) or self.kinds.get("", "") for name in names}
        open_ones = [name for name, kind in found.items() if not kind]
        if open_ones:
            asked.append(
                "does not say what is a cable and what is a strut: "
                f"give --kind cable or --kind GROUP=strut, for {named(open_ones)}"
            )
        asked += self._stiffness_lacking({*kinds, *found.values()}) if EA else ()
        if asked:
            raise OptionError(f"{what} {'; it '.join(asked)}")
        return str(self.law), found

    def stiffness_of(self, kind: str) -> float | None:
        """Return the EA of an element of a kind, that of cables where struts have none of their own."""
        return self.strut_EA if kind == "strut" and self.strut_EA is not None else self.EA

    def _stiffness_lacking(self, kinds: Collection[str]) -> Iterator[str]:
        """Yield what is to be asked of EA; kinds: those there are, "" where that is not told."""
        lacking = [kind for kind in ("cable", "strut") if kind in kinds and self.stiffness_of(kind) is None]
        if lacking:
            flag = "--EA or --strut-EA" if lacking == ["strut"] else "--EA"
            yield f"says no EA of its {lacking[0]}s: give {flag}"
        elif "" in kinds and self.EA is self.strut_EA is None:
            yield "says no EA: give --EA"


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
        self,
        name: str,
        kind: str,
        ends: tuple[str, str],
        at: Mark,
        EA: float | None,
        rest_length: float | None,
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
