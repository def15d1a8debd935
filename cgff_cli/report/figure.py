"""Pictures as files: what is drawn, on which paper, in which form; matplotlib is imported here and below only."""

import io
from importlib.util import find_spec
from typing import Any, NamedTuple

from cgff_cli import pipeline
from cgff_cli.as_given import Analysis, analyse
from cgff_cli.cases import solve_cases
from cgff_cli.errors import OptionError
from cgff_cli.report.drawing import drawing_of, mode_of
from cgff_cli.report.files import write_bytes
from cgff_cli.result import Result
from cgff_cli.scene.read import load

WIDTH, HEIGHT = 8.0, 6.0
"""Inches."""


class Asked(NamedTuple):
    """What of a structure is drawn; see `cgff plot`."""

    view: tuple[float, float] | None = None
    case: str | None = None
    as_given: bool = False
    mode: int | None = None
    history: bool = False


def check_matplotlib(what: str) -> None:
    """Raise OptionError unless matplotlib is installed."""
    if find_spec("matplotlib") is None:
        raise OptionError(f"{what} needs matplotlib, which is not installed: pip install 'cgff-cli[plot]'")


def result_of(path: str, asked: Asked) -> Result:
    """Return what is drawn of the file at a path: a result, a geometry as it is, or a scene solved."""
    scene = load(path, results=True)
    if asked.as_given or scene.is_geometry or scene.is_answer:
        return analyse(scene).result
    if asked.case is not None:
        return next(solve_cases(scene, [asked.case]))
    return pipeline.solve(scene)


def write_picture(result: Result, asked: Asked, path: str, form: str) -> None:
    """Write the picture of a result; raises OptionError for a mode that is not there, CgffError."""
    figure = _paper(1)
    axes = figure.subplots()
    if asked.history:
        from cgff_cli.report.curves import draw_history

        draw_history(result.history, f"{result.source.name}: {result.message}", axes)
    else:
        from cgff_cli.report.picture import draw_structure

        drawing = drawing_of(result, result.source.is_geometry)
        mode = None
        if asked.mode is not None:
            mode, told = mode_of(_analysis(result, asked.mode), asked.mode)
            axes.set_xlabel(told)
        draw_structure(drawing, axes, asked.view, mode)
    _write(figure, path, form)


def write_sweep(rows: str, path: str, form: str) -> None:
    """Write the curves of a sweep; raises OptionError, CgffError."""
    from cgff_cli.report.curves import draw_sweep, read_rows

    swept, found, table = read_rows(rows)
    found = found or ["energy"]
    figure = _paper(len(found))
    draw_sweep(swept, found, table, figure.subplots(len(found), 1, squeeze=False)[:, 0])
    _write(figure, path, form)


def _analysis(result: Result, count: int) -> Analysis:
    return analyse(result, modes=count)


def _paper(rows: int) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, HEIGHT if rows == 1 else 2.4 * rows), layout="constrained")
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
