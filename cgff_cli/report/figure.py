"""Pictures as files: what is drawn, on which paper, in which form."""

import io
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from cgff_cli.as_given import analyse
from cgff_cli.errors import OptionError
from cgff_cli.hints import meant_or_all
from cgff_cli.report.drawing import drawing_of, mode_of
from cgff_cli.report.files import write_bytes
from cgff_cli.result import Result

WIDTH, HEIGHT = 8.0, 6.0
"""Inches of curves, and most of a structure's height."""

WIDEST, NARROWEST, BESIDE = 11.0, 3.5, 1.4
"""Inches of a structure's picture, and of the scale beside it."""


class Shown(NamedTuple):
    """What of a structure is drawn; see `cgff plot`."""

    view: tuple[float, float] | None = None
    mode: int | None = None
    history: bool = False


def write_picture(result: Result, asked: Shown, path: str, form: str) -> None:
    """Write the picture of a result; raises OptionError for a mode or history not there, CgffError."""
    if asked.history:
        from cgff_cli.report.curves import draw_history, history_of

        figure = _paper(WIDTH, HEIGHT)
        history, verdict = history_of(result)
        draw_history(history, f"{result.source.name}: {verdict}", figure.subplots())
    else:
        from cgff_cli.report.picture import draw_structure, eye_for

        drawing = drawing_of(result)
        mode = None if asked.mode is None else mode_of(analyse(result, modes=asked.mode), asked.mode)
        eye = eye_for(drawing.coordinates, asked.view)
        figure = _paper(*_size_for(np.ptp(eye.seen(drawing.coordinates), axis=0)))
        draw_structure(drawing, figure.subplots(), eye, mode)
    _write(figure, path, form)


def _size_for(extent: np.ndarray) -> tuple[float, float]:
    """Return inches of the paper for a picture of such an extent."""
    across, up = np.maximum(extent, 1e-3 * extent.max() or 1.0)
    most = min(2.0 * HEIGHT, max(HEIGHT, up / across))  # a tower gets taller paper
    room = min((WIDEST - BESIDE) / across, (most - 0.6) / up)
    return max(NARROWEST, across * room) + BESIDE, max(NARROWEST, up * room) + 0.6


def write_sweep(rows: str, path: str, form: str, x: str | None = None, y: Sequence[str] = ()) -> None:
    """Write the curves of a sweep; x: the column across, y: those drawn. Raises OptionError, CgffError."""
    from cgff_cli.report.curves import draw_sweep, read_rows

    swept, found, table = read_rows(rows)
    for name in (*y, *([] if x is None else [x])):
        if name not in table[0]:
            raise OptionError(f"{rows} has no column {name!r}{meant_or_all(name, list(table[0]))}")
    found = list(y) or [name for name in found if name != x] or ["energy"]
    figure = _paper(WIDTH, max(HEIGHT / 1.5, 2.4 * len(found)))
    draw_sweep(swept, found, table, figure.subplots(len(found), 1, squeeze=False)[:, 0], x)
    _write(figure, path, form)


def _paper(width: float, height: float) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _write(figure: Any, path: str, form: str) -> None:
    """Write a figure, the same bytes for the same figure."""
    from matplotlib import rc_context

    picture = io.BytesIO()
    nameless = {"png": {"Software": None}, "svg": {"Date": None}, "pdf": {"CreationDate": None}}[form]
    with rc_context({"svg.hashsalt": "cgff"}):
        figure.savefig(picture, format=form, dpi=144, metadata=nameless)
    write_bytes(path, picture.getvalue())
