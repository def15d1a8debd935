"""One result as a page for the terminal."""

from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np
from rich.console import RenderableType
from rich.text import Text

from cgff_cli.analysis.measures import spans
from cgff_cli.hints import count
from cgff_cli.report.terminal import (
    Aligned,
    Column,
    clean,
    column,
    duration,
    fields,
    heading,
    number,
    numbers,
    verdict_words,
)
from cgff_cli.result import Result
from cgff_cli.scene.scene import Scene

FEW = 30
"""Lists longer than this are summarised unless asked for in full."""

_NAMED = 6  # elements named in a sentence before it says how many more


def result_page(result: Result, full: bool = False) -> Iterator[RenderableType]:
    """Yield the page: how it ended, what was found, nodes and elements; full: each, however many."""
    names, X, reactions = result.source.node_names, result.coordinates, result.reactions
    pulls = np.array(list(reactions.values()))
    yield Text.assemble(heading(result.source), "  ", verdict_words(result.verdict))
    yield fields(_facts(result))
    many_nodes, many_reactions = (not full and len(own) > FEW for own in (X, pulls))
    if many_nodes:
        ends = zip(X.min(axis=0), X.max(axis=0), strict=True)
        said = [("nodes", _by_axis(f"{number(low)} .. {number(high)}" for low, high in ends))]
        if many_reactions:
            said.append(("reactions", f"sum {_by_axis(map(number, pulls.sum(axis=0)))}"))
        yield fields(said)
    else:
        yield _vectors("node", names, X)
    if len(pulls) and not many_reactions:
        yield _vectors("reaction", reactions, pulls)
    yield _elements(result) if full or result.source.element_count <= FEW else group_table(result)


def _facts(result: Result) -> Iterator[tuple[str, str]]:
    source, residual, counts = result.source, result.residual, result.counts
    yield "verdict", result.message
    yield "structure", structure_words(source)
    yield (
        "residual",
        f"{residual['max']:.2e}, {residual['relative']:.2e} of the reference force "
        f"{number(residual['reference_force'])}",
    )
    yield "energy", number(result.energy)
    yield "shape", _change(result)
    effort = [count(counts[kind], kind[:-1]) for kind in ("iterations", "evaluations", "factorizations")]
    yield "effort", f"{', '.join(effort)}, {duration(result.seconds)}"
    yield "analysis", analysis_words(result.analysis)
    for warning in result.warnings:
        yield "warning", clean(warning)


def structure_words(source: Scene) -> str:
    """Return how large a scene is."""
    return (
        f"{count(len(source.node_names), 'node')}, {count(source.element_count, 'element')} in "
        f"{count(len(source.groups), 'group')}, {source.dimension}-D, law {source.law}"
    )


def _change(result: Result) -> str:
    """Return how far elements and nodes are from where they were."""
    strain, moved = result.max_strain, result.max_displacement
    words = [] if strain is None else [f"largest strain {strain:.3g}"]
    words += [] if moved is None else [f"largest motion {moved:.3g} of its size"]
    return ", ".join(words) or "without size"


def analysis_words(analysis: dict[str, Any]) -> str:
    """Return what the analysis found, in words; what was not computed is left out."""
    words = [
        count(analysis[name], *nouns)
        for name, *nouns in (
            ("self_stress_states", "state of self-stress", "states of self-stress"),
            ("mechanisms", "mechanism"),
        )
        if analysis.get(name) is not None
    ]
    words += [str(analysis["stability"])] if analysis.get("stability") else []
    words += ["super-stable"] if analysis.get("super_stable") else []
    words += ["no prestress"] if analysis.get("prestressed") is False else []
    words += _listed(analysis, "slack_cables", "slack_count", "slack cable")
    words += _listed(
        analysis, "struts_in_tension", "struts_in_tension_count", "strut in tension", "struts in tension"
    )
    return ", ".join(words) or "not computed"


def _listed(analysis: dict[str, Any], key: str, count_key: str, singular: str, plural: str = "") -> list[str]:
    labels = analysis.get(key) or []
    if not labels:
        return []
    total = analysis.get(count_key) or len(labels)
    named = ", ".join(clean(label) for label in labels[:_NAMED])
    more = f" and {total - _NAMED} more" if total > _NAMED else ""
    return [f"{count(total, singular, plural)} ({named}{more})"]


def _vectors(title: str, names: Iterable[str], values: np.ndarray) -> Aligned:
    axes = zip("xyz", values.T.tolist(), strict=False)
    return Aligned([names_column(title, names), *(Column(axis, numbers(own), True) for axis, own in axes)])


def _by_axis(texts: Iterable[str]) -> str:
    return ", ".join(f"{axis} {text}" for axis, text in zip("xyz", texts, strict=False))


def _elements(result: Result) -> Aligned:
    s, names, groups = result.structure, result.source.node_names, result.source.groups
    slack = ["slack" if slack else "" for slack in result.slack.tolist()]
    return Aligned(
        [
            names_column("element", (group.name for group in groups for _ in group.EA)),
            Column("kind", [group.kind for group in groups for _ in group.EA]),
            names_column("start", (names[row] for row in s.start.tolist())),
            names_column("end", (names[row] for row in s.end.tolist())),
            Column("length", numbers(result.lengths.tolist()), True),
            Column("force", numbers(result.forces.tolist()), True),
            Column("force density", numbers(result.force_densities.tolist()), True),
            *([Column("", slack, styles=["yellow"] * len(slack))] if any(slack) else []),
        ],
        keys=4,
    )


def group_table(result: Result, names: Iterable[str] = ("length", "force", "force_density")) -> Aligned:
    """Return a row per group: least and greatest of some columns of its elements."""
    groups = result.groups
    slack = column("slack", (entry["slack"] for entry in groups.values()))
    return Aligned(
        [
            names_column("group", groups),
            Column("kind", [group.kind for group in result.source.groups]),
            column("count", (entry["count"] for entry in groups.values())),
            *(spans_column(groups, name) for name in names),
            *([slack] if result.slack.any() else []),
        ]
    )


def changes_table(result: Result, changes: np.ndarray) -> Aligned:
    """Return a row per group: least and greatest change of its elements' forces; changes: (b,)."""
    own = result.source.groups
    rows = spans(changes, [len(group.EA) for group in own])
    groups = {group.name: {"force_change": ends} for group, ends in zip(own, rows, strict=True)}
    return Aligned([names_column("group", groups), spans_column(groups, "force_change")])


def spans_column(groups: dict[str, dict[str, Any]], name: str) -> Column:
    """Return a column of `least .. greatest` per group, or of one value where they look the same."""
    texts = numbers([end for entry in groups.values() for end in entry[name]])
    width = max(map(len, texts))
    pairs = zip(texts[::2], texts[1::2], strict=True)
    cells = [f"{low:>{width}} .. {high:>{width}}" if low != high else high for low, high in pairs]
    return Column(name.replace("_", " "), cells, True)


def names_column(title: str, names: Iterable[str]) -> Column:
    """Return a column of names."""
    return Column(title, list(map(clean, names)))
