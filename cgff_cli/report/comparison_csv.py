"""Comparisons as CSV: one row per scene and method, the curves as columns by tolerance."""

from collections.abc import Iterable, Iterator
from typing import Any

from cgff_cli.report.csv_out import columns
from cgff_cli.study.record import WRITTEN, Comparison

SCALARS = tuple(
    name
    for name in WRITTEN
    if name not in ("message", "nodes", "lengths", "force_densities", "curve", "shape_curve")
)


def comparisons(found: Iterable[Comparison]) -> Iterator[str]:
    """Yield the table: scene, name, the scalar fields, then iterations and seconds to each tolerance."""
    rows = [row for comparison in found for row in _rows(comparison)]
    return columns({name: [row.get(name) for row in rows] for name in dict.fromkeys(_names(rows))})


def _names(rows: list[dict[str, Any]]) -> Iterator[str]:
    for row in rows:
        yield from row


def _rows(comparison: Comparison) -> Iterator[dict[str, Any]]:
    for method in comparison.methods:
        row: dict[str, Any] = {"scene": comparison.scene["path"]}
        row |= {name: getattr(method, name) for name in SCALARS}
        for curve, of in ((method.curve, "residual"), (method.shape_curve, "shape")):
            for point in curve:
                row[f"iterations_to_{of}_{point.tolerance:.0e}"] = point.iterations
                row[f"seconds_to_{of}_{point.tolerance:.0e}"] = point.seconds
        yield row | {"message": method.message}
