"""Scenes a hostile user would write: one function a kind, each from a random generator, as plain mappings."""

from typing import Any

import numpy as np

Scene = dict[str, Any]


def some_body(rng: np.random.Generator, d: int, n: int, extra: int) -> Scene:
    """Return a chain of n nodes in random places and `extra` elements between any two of them."""
    X = rng.uniform(-1.0, 1.0, (n, d))
    pairs = [(i, i + 1) for i in range(n - 1)]
    pairs += [tuple(rng.choice(n, 2, replace=False).tolist()) for _ in range(extra)]
    law = str(rng.choice(["paper", "hooke"]))
    rests = [0.0, 1e-3, 1.0, float(rng.uniform(0.2, 2.0))][law == "hooke" :]
    groups = {
        f"e{row}": {
            "kind": str(rng.choice(["cable", "strut"])),
            "EA": float(10.0 ** rng.integers(-2, 4)),
            "rest_length": float(rng.choice(rests)),
            "pairs": [[f"n{i}", f"n{j}"]],
        }
        for row, (i, j) in enumerate(pairs)
    }
    return {"law": law, "nodes": {f"n{i}": x for i, x in enumerate(X.tolist())}, "elements": groups}


def body(rng: np.random.Generator, least: int = 3, most: int = 8) -> Scene:
    """Return a body of `least` to `most` nodes."""
    n = int(rng.integers(least, most + 1))
    return some_body(rng, int(rng.integers(2, 4)), n, int(rng.integers(0, 2 * n)))


def hold(rng: np.random.Generator, scene: Scene, share: float, whole: float) -> Scene:
    """Hold the first node and a share of the others, `whole` of them in every direction."""
    axes = "xyz"[: len(scene["nodes"]["n0"])]
    held = {"n0": axes}
    for name in list(scene["nodes"])[1:]:
        if rng.random() < share:
            held[name] = axes if rng.random() < whole else str(rng.choice(list(axes)))
    return scene | {"supports": held}


def load(rng: np.random.Generator, scene: Scene, low: float, high: float) -> Scene:
    """Load half of the nodes with 10^low to 10^high."""
    d = len(scene["nodes"]["n0"])
    names = [name for name in scene["nodes"] if rng.random() < 0.5]
    return scene | {
        "loads": {a: (rng.normal(size=d) * 10.0 ** rng.uniform(low, high)).tolist() for a in names}
    }


def moved(scene: Scene, change: Any) -> Scene:
    """Return the scene with a function applied to its (n, d) coordinates."""
    X = change(np.array(list(scene["nodes"].values())))
    return scene | {"nodes": dict(zip(scene["nodes"], X.tolist(), strict=True))}


def changed(scene: Scene, **values: Any) -> Scene:
    """Return the scene with fields of its groups set; a function gets the old value."""
    groups = {
        name: group | {field: new(group[field]) if callable(new) else new for field, new in values.items()}
        for name, group in scene["elements"].items()
    }
    return scene | {"elements": groups}


def few(rng):
    scene = some_body(rng, int(rng.integers(2, 4)), int(rng.integers(2, 4)), int(rng.integers(0, 2)))
    return hold(rng, scene, 0.3, 0.3) if rng.random() < 0.6 else scene


def free(rng):
    return body(rng)


def tied(rng):
    return load(rng, hold(rng, body(rng), 0.4, 0.6), -2.0, 2.0)


def rollers(rng):
    return load(rng, hold(rng, body(rng), 0.6, 0.1), -2.0, 1.0)


def coincident(rng):
    scene = moved(body(rng), lambda X: np.round(X))
    return hold(rng, scene, 0.2, 0.5) if rng.random() < 0.7 else scene


def duplicate(rng):
    scene = hold(rng, body(rng), 0.2, 0.7)
    twice = {f"{name}again": group for name, group in scene["elements"].items() if rng.random() < 0.5}
    return scene | {"elements": scene["elements"] | twice}


