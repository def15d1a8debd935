"""One page of HTML that shows structures in a browser, without a network: turn, zoom, hover, switch.

The page draws with three.js, read from the package jupyter_threejs_sage, and by view_world.js and view.js
in view.html beside this file. Its policy lets nothing be fetched, and no script run but these.
"""

import base64
import hashlib
import html
import json
import re
from collections.abc import Iterator, Sequence
from importlib.resources import files
from importlib.util import find_spec
from typing import Any, NamedTuple

import numpy as np

from cgff_cli.as_given import analyse
from cgff_cli.errors import OptionError
from cgff_cli.report.drawing import Drawing, drawing_of, mode_of
from cgff_cli.report.picture import eye_for
from cgff_cli.result import Result

LIBRARY = "jupyter_threejs_sage", "static/r130/three.min.js"
"""The package that three.js comes in, and where in it."""

LEAST_LOAD = 1e-3
"""Share of the largest load from which a load is drawn."""


class Exhibit(NamedTuple):
    """A drawing to be shown; modes: motions (n, d), largest 1, each with what it is; told: a sentence."""

    drawing: Drawing
    modes: list[tuple[np.ndarray, str]]
    told: str


def check_threejs() -> None:
    """Raise OptionError unless three.js is installed."""
    if find_spec(LIBRARY[0]) is None:
        raise OptionError("cgff view needs three.js, which is not installed: pip install 'cgff-cli[view]'")


def exhibit_of(result: Result, modes: int) -> Exhibit:
    """Return what is shown of a result, with the motions that `cgff analyse --modes` tells; 0: none."""
    found = analyse(result, modes=modes)
    drawing = drawing_of(result)
    if not modes:
        return Exhibit(drawing, [], found.message)
    stability, count = found.analysis["stability"], len(found.analysis["modes"] or [])
    told = f"{found.message}; {stability}" if stability else found.message
    return Exhibit(drawing, [mode_of(found, number) for number in range(1, count + 1)], told)


def page_of(shown: Sequence[Exhibit]) -> str:
    """Return the page; drawings of the same nodes share one frame, so that their shapes can be compared."""
    library = files(LIBRARY[0]).joinpath(LIBRARY[1]).read_text("utf-8")
    style, frame, script = _beside("view.css"), _beside("view.html"), _beside("view_world.js", "view.js")
    scripts = " ".join(map(_digest, (library, script)))
    parts = {
        "policy": f"default-src 'none'; script-src {scripts}; style-src {_digest(style)}",
        "title": html.escape(shown[0].drawing.title),
        "style": style,
        "data": json.dumps(_data(shown), separators=(",", ":"), allow_nan=False).replace("<", "\\u003c"),
        "library": library,
        "script": script,
    }
    return re.sub("@([a-z]+)@", lambda found: parts[found[1]], frame)


def _beside(*names: str) -> str:
    return "\n".join(files("cgff_cli.report").joinpath(name).read_text("utf-8") for name in names)


def _digest(text: str) -> str:
    """Return what lets a policy know a text."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def _data(shown: Sequence[Exhibit]) -> dict[str, Any]:
    """Return what view.js reads: frames, each of some nodes, and results, each in a frame."""
    titles = [exhibit.drawing.title for exhibit in shown]
    kept: dict[tuple[Any, ...], list[int]] = {}
    for number, exhibit in enumerate(shown):
        X = exhibit.drawing.coordinates
        kept.setdefault((X.shape[1], exhibit.drawing.node_names), []).append(number)
    results: dict[int, Any] = {}
    frames = []
    for k, (key, numbers) in enumerate(kept.items()):
        frame, middle, size = _frame(key[1], [shown[number].drawing for number in numbers])
        frames.append(frame)
        for number in numbers:
            title = titles[number]
            own = f" ({number + 1})" if titles.count(title) > 1 else ""
            results[number] = {"title": title + own, "frame": k, **_result(shown[number], middle, size)}
    return {"frames": frames, "results": [results[number] for number in range(len(shown))]}


def _frame(names: tuple[str, ...], drawings: list[Drawing]) -> tuple[dict[str, Any], np.ndarray, float]:
    """Return a frame, its middle (3,) and its size, the diagonal of the box around all its shapes."""
    X = np.concatenate([_in_space(drawing.coordinates) for drawing in drawings])
    least, greatest = X.min(axis=0), X.max(axis=0)
    middle, size = (least + greatest) / 2.0, float(np.linalg.norm(greatest - least)) or 1.0
    shape = drawings[0].coordinates
    is_plane = shape.shape[1] == 2
    frame = {
        "names": names,
        "middle": middle.tolist(),
        "size": size,
        "columns": [0, 2] if is_plane else [0, 1, 2],
        "eye": [0.0, -1.0, 0.0] if is_plane else eye_for(shape, None).axes[2].tolist(),
    }
    return frame, middle, size


def _in_space(X: np.ndarray) -> np.ndarray:
    """Return (n, 3) places or motions; a plane stands upright, its y upwards."""
    return X if X.shape[1] == 3 else np.insert(X, 1, 0.0, axis=1)


def _result(exhibit: Exhibit, middle: np.ndarray, size: float) -> dict[str, Any]:
    drawing = exhibit.drawing
    loads = np.abs(drawing.loads).max(axis=1)
    loaded = np.flatnonzero(loads > LEAST_LOAD * loads.max())

    def placed(X: np.ndarray) -> str:
        return _packed((_in_space(X) - middle) / size)

    return {
        "told": exhibit.told,
        "groups": [
            {"name": name, "struts": bool(drawing.struts[drawing.owners == number].any())}
            for number, name in enumerate(drawing.group_names)
        ],
        "places": placed(drawing.coordinates),
        "start": None if drawing.start is None else placed(drawing.start),
        "pairs": _packed(drawing.pairs, "<u4"),
        "owners": _packed(drawing.owners, "<u4"),
        "slack": _packed(drawing.slack, "u1"),
        "lengths": _scaled(drawing.lengths),
        "fields": [{"name": name, **_scaled(values)} for name, values in _fields(drawing)],
        "supports": _packed(drawing.supports, "<u4"),
        "loaded": _packed(loaded, "<u4"),
        "loads": drawing.loads[loaded].tolist(),
        "modes": [{"name": name, "shape": _packed(_in_space(shape))} for shape, name in exhibit.modes],
    }


def _fields(drawing: Drawing) -> Iterator[tuple[str, np.ndarray]]:
    for name in ("forces", "force_densities", "strains"):
        values = getattr(drawing, name)
        if values is not None:
            yield {"forces": "force", "force_densities": "force density", "strains": "strain"}[name], values


def _scaled(values: np.ndarray) -> dict[str, Any]:
    """Return values over the largest of them, which may be out of the range of float32; nan where none."""
    finite = values[np.isfinite(values)]
    least, greatest = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 0.0)
    most = max(abs(least), abs(greatest)) or 1.0
    return {"least": least, "greatest": greatest, "most": most, "values": _packed(values / most)}


def _packed(values: np.ndarray, kind: str = "<f4") -> str:
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()
