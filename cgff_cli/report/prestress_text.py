"""A prestress as a page for the terminal: the verdict first, then a row per group."""

from collections.abc import Iterator
from typing import Any

import numpy as np
from rich.console import RenderableType
from rich.text import Text

from cgff_cli.analysis.equilibrium import labels
from cgff_cli.hints import count
from cgff_cli.refusals import in_groups
from cgff_cli.report.table import names_column, spans_column
from cgff_cli.report.terminal import Aligned, Column, clean, column, fields, number
from cgff_cli.rest_lengths import Prestressed
from cgff_cli.scene.scene import Scene

_NAMED = 10  # elements to blame that are named; of more it says how many


def prestress_page(found: Prestressed) -> Iterator[RenderableType]:
    """Yield the page: whether the shape can be held, how firmly, and what each group carries."""
    colour = {True: "bold green", False: "bold red", None: "bold yellow"}[found.feasible]
    words = {True: "prestressed", False: "impossible", None: "undecided"}[found.feasible]
    yield Text.assemble((clean(found.source.name), "bold"), "  ", (words, colour))
    yield fields(_facts(found))
    if found.scene is not None:
        yield _groups(found)


def verdict(found: Prestressed) -> str:
    """Return in one sentence whether a shape can be held, and how firmly."""
    if found.scene is None:
        return f"{'undecided' if found.feasible is None else 'impossible'}: {found.reason}"
    is_balanced = found.result is not None and found.result.converged
    words = [f"in balance {'' if is_balanced else 'but for rounding '}with these rest lengths"]
    words.append(found.stability or "stability not told")
    words += ["super-stable"] if found.super_stable else []
    if found.mechanisms:
        stiffened = {"stable": ", stiffened by its forces", "unstable": ""}.get(
            found.stability or "", ", not stiffened" if found.stability else ""
        )
        words.append(f"{count(found.mechanisms, 'mechanism')}{stiffened}")
    elif found.mechanisms == 0:
        words.append("no mechanisms")
    return ", ".join(words)


def _facts(found: Prestressed) -> Iterator[tuple[str, str]]:
    yield "verdict", clean(verdict(found).partition(": ")[2] if found.scene is None else verdict(found))
    states, shared = found.self_stress_states, found.group_states
    told = "not told" if states is None else count(states, "state", "states")
    yield "self-stress", told + ("" if shared is None else f", {shared or 'none'} of shared values")
    if found.rank_gap is not None:
        yield "rank", f"gap {found.rank_gap:.1e} between what is a state and what is none"
    if found.max_node_motion is not None:
        yield "shape", f"nodes moved by up to {number(found.max_node_motion)} to where it balances"
    yield from _blame(found)
    for warning in found.warnings:
        yield "warning", clean(warning)


def _blame(found: Prestressed) -> Iterator[tuple[str, str]]:
    idle = set(found.idle)
    wrong = [label for label in found.never if label not in idle]
    for what, blamed in (("wrong sign", wrong), ("idle", found.idle)):
        if blamed:
            yield what, clean(_many(found.source, blamed) if len(blamed) > _NAMED else ", ".join(blamed))


def _many(source: Scene, wanted: list[str]) -> str:
    """Return how many elements are blamed, too many to be named, and of which groups."""
    if len(wanted) == source.element_count:
        return f"all {len(wanted)} elements"
    all_labels, blamed = labels(source, np.arange(source.element_count)), set(wanted)
    rows = np.flatnonzero([label in blamed for label in all_labels])
    return f"{len(wanted)} of {source.element_count} elements: {in_groups(source, rows)}"


def _groups(found: Prestressed) -> Aligned:
    groups: dict[str, dict[str, Any]] = found.groups
    return Aligned(
        [
            names_column("group", groups),
            Column("kind", [group.kind for group in found.source.groups]),
            column("count", (entry["count"] for entry in groups.values())),
            *(spans_column(groups, name) for name in ("force_density", "force", "rest_length", "strain")),
        ]
    )
