"""One picture of a structure: struts thick, cables thin, force in colour, from the side or in its plane."""

from dataclasses import dataclass
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.hints import did_you_mean
from cgff_cli.report.drawing import Drawing

if TYPE_CHECKING:
    from matplotlib.axes import Axes

NAMED_NODES = 30
"""Nodes that are named; marks of more supports get smaller."""

FULL_WIDTH, FINE = 300, 3000
"""Elements that are drawn in full width; those from which on lines get thinner still."""

MOST_ARROWS = 150
"""Loads, and motions, that are drawn; of more, evenly chosen ones."""

PUSH, NOTHING, PULL = "#1f5fa8", "#b4b4b4", "#c8501e"
"""Blue, grey and orange, which the colour-blind tell apart; in print all but grey are dark."""

GHOST, INK, LOAD, MODE = "#c9c9c9", "#333333", "#2a7f62", "#7a3e9d"
VIEWS = {"front": (0.0, 0.0), "side": (90.0, 0.0), "top": (0.0, 90.0), "iso": (35.0, 25.0)}
"""Word -> degrees that the eye goes round the vertical, and up."""

MODE_REACH = 0.08
"""How far the node that moves most is drawn along a mode, over the size."""


def view_of(text: str) -> tuple[float, float]:
    """Return the angles of a view, a word or ROUND,UP in degrees; raises OptionError."""
    if text in VIEWS:
        return VIEWS[text]
    try:
        around, up = map(float, text.split(","))
    except ValueError:
        hint = did_you_mean(text, VIEWS, "it may be ROUND,UP in degrees or one of")
        raise OptionError(f"view {text!r} is none{hint}") from None
    return around, up


@dataclass(frozen=True)
class Eye:
    """Where a structure is looked at from: across, up and towards the eye, (3, d) rows."""

    axes: np.ndarray

    def seen(self, X: np.ndarray) -> np.ndarray:
        """Return (n, 2) places in the picture."""
        return np.asarray(X @ self.axes[:2].T)

    def depth(self, X: np.ndarray) -> np.ndarray:
        """Return (n,) distances towards the eye."""
        return np.asarray(X @ self.axes[2])


def eye_for(X: np.ndarray, view: tuple[float, float] | None) -> Eye:
    """Return the eye for a shape (n, d): z upwards, turned a little from its widest side; view: degrees."""
    if X.shape[1] == 2:
        return Eye(np.eye(3)[:, :2])
    flat = X[:, :2] - X[:, :2].mean(axis=0)
    widest = np.linalg.svd(flat, full_matrices=False)[2][0] if flat.any() else np.array([1.0, 0.0])
    heading = np.degrees(np.arctan2(widest[1], widest[0])) % 180.0 if view is None else 0.0
    around, up = np.radians((heading + VIEWS["iso"][0], 20.0) if view is None else view)
    across = np.array([np.cos(around), np.sin(around), 0.0])
    back = np.array([np.sin(around) * np.cos(up), -np.cos(around) * np.cos(up), np.sin(up)])
    return Eye(np.stack([across, np.cross(back, across), back]))


def draw_structure(
    drawing: Drawing, axes: "Axes", eye: Eye, mode: tuple[np.ndarray, str] | None = None
) -> None:
    """Draw a structure; mode: (n, d), largest motion 1, and what it is."""
    axes.set(aspect="equal")
    room = int(9 * axes.figure.bbox.width / axes.figure.dpi)
    told = [drawing.title, *([mode[1]] if mode else [])]
    axes.set_title("\n".join(fill(line, room) for line in told), fontsize="medium")
    axes.set_axis_off()
    if drawing.start is not None:
        _lines(axes, eye, drawing, drawing.start, colors=GHOST, linewidths=0.7)
    _elements(axes, eye, drawing)
    places = eye.seen(drawing.coordinates)
    _arrows(axes, places, eye.seen(drawing.loads), 0.09 * drawing.size, color=LOAD)
    if mode is not None:
        moved = drawing.coordinates + MODE_REACH * drawing.size * mode[0]
        _lines(axes, eye, drawing, moved, colors=MODE, linewidths=0.8, linestyles=(0, (4, 3)))
        _arrows(axes, places, eye.seen(mode[0]), MODE_REACH * drawing.size, color=MODE, towards=False)
    at = places[drawing.supports]
    mark = 7.0 * min(1.0, (NAMED_NODES / (len(at) or 1)) ** 0.5)
    axes.plot(at[:, 0], at[:, 1], "^", color="white", markeredgecolor=INK, markersize=mark, zorder=3)
    if len(places) <= NAMED_NODES:
        _names(axes, places, drawing)
    axes.autoscale_view()
    axes.margins(0.06)


