"""Comparisons drawn: residual against time (work-precision), and iterations against tolerance."""

from collections.abc import Sequence
from importlib.util import find_spec
from typing import Any

from cgff_cli.errors import OptionError
from cgff_cli.report.files import write_bytes
from cgff_cli.study.record import Comparison

WIDTH, HEIGHT = 11.0, 4.2
"""Inches of a row of two diagrams."""

MARKERS = "osD^v<>Ph"


def check_matplotlib() -> None:
    """Raise OptionError unless matplotlib is installed."""
    if find_spec("matplotlib") is None:
        raise OptionError("--plot needs matplotlib, which is not installed: pip install 'cgff-cli[plot]'")


def draw(found: Sequence[Comparison], path: str) -> None:
    """Write a picture, .png or .svg, of a row of diagrams per scene; raises OptionError, CgffError."""
    check_matplotlib()
    import io

    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(WIDTH, HEIGHT * len(found)), layout="constrained")
    FigureCanvasAgg(figure)
    rows = figure.subplots(len(found), 2, squeeze=False)
    for comparison, (precision, iterations) in zip(found, rows, strict=True):
        _work_precision(precision, comparison)
        _iterations(iterations, comparison)
    picture = io.BytesIO()
    figure.savefig(picture, format=path.rsplit(".", 1)[1].lower(), dpi=144)
    write_bytes(path, picture.getvalue())


def _work_precision(axes: Any, comparison: Comparison) -> None:
    """Draw the tolerance reached against time, a line per method."""
    for number, method in enumerate(comparison.methods):
        points = [(p.seconds, p.tolerance) for p in method.curve if p.seconds is not None]
        _line(axes, number, method.name, points)
    axes.set(xscale="log", yscale="log", title=comparison.source.name)
    axes.set(xlabel="seconds (median)", ylabel="residual / largest force")
    axes.invert_yaxis()
    _finished(axes)


def _iterations(axes: Any, comparison: Comparison) -> None:
    """Draw iterations against the tolerance, as the paper does, a line per method."""
    for number, method in enumerate(comparison.methods):
        points = [(p.tolerance, p.iterations) for p in method.curve if p.iterations is not None]
        _line(axes, number, method.name, points)
    axes.set(xscale="log", yscale="symlog", title="iterations against tolerance")
    axes.set(xlabel="eps: residual / largest force", ylabel="iterations")
    axes.invert_xaxis()
    axes.set_ylim(bottom=0.0)
    _finished(axes)
    axes.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize="small")


def _line(axes: Any, number: int, name: str, points: Sequence[tuple[float, float]]) -> None:
    """Draw a method's points; one that has none is named all the same."""
    style = {"marker": MARKERS[number % len(MARKERS)], "markersize": 4, "linewidth": 1.2}
    x, y = zip(*points, strict=True) if points else ((), ())
    axes.plot(x, y, label=name if points else f"{name}: never", color=f"C{number}", **style)


def _finished(axes: Any) -> None:
    axes.grid(visible=True, which="major", alpha=0.3)
