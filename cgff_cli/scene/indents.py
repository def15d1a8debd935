"""Blocks of a scene whose indentation is lost or too deep: one mistake, though dozens of keys look wrong."""

from collections.abc import Collection
from itertools import chain
from typing import Any

from cgff_cli.hints import nearest
from cgff_cli.scene.elements import GROUP_KEYS
from cgff_cli.scene.fields import is_absent
from cgff_cli.scene.findings import Findings, quoted
from cgff_cli.scene.keys import Holed, lost

_BLOCKS = ("nodes", "elements", "supports", "loads")


def well_indented(findings: Findings, values: dict[str, Any], keys: Collection[str]) -> dict[str, Any]:
    """Return the top level of a scene without what stands at a wrong level, and record that."""
    return _without_sunken(findings, _without_spilt(findings, values, keys), keys)


def _without_spilt(findings: Findings, values: dict[str, Any], keys: Collection[str]) -> dict[str, Any]:
    """Take out empty blocks with the unknown keys behind them, which were meant to stand inside."""
    spilt: dict[str, list[str]] = {}
    block = ""
    for key, value in values.items():
        if key in keys or (block and block not in spilt and nearest(key, keys)):
            block = key if key in _BLOCKS and is_absent(value) else ""
        elif block:
            spilt.setdefault(block, []).append(key)
    for block, inside in spilt.items():
        message = f"nothing belongs to {block}: indent what follows, from {quoted(inside[0])}"
        findings.add_key((block,), message)
    return _without(values, {*spilt, *chain.from_iterable(spilt.values())}, len(spilt))


def _without_sunken(findings: Findings, values: dict[str, Any], keys: Collection[str]) -> dict[str, Any]:
    """Take out keys of the scene that were indented into the block before them."""
    for block in _BLOCKS:
        inside = values.get(block)
        if isinstance(inside, dict):
            sunken = [key for key in keys if key not in values and _is_block(inside.get(key))]
            for key in sunken:
                findings.add_key((block, key), f"{key} belongs to the scene itself: indent it less")
            if sunken:
                values = Holed({**values, block: _without(inside, sunken)}, lost(values) + len(sunken))
    return values


def _is_block(value: object) -> bool:
    """Return whether a value is a mapping, and not a group of elements that has the name of a block."""
    return isinstance(value, dict) and not set(value) & set(GROUP_KEYS)


def _without(values: dict[str, Any], gone: Collection[str], more_lost: int = 0) -> dict[str, Any]:
    if not gone:
        return values
    return Holed({key: value for key, value in values.items() if key not in gone}, lost(values) + more_lost)
