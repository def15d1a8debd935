"""Files that are no scenes, told apart by their keys, lines and columns, and what makes scenes of them."""

import re
from collections.abc import Collection
from typing import Any

FOREIGN = {"ntrt": "a NASA NTRT structure", "byu": "a BYU TensegritySim structure"}
"""Format -> what such a file is called; `formats` reads them."""

FOREIGN_KEYS = {"ntrt": ("pair_groups", "substructures", "bond_groups"), "byu": ("connections",)}
"""Keys that no scene has, and of which one is in every file of a format."""

_OURS = ("law", "elements")


def foreign_format(value: object) -> str | None:
    """Return the format of another program that plain values are written in, or None."""
    if not isinstance(value, dict) or any(key in value for key in _OURS):
        return None
    return next((form for form, keys in FOREIGN_KEYS.items() if any(key in value for key in keys)), None)


def how_to_convert(value: dict[str, Any], path: str) -> str | None:
    """Return what a file of another program is, and the command that makes a scene of it."""
    form = foreign_format(value)
    if form is None:
        return None
    file = f"- --from {form}" if path.startswith("<") else path
    flags = " --strut-EA X" if form == "ntrt" else ""
    return f"this is {FOREIGN[form]}, not a scene; make it one: cgff convert {file}{flags} -o scene.yaml"


_OBJ_LINES = re.compile(r"^(?:v[ \t]+[-+.\d]|l[ \t]+-?\d)", re.MULTILINE)
_ASKED = {"EA": " --EA X", "kind": " --kind KIND"}
_ROWS = {"verdict", "converged", "stability", "energy"}


def how_to_use(text: str, path: str) -> str | None:
    """Return what a text is that is neither YAML nor JSON of a scene, and the command that takes it."""
    suffix, is_piped = path.lower()[-4:], path.startswith("<")
    first = next(filter(None, map(str.strip, text.splitlines())), "")
    columns = {cell.strip() for cell in re.split("[,;\t]", first)}
    if suffix == ".obj" or _OBJ_LINES.search(text):
        file = "- --from obj" if is_piped else path
        return f"this is an OBJ file, not a scene; make it one: cgff convert {file}{_flags()} -o scene.yaml"
    if {"start", "end"} <= columns:
        file = "- --from csv" if is_piped else path
        return (
            "this is a list of edges, not a scene; make it one: "
            f"cgff convert {file} --nodes FILE.csv{_flags(columns)} -o scene.yaml"
        )
    if columns >= _ROWS and "method" not in columns:
        file = "FILE.csv" if is_piped else path
        return f"these are rows of cgff sweep, not a scene; draw them: cgff plot --sweep {file} -o FILE.png"
    if suffix == ".csv" and first:
        return (
            "this is a table, not a scene; a scene may name it, as in nodes: FILE.csv, and cgff convert "
            "takes lists of edges, with the columns start and end"
        )
    return None


def _flags(columns: Collection[str] = ()) -> str:
    """Return the flags for what a geometry does not say; columns: what it says."""
    return " --law LAW" + "".join(words for name, words in _ASKED.items() if name not in columns)