def flat(rng):
    return load(
        rng, hold(rng, moved(body(rng), lambda X: X * ([1.0] * (X.shape[1] - 1) + [0.0])), 0.3, 0.6), -2, 0
    )


def collinear(rng):
    return hold(rng, moved(body(rng), lambda X: np.outer(X[:, 0], rng.normal(size=X.shape[1]))), 0.2, 0.5)


def units(rng):
    scale, stiff = 10.0 ** rng.integers(-9, 10, 2).astype(float)
    scene = changed(hold(rng, body(rng), 0.3, 0.6), rest_length=lambda l: l * scale, EA=lambda k: k * stiff)
    return moved(scene, lambda X: X * scale)


def offset(rng):
    return load(
        rng, hold(rng, moved(body(rng), lambda X: X + 10.0 ** rng.integers(2, 8)), 0.3, 0.6), -2.0, 1.0
    )


def slack(rng):
    return changed(hold(rng, body(rng), 0.2, 0.7), kind="cable", rest_length=lambda l: 3.0 + l)


def huge_loads(rng):
    return load(rng, hold(rng, body(rng), 0.3, 0.7), 4.0, 9.0)


def tiny_loads(rng):
    return load(rng, hold(rng, body(rng), 0.3, 0.7), -16.0, -8.0)


def no_rest(rng):
    scene = changed(hold(rng, body(rng), 0.3, 0.6), rest_length=0.0)
    return scene | {"law": "paper"}


def shrinking(rng):
    return changed(body(rng, 2, 5), rest_length=1e-3, kind="cable")


def isolated(rng):
    scene = hold(rng, body(rng), 0.3, 0.6)
    d = len(scene["nodes"]["n0"])
    alone = {"nodes": scene["nodes"] | {"alone": rng.normal(size=d).tolist()}}
    return scene | alone | {"supports": scene["supports"] | {"alone": str(rng.choice(["x", "y", "xy"]))}}


def ring(rng):
    """A ring of struts between held nodes, under a load near snapping through."""
    n, rise = int(rng.integers(3, 7)), rng.uniform(0.02, 0.6)
    turns = np.arange(n) * 2.0 * np.pi / n
    rim = {f"r{i}": [float(np.cos(a)), float(np.sin(a)), 0.0] for i, a in enumerate(turns)}
    pairs = [[name, "n0"] for name in rim]
    strut = {"kind": "strut", "EA": 1.0, "rest_length": float(np.sqrt(1.0 + rise**2)), "pairs": pairs}
    snap = n * rise**3 * rng.choice([0.1, 0.38, 0.3849, 0.39, 1.0])
    return {
        "law": "paper",
        "nodes": {"n0": [0.0, 0.0, rise], **rim},
        "elements": {"s": strut},
        "supports": dict.fromkeys(rim, "xyz"),
        "loads": {"n0": [0.0, 0.0, float(-snap)]},
    }


KINDS = {
    make.__name__: make
    for make in (
        few, free, tied, rollers, coincident, duplicate, flat, collinear, units, offset, slack, huge_loads,
        tiny_loads, no_rest, shrinking, isolated, ring,
    )
}  # fmt: skip


def attack(seed: int) -> tuple[str, Scene]:
    """Return the kind and the scene of a seed, solve options included."""
    rng = np.random.default_rng(seed)
    kind = list(KINDS)[seed % len(KINDS)]
    scene = KINDS[kind](rng)
    tolerance = 1e-300 if rng.random() < 0.03 else float(10.0 ** rng.uniform(-14.0, -4.0))
    solver: Scene = {"tolerance": tolerance} if rng.random() < 0.6 else {}
    way = rng.random()
    if way < 0.08:
        solver["method"] = "table1"
    elif way < 0.2:
        solver["objective"] = "residual"
    elif way < 0.23:
        solver["preconditioner"] = "none"
    return kind, scene | ({"solver": solver} if solver else {})
