"""Curves: how a run came to its end, and what a sweep found."""

import csv
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from cgff_cli.errors import CgffError, OptionError
from cgff_cli.report.plots import MARKERS
from cgff_cli.result import Result

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HISTORY = ("iteration", "residual_max", "gradient_norm")
"""The column along a history's curves, and the curves."""

FALL_LINE = "an equilibrium is lost"
"""What the line says that stands where a path fell."""

MOST_CURVES = 9
"""Values of a second swept number that are a curve each."""


def history_of(result: Result) -> tuple[Mapping[str, Sequence[Any]], str]:
    """Return how a solve went and its verdict, as the file of a result tells it; raises OptionError."""
    answer = result.source.answer
    history: Any = result.history if answer is None else answer["history"]
    columns = [history.get(name) for name in HISTORY] if isinstance(history, dict) else []
    sizes = {len(own) if isinstance(own, list) and _are_numbers(own) else 0 for own in columns}
    if len(sizes) != 1 or 0 in sizes:
        raise OptionError(f"--history: {result.source.path} tells none; a scene is solved, not one as given")
    return history, str(result.verdict if answer is None else answer["verdict"])


def _are_numbers(values: Sequence[object]) -> bool:
    """Return whether all are numbers; null stands for what is not finite."""
    return all(value is None or (isinstance(value, (int, float))) for value in values)


def draw_history(history: Mapping[str, Sequence[Any]], title: str, axes: "Axes") -> None:
    """Draw residual and gradient against iterations."""
    for number, name in enumerate(HISTORY[1:]):
        values = np.array(history[name], dtype=float)
        shown = np.where(values > 0.0, values, np.nan)
        axes.plot(history["iteration"], shown, label=name, color=f"C{number}", linestyle=("-", "--")[number])
    axes.set(yscale="log", xlabel="iteration", title=title)
    axes.grid(visible=True, alpha=0.3)
    axes.legend()


def read_rows(path: str) -> tuple[list[str], list[str], list[dict[str, str]]]:
    """Return the swept columns, the others that hold numbers, and the rows of a sweep; raises OptionError."""
    try:
        with open(path, encoding="utf-8", newline="") as file:
            reader = csv.DictReader(file)
            rows, names = list(reader), list(reader.fieldnames or [])
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise CgffError(f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}") from error
    if "verdict" not in names or not names.index("verdict") or not rows:
        raise OptionError(
            f"{path}: is no table of rows that `cgff sweep -o rows.csv` writes, with its header"
        )
    found = names[names.index("energy") + 1 :] if "energy" in names else []
    return names[: names.index("verdict")], [name for name in found if name not in ("jump", "lost")], rows


def draw_sweep(
    swept: Sequence[str],
    found: Sequence[str],
    rows: Sequence[Mapping[str, str]],
    axes: Any,
    across: str | None = None,
) -> None:
    """Draw what was found against the first swept number, a curve for each value of the second, if few.

    across: the column to draw it against instead; ways of nodes against each other have one scale.
    Of a path, a curve ends before a row in which an equilibrium was lost, and a line tells where that was.
    """
    first, others = across or swept[0], swept[1:]
    values = list(dict.fromkeys(tuple(row[name] for name in others) for row in rows))
    is_curve = len(values) <= MOST_CURVES
    for own, name in zip(axes, found, strict=True):
        for number, value in enumerate(values if is_curve else [()]):
            mine = [row for row in rows if not is_curve or tuple(row[other] for other in others) == value]
            told = ", ".join(f"{other} = {float(part):g}" for other, part in zip(others, value, strict=False))
            x, y = (np.array([_number(row[column], row) for row in mine]) for column in (first, name))
            style = "-" if is_curve and np.all(np.diff(x[np.isfinite(x)]) != 0.0) else ""
            mark = MARKERS[number % len(MARKERS)]
            lost = np.array([_float(row.get("lost")) for row in mine])
            x, y = (np.insert(column, np.flatnonzero(np.isfinite(lost)), np.nan) for column in (x, y))
            own.plot(x, y, f"{mark}{style}", label=told or None, markersize=3.5, linewidth=1.1)
            for nth, there in enumerate([] if across else lost[np.isfinite(lost)].tolist()):
                own.axvline(there, color="0.4", linestyle=":", label=None if nth else FALL_LINE)
        is_way = first.startswith("node:") and name.startswith("node:")
        own.set(xlabel=first, ylabel=name, aspect="equal" if is_way else "auto")
        own.grid(visible=True, alpha=0.3)
        if own.get_legend_handles_labels()[1]:
            own.legend(fontsize="small")


def _number(text: str, row: Mapping[str, str]) -> float:
    """Return a number of a row; NaN where there is none, or the row did not converge."""
    return _float(text) if row["converged"] == "true" else np.nan


def _float(text: str | None) -> float:
    try:
        return float(text or "nan")
    except ValueError:
        return np.nan