def _elements(axes: "Axes", eye: Eye, drawing: Drawing) -> None:
    """Draw the elements, those behind first, and a scale of their forces."""
    from matplotlib.cm import ScalarMappable

    mid = drawing.coordinates[drawing.pairs].mean(axis=1)
    order = np.argsort(eye.depth(mid), kind="stable")
    thin = 1.0 if len(order) > FULL_WIDTH else 1.6
    thin *= min(1.0, (FINE / len(order)) ** 0.5)
    widths = np.where(drawing.struts, 2.6 * thin, thin)[order]
    dashes = [(0, (3, 2)) if slack else "solid" for slack in drawing.slack[order].tolist()]
    colors: Any = INK
    if drawing.forces is not None:
        scale, norm = _scale(drawing.forces)
        colors = scale(norm(drawing.forces[order]))
        bar = axes.figure.colorbar(
            ScalarMappable(norm, scale), ax=axes, shrink=0.6, label="force, tension > 0"
        )
        bar.ax.tick_params(labelsize="small")
    shown = drawing.pairs[order]
    _collection(
        axes, eye.seen(drawing.coordinates)[shown], colors=colors, linewidths=widths, linestyles=dashes
    )


def _scale(forces: np.ndarray) -> tuple[Any, Any]:
    """Return colours and what maps forces to them: grey is none, either end as strong as the other."""
    from matplotlib.colors import LinearSegmentedColormap, Normalize, TwoSlopeNorm

    least, greatest = float(forces.min()), float(forces.max())
    most = max(abs(least), abs(greatest)) or 1.0
    if least < 0.0 < greatest:
        return LinearSegmentedColormap.from_list("force", [PUSH, NOTHING, PULL]), TwoSlopeNorm(
            0.0, least, greatest
        )
    if greatest > 0.0:
        return LinearSegmentedColormap.from_list("pull", [NOTHING, PULL]), Normalize(0.0, most)
    return LinearSegmentedColormap.from_list("push", [PUSH, NOTHING]), Normalize(-most, 0.0)


def _lines(axes: "Axes", eye: Eye, drawing: Drawing, X: np.ndarray, **how: Any) -> None:
    _collection(axes, eye.seen(X)[drawing.pairs], **how)


def _collection(axes: "Axes", segments: np.ndarray, **how: Any) -> None:
    from matplotlib.collections import LineCollection

    axes.add_collection(LineCollection(list(segments), capstyle="round", **how))


def _arrows(
    axes: "Axes", places: np.ndarray, vectors: np.ndarray, reach: float, color: str, towards: bool = True
) -> None:
    """Draw vectors (n, 2) at nodes, the largest `reach` long; towards: their heads at the nodes."""
    sizes = np.linalg.norm(vectors, axis=1)
    drawn = np.flatnonzero(sizes > 1e-3 * sizes.max())
    if not len(drawn) or not sizes.max():
        return
    many = len(drawn) > MOST_ARROWS
    if many:
        drawn = drawn[np.linspace(0, len(drawn) - 1, MOST_ARROWS).astype(int)]
        reach *= 0.5
    arrows = vectors[drawn] * (reach / sizes.max())
    at = places[drawn] - (arrows if towards else 0.0)
    how: dict[str, Any] = {"angles": "xy", "scale_units": "xy", "scale": 1.0, "zorder": 4}
    how |= {"width": 0.0015, "alpha": 0.6} if many else {"width": 0.003}
    axes.quiver(*at.T, *arrows.T, color=color, **how)
    axes.update_datalim(np.concatenate([at, at + arrows]))


def _names(axes: "Axes", places: np.ndarray, drawing: Drawing) -> None:
    """Name the nodes, each on the side away from the middle."""
    middle = places.mean(axis=0)
    for name, place in zip(drawing.node_names, places, strict=True):
        side = np.sign(place - middle)
        how: dict[str, Any] = {"textcoords": "offset points", "fontsize": "small", "color": INK}
        how |= {"ha": "left" if side[0] >= 0 else "right", "va": "bottom" if side[1] >= 0 else "top"}
        axes.annotate(name, place, xytext=4 * side, **how)
