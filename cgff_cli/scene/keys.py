"""Keys of a mapping and columns of a table: which are unknown or missing, and what was meant."""

from collections.abc import Collection, Mapping
from typing import Any

from cgff_cli.hints import NAMED, either, nearest
from cgff_cli.scene.findings import Findings, Where, quoted

_OTHER_WORDS = {
    "name": ("title", "id", "node", "label"),
    "nodes": ("points", "joints", "vertices", "coordinates"),
    "elements": ("members", "edges", "bars", "groups"),
    "supports": ("fixed", "constraints", "anchors", "restraints", "boundary_conditions"),
    "loads": ("forces",),
    "solver": ("options", "settings"),
    "kind": ("type",),
    "EA": ("young", "youngs_modulus", "modulus", "area", "stiffness", "axial_stiffness"),
    "rest_length": ("l0", "length", "lengths", "rest", "free_length", "unstressed_length"),
    "pretension": ("prestress", "tension"),
    "weight": ("self_weight", "dead_load"),
    "load_cases": ("cases", "loadcases"),
    "combinations": ("combos", "load_combinations"),
    "gravity": ("g",),
    "pairs": ("members", "edges", "connectivity", "connections"),
    "start": ("from", "begin", "node1"),
    "end": ("to", "node2"),
}
"""Our keys -> what others call the same, where it does not look alike."""

_EXPLAINED = {"EA": " EA is E times A;"}
_COMPARED = 20  # more unknown keys than that are no slips of the pen


def check_keys(
    findings: Findings,
    where: Where,
    values: Mapping[str, Any],
    allowed: Collection[str],
    required: Mapping[str, str] | None = None,
) -> bool:
    """Record unknown and missing keys and return whether there are none.

    required : key -> what to say of it where it is missing
    """
    required, gone = required or {}, lost(values)
    strange = [key for key in values if key not in allowed and not is_own(key)]
    nearly = [key for key in strange if is_own(key.lower().replace("_", "-"))]
    for key in nearly:
        findings.add_key((*where, key), f"unknown key {quoted(key)}; did you mean {quoted('x-' + key[2:])}?")
    if strange:
        known = [key for key in values if not is_own(key) and key not in nearly]
        faults, missing = key_faults(known, allowed, required)
        for key, message in faults.items():
            findings.add_key((*where, key), message)
    else:
        missing = [key for key in required if key not in values]
    for key in missing if len(missing) > gone else ():
        findings.add(where, f"missing key {key!r}{required[key]}", at_key=True)
    return not strange and not missing and not gone


def is_own(key: str) -> bool:
    """Return whether a key is the user's own: kept, and not looked at."""
    return key.startswith("x-")


class Holed(dict[str, Any]):
    """A mapping without some keys that could not be read: so many others may be missing for it."""

    def __init__(self, values: Mapping[str, Any], lost: int):
        super().__init__(values)
        self.lost = lost


def lost(values: Mapping[str, Any]) -> int:
    """Return how many keys of a mapping could not be read."""
    return values.lost if isinstance(values, Holed) else 0


def key_faults(
    given: Collection[str], allowed: Collection[str], required: Collection[str], noun: str = "key"
) -> tuple[dict[str, str], list[str]]:
    """Return the faults of unknown keys, by key, and the keys that are missing for no such reason.

    A key that was meant to be another is one mistake: it explains why the other is missing. Unknown keys
    that come of one habit are told together.
    """
    absent = [key for key in allowed if key not in given]
    habits: dict[object, tuple[list[str], list[str]]] = {}
    for i, key in enumerate(key for key in given if key not in allowed):
        habit, meant = _meant(key, absent if i < _COMPARED else [])
        keys, words = habits.setdefault(habit, ([], []))
        keys.append(key)
        words += [word for word in meant if word not in words]
    understood = {word for _, words in habits.values() for word in words}
    faults = {}
    for habit, (keys, words) in habits.items():
        said = either([quoted(key) for key in keys], "and")
        plural = "s" if len(keys) > 1 else ""
        faults[keys[0]] = f"unknown {noun}{plural} {said};{_hint(habit, words)} allowed: {', '.join(allowed)}"
    return faults, [key for key in required if key in absent and key not in understood]


def meant_by(key: str, absent: Collection[str]) -> list[str]:
    """Return what is meant by a word that is none of those allowed; nothing where that is not clear."""
    return _meant(key, absent)[1]


def _meant(key: str, absent: Collection[str]) -> tuple[object, list[str]]:
    """Return the habit that makes people write a key, and what is meant by it."""
    letters = [word for word in absent if _bare(word) == _bare(key)]
    if letters:
        return "letters", letters
    near = nearest(key, absent)
    if not 0 < len(near) <= NAMED:
        near = [word for word in absent if _bare(key) in map(_bare, _OTHER_WORDS.get(word, ()))][:1]
    return tuple(near) or (key,), near


def _bare(word: str) -> str:
    return "".join(filter(str.isalnum, word)).lower()


def _hint(habit: object, words: list[str]) -> str:
    if not words:
        return ""
    joint = "and" if habit == "letters" else "or"
    explained = _EXPLAINED.get(words[0], "") if habit == tuple(words) else ""
    return f" did you mean {either(list(map(repr, words)), joint)}?{explained}"
