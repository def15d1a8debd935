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


def check_matplotlib(what: str = "--plot") -> None:
    """Raise OptionError unless matplotlib is installed."""
    if find_spec("matplotlib") is None:
        raise OptionError(f"{what} needs matplotlib, which is not installed: pip install 'cgff-cli[plot]'")


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
        _lines(precision, comparison, "seconds", "tolerance")
        precision.set(xscale="log", yscale="log", title=comparison.source.name)
        precision.set(xlabel="seconds (median)", ylabel="residual / largest force")
        precision.invert_yaxis()
        _lines(iterations, comparison, "tolerance", "iterations")
        iterations.set(xscale="log", yscale="symlog", title="iterations against tolerance")
        iterations.set(xlabel="eps: residual / largest force", ylabel="iterations")
        iterations.invert_xaxis()
        iterations.set_ylim(bottom=0.0)
        iterations.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize="small")
    picture = io.BytesIO()
    figure.savefig(picture, format=path.rsplit(".", 1)[1].lower(), dpi=144)
    write_bytes(path, picture.getvalue())


def _lines(axes: Any, comparison: Comparison, across: str, upwards: str) -> None:
    """Draw one field of the curves against another, a line per method; one without points is named too."""
    for number, method in enumerate(comparison.methods):
        pairs = [(getattr(point, across), getattr(point, upwards)) for point in method.curve]
        points = [pair for pair in pairs if None not in pair]
        x, y = zip(*points, strict=True) if points else ((), ())
        label = method.name if points else f"{method.name}: never"
        style = {"marker": MARKERS[number % len(MARKERS)], "markersize": 4, "linewidth": 1.2}
        axes.plot(x, y, label=label, color=f"C{number}", **style)
    axes.grid(visible=True, which="major", alpha=0.3)
