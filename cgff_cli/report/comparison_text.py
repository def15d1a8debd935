"""A comparison as a page for the terminal: what each method found, where it differs, how fast it came."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from rich.console import Group, RenderableType
from rich.text import Text

from cgff_cli.report.bench_text import TOLD_THE_ANSWER
from cgff_cli.report.table import FEW
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
    stabilities,
    verdict_words,
    verdicts,
)
from cgff_cli.rivals.task import AtResidual, AtShape
from cgff_cli.study.record import Comparison, Method

ALIGNMENTS = {
    "rigid": "nearest rigid motion, mirror image allowed",
    "affine": "nearest affine map",
    "none": "as it is",
}
"""How a method's shape was laid over CGFF's, in words."""

DIFFERENCES = {
    "nodes": "max_node_difference",
    "lengths": "max_length_difference",
    "force densities": "max_force_density_difference",
    "all distances": "distance_matrix_difference",
}
"""Title of a column -> the field it shows."""


def comparison_page(comparison: Comparison, full: bool = False) -> Iterator[RenderableType]:
    """Yield the page; full: every node and element, with lengths and force densities of all methods."""
    shown = [method for method in comparison.methods if method.X is not None]
    yield Text.assemble(heading(comparison.source), "  ", (_size(comparison), "dim"))
    yield Aligned(_outcomes(comparison.methods))
    if len(shown) > 1:
        yield Aligned(_differences(shown[1:]))
    if full or len(comparison.source.node_names) <= FEW:
        yield from _coordinates(comparison, shown)
    yield from _members(comparison, shown, full)
    words = "iterations and time until the residual, over the largest force, is within"
    yield _speed(words, {method.name: method.curve for method in comparison.methods})
    words = "and until the error in shape, over the structure's size, is within"
    yield _speed(words, {method.name: method.shape_curve for method in comparison.methods})
    yield fields(_notes(comparison))


def _size(comparison: Comparison) -> str:
    source = comparison.source
    return f"{len(source.node_names)} nodes, {source.element_count} elements, {clean(source.path)}"


def _outcomes(methods: Sequence[Method]) -> Iterator[Column]:
    yield Column("method", _of(methods, "name"))
    yield verdicts(_of(methods, "verdict"))
    yield stabilities(_of(methods, "stable"))
    yield column("residual", _of(methods, "residual_relative"), "{:.1e}".format)
    yield column("energy", _of(methods, "energy"), number)
    yield column("iterations", _of(methods, "iterations"))
    yield column("evaluations", _of(methods, "evaluations"))
    yield column("time", _of(methods, "seconds"), duration)


def _differences(methods: Sequence[Method]) -> Iterator[Column]:
    yield Column("against cgff", _of(methods, "name"))
    yield Column("laid over it by", [ALIGNMENTS[method.alignment] for method in methods])
    for title, name in DIFFERENCES.items():
        yield column(title, _of(methods, name), "{:.1e}".format)


def _of(methods: Sequence[Method], name: str) -> list[Any]:
    return [getattr(method, name) for method in methods]


def _coordinates(comparison: Comparison, shown: Sequence[Method]) -> Iterator[RenderableType]:
    """Yield one table per axis: a row per node, a column per method."""
    names = comparison.source.node_names
    shapes = [(method.name, method.X) for method in shown if method.X is not None]
    for k, axis in enumerate("xyz"[: comparison.source.dimension]):
        columns = [Column(name, numbers(X[:, k].tolist()), True) for name, X in shapes]
        yield Aligned([Column(axis, [clean(name) for name in names]), *columns])


def _members(comparison: Comparison, shown: Sequence[Method], full: bool) -> Iterator[RenderableType]:
    """Yield force densities by group of the methods that have their own; in full, all of every element."""
    if full:
        for title, name in (("length", "lengths"), ("force density", "force_densities")):
            yield Aligned([*_labels(comparison, title), *_values(shown, name)], keys=3)
        return
    own = [method for method in shown if method.name in ("cgff", *TOLD_THE_ANSWER)]
    groups = comparison.source.groups
    cuts = np.cumsum([0, *(len(group.EA) for group in groups)]).tolist()
    columns = [
        Column(method.name, [_span(method, slice(*rows)) for rows in pairwise(cuts)], True) for method in own
    ]
    yield Aligned([Column("force densities", [clean(group.name) for group in groups]), *columns])


def _labels(comparison: Comparison, title: str) -> Iterator[Column]:
    source = comparison.source
    ends = [pair for group in source.groups for pair in group.pairs.tolist()]
    yield Column(title, [clean(group.name) for group in source.groups for _ in group.EA])
    for which, end in enumerate(("start", "end")):
        yield Column(end, [clean(source.node_names[pair[which]]) for pair in ends])


def _values(shown: Sequence[Method], name: str) -> Iterator[Column]:
    for method in shown:
        yield Column(method.name, numbers(getattr(method, name).tolist()), True)


def _span(method: Method, rows: slice) -> str:
    """Return `least .. largest`, or one value where they look the same."""
    values = np.asarray(method.force_densities)[rows]
    low, high = numbers([float(values.min()), float(values.max())])
    return high if low == high else f"{low} .. {high}"


def _speed(words: str, curves: Mapping[str, Sequence[AtResidual | AtShape]]) -> Group:
    """Return a heading above the tolerances and a column of `iterations, time` per method."""
    tolerances = next(curve for curve in curves.values() if curve)
    table = [Column("within", [f"{point.tolerance:.0e}" for point in tolerances])]
    for name, curve in curves.items():
        if curve:
            table.append(Column(name, [_reached(point) for point in curve], True))
    return Group(Text(words, style="bold"), Aligned(table))


def _reached(point: AtResidual | AtShape) -> str:
    if point.seconds is None:
        return "-"
    time = f"{duration(point.seconds):>7}"
    return time if point.iterations is None else f"{point.iterations}, {time}"


def _notes(comparison: Comparison) -> Iterator[tuple[str, str]]:
    """Yield what a method that did not simply converge has to say, and what the reference is."""
    for method in comparison.methods:
        if method.verdict != "converged":
            yield method.name, clean(method.message)
    fitted = [method.name for method in comparison.methods if method.alignment == "affine"]
    if fitted:
        yield (
            "affine map",
            f"what knows neither EA nor rest lengths ({', '.join(fitted)}) finds a form up to an affine map, "
            "here fitted to cgff's answer: the errors tell how near that can be brought, the time not how "
            "fast it finds the shape",
        )
    reference = comparison.reference
    words = verdict_words(reference["verdict"])[0]
    yield (
        "reference",
        f"shape errors are taken against cgff at its rounding floor: {words}, "
        f"residual {reference['residual_relative']:.1e}",
    )
    once = any(method.verdict in ("time_limit", "failed") for method in comparison.methods)
    words = f"{comparison.options['repeat']} of each method, taken in turn; times are medians"
    yield "runs", words + ("; what failed or ran out of time was not run again" if once else "")
