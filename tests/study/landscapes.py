"""Small scenes with several stable shapes, which tests and studies share."""

from itertools import combinations, pairwise

import numpy as np

import cgff_cli


def as_struts(scene: "cgff_cli.Scene") -> "cgff_cli.Scene":
    """Return a scene with cables that can push."""
    from dataclasses import replace

    return replace(scene, groups=tuple(replace(group, kind="strut") for group in scene.groups))


def unstrained(nodes: dict[str, list[float]], pairs: list[list[str]], **more: object) -> "cgff_cli.Scene":
    """Return bars between nodes that are as long as they would be."""
    rest = [float(np.linalg.norm(np.subtract(nodes[a], nodes[b]))) for a, b in pairs]
    bars = {"kind": "strut", "EA": 100.0, "rest_length": rest, "pairs": pairs}
    return cgff_cli.from_dict({"law": "hooke", "nodes": nodes, "elements": {"bars": bars}, **more})


def truss(load: float = 0.0, rise: float = 0.5) -> "cgff_cli.Scene":
    """Return von Mises' truss: two bars from (-1, 0) and (1, 0) to a top that may snap through."""
    nodes = {"left": [-1.0, 0.0], "right": [1.0, 0.0], "top": [0.0, rise]}
    more: dict[str, object] = {"loads": {"top": [0.0, -load]}} if load else {}
    return unstrained(
        nodes, [["left", "top"], ["top", "right"]], supports={"left": "xy", "right": "xy"}, **more
    )


def row_of_trusses(count: int) -> "cgff_cli.Scene":
    """Return trusses side by side, joined at their feet: each is up or down whatever the others are."""
    feet = {f"foot{i}": [2.0 * i, 0.0] for i in range(count + 1)}
    tops = {f"top{i}": [2.0 * i + 1.0, 0.4 + 0.05 * i] for i in range(count)}
    pairs = [[foot, f"top{i}"] for i in range(count) for foot in (f"foot{i}", f"foot{i + 1}")]
    return unstrained({**feet, **tops}, pairs, supports=dict.fromkeys(feet, "xy"))


def tetrahedron(**more: object) -> "cgff_cli.Scene":
    """Return six bars between four nodes, no two alike."""
    nodes = {"a": [0.0, 0.0, 0.0], "b": [1.0, 0.1, 0.0], "c": [0.2, 1.2, 0.0], "d": [0.3, 0.2, 1.0]}
    return unstrained(nodes, [list(pair) for pair in combinations(nodes, 2)], **more)


def kresling(twist: float = 0.4, height: float = 1.0) -> "cgff_cli.Scene":
    """Return a Kresling module: two triangles, one above the other and turned, joined by six bars.

    It has a second shape of the same lengths, turned by pi - 2 pi / 3 - twist, as the difference of the two
    sorts of bars is cos(twist) - cos(twist + 2 pi / 3) = 2 sin(twist + pi / 3) sin(pi / 3).
    """
    angles = 2.0 * np.pi / 3.0 * np.arange(3)
    below = np.stack((np.cos(angles), np.sin(angles), 0.0 * angles), axis=1)
    above = np.stack((np.cos(angles + twist), np.sin(angles + twist), height + 0.0 * angles), axis=1)
    nodes = {f"{level}{i}": X[i].tolist() for level, X in (("b", below), ("t", above)) for i in range(3)}
    rings = [[f"{level}{i}", f"{level}{(i + 1) % 3}"] for level in "bt" for i in range(3)]
    rises = [[f"b{(i + k) % 3}", f"t{i}"] for k in (0, 2) for i in range(3)]
    return unstrained(nodes, rings + rises)


def dome(load: float = 0.0) -> "cgff_cli.Scene":
    """Return a star dome of 24 bars on six supports, maybe with a load on its top."""
    nodes = {"top": [0.0, 0.0, 2.0]}
    for i in range(6):
        a, b = np.pi / 3.0 * i, np.pi / 3.0 * (i + 0.5)
        nodes[f"m{i}"] = [5.0 * np.cos(a), 5.0 * np.sin(a), 1.4]
        nodes[f"s{i}"] = [10.0 * np.cos(b), 10.0 * np.sin(b), 0.0]
    ring = [*(f"m{i}" for i in range(6)), "m0"]
    pairs = [["top", f"m{i}"] for i in range(6)] + [list(pair) for pair in pairwise(ring)]
    pairs += [[m, f"s{i}"] for i in range(6) for m in (ring[i], ring[i + 1])]
    more = {"loads": {"top": [0.0, 0.0, -load]}} if load else {}
    return unstrained(nodes, pairs, supports={f"s{i}": "xyz" for i in range(6)}, **more)
