"""What a well-formed scene may still get wrong: loose nodes, loads nothing can balance, doubles."""

from collections.abc import Sequence

import numpy as np

from cgff_cli.scene.findings import Findings, first_few
from cgff_cli.scene.scene import AXES, Group

_SPARSE_FROM = 5000
ROUNDING = 1e-12
"""Share of all loads on a part that may be left over when they balance."""
_SHOWN = 3


def component_labels(n: int, pairs: np.ndarray) -> np.ndarray:
    """Return (n,) int: which connected part each node belongs to, numbered by first node."""
    if len(pairs) <= _SPARSE_FROM:
        return _labels_by_union(n, pairs)
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(n, n))
    return _by_first(connected_components(graph, directed=False)[1].tolist())


def _labels_by_union(n: int, pairs: np.ndarray) -> np.ndarray:
    parent = list(range(n))
    for a, b in pairs.tolist():
        while parent[a] != a:
            parent[a] = a = parent[parent[a]]
        while parent[b] != b:
            parent[b] = b = parent[parent[b]]
        # The first node stands for a part, so that parents come before their nodes.
        parent[max(a, b)] = min(a, b)
    for i, above in enumerate(parent):
        parent[i] = parent[above]
    return _by_first(parent)


def _by_first(labels: list[int]) -> np.ndarray:
    number: dict[int, int] = {}
    return np.array([number.setdefault(label, len(number)) for label in labels], dtype=int)


def all_pairs(groups: Sequence[Group]) -> np.ndarray:
    """Return the (b, 2) node rows of all groups, in the scene's element order."""
    return np.concatenate([group.pairs for group in groups])


def isolated_nodes(n: int, pairs: np.ndarray) -> np.ndarray:
    """Return the rows of nodes that no element joins."""
    return np.flatnonzero(np.bincount(pairs.ravel(), minlength=n) == 0)


def check_net_loads(
    findings: Findings,
    names: tuple[str, ...],
    labels: np.ndarray,
    supports: dict[int, str],
    loads: dict[int, tuple[float, ...]],
) -> None:
    """Record every part whose loads add up along an axis it is free to move along: no equilibrium."""
    if not loads:
        return
    rows = np.array(list(loads))
    forces = np.array(list(loads.values()))
    parts = int(labels.max()) + 1
    for axis in range(forces.shape[1]):
        net = np.bincount(labels[rows], forces[:, axis], minlength=parts)
        gross = np.bincount(labels[rows], np.abs(forces[:, axis]), minlength=parts)
        held = np.zeros(parts, dtype=bool)
        held[[labels[row] for row, axes in supports.items() if AXES[axis] in axes]] = True
        for part in np.flatnonzero(~held & (np.abs(net) > ROUNDING * gross)):
            members = [names[row] for row in np.flatnonzero(labels == part)]
            findings.add_key(
                ("loads",),
                f"no equilibrium exists: the forces along {AXES[axis]} on the part with nodes "
                f"{first_few(members)} add up to {net[part]:g}, and no support holds it along {AXES[axis]}",
            )


def warnings(
    names: tuple[str, ...],
    dimension: int,
    groups: Sequence[Group],
    labels: np.ndarray,
    supports: dict[int, str],
) -> tuple[str, ...]:
    """Return what is legal in a scene but seldom meant, one sentence each."""
    pairs = all_pairs(groups)
    said = [
        _parallel(names, groups, pairs),
        _parts(names, pairs, labels),
        _loose(names, pairs),
        _held(names, dimension, supports),
    ]
    return tuple(sentence for sentence in said if sentence)


def _parallel(names: tuple[str, ...], groups: Sequence[Group], pairs: np.ndarray) -> str:
    low, high = pairs.min(axis=1), pairs.max(axis=1)
    codes = low * len(names) + high
    order = np.argsort(codes, kind="stable")
    same = np.flatnonzero(np.diff(codes[order]) == 0)
    if len(same) == 0:
        return ""
    doubled = np.unique(codes[order[same]])
    owner = np.repeat(np.arange(len(groups)), [len(group.EA) for group in groups])
    shown = []
    for code in doubled[:_SHOWN]:
        among = ", ".join(dict.fromkeys(groups[g].name for g in owner[codes == code]))
        shown.append(f"{names[code // len(names)]}-{names[code % len(names)]} (in {among})")
    more = ", ..." if len(doubled) > _SHOWN else ""
    many = "pair of nodes is" if len(doubled) == 1 else "pairs of nodes are"
    return f"{len(doubled)} {many} joined by more than one element: {', '.join(shown)}{more}"


def _parts(names: tuple[str, ...], pairs: np.ndarray, labels: np.ndarray) -> str:
    joined = np.flatnonzero(np.bincount(pairs.ravel(), minlength=len(names)))
    sizes = np.bincount(labels[joined], minlength=int(labels.max()) + 1)
    parts = np.flatnonzero(sizes)
    if len(parts) == 1:
        return ""
    smallest = parts[np.argsort(sizes[parts], kind="stable")][: min(_SHOWN, len(parts) - 1)]
    shown = "; ".join(first_few([names[row] for row in np.flatnonzero(labels == part)]) for part in smallest)
    return f"no element joins the {len(parts)} parts of this structure; the smallest: {shown}"


def _loose(names: tuple[str, ...], pairs: np.ndarray) -> str:
    rows = isolated_nodes(len(names), pairs)
    if len(rows) == 0:
        return ""
    return f"no element joins {first_few([names[row] for row in rows])}"


def _held(names: tuple[str, ...], dimension: int, supports: dict[int, str]) -> str:
    held = sum(len(axes) for axes in supports.values())
    return (
        "every direction of every node is held, so nothing can move" if held == len(names) * dimension else ""
    )
