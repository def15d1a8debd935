"""YAML of other programs, told apart from scenes by their keys."""

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
