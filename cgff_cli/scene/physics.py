"""What a well-formed scene may still get wrong: loose nodes, loads nothing can balance, doubles."""

from collections.abc import Mapping, Sequence

import numpy as np

from cgff_cli.scene.findings import Findings, Where, first_few
from cgff_cli.scene.scene import AXES, Group

ROUNDING = 1e-12
"""Share of all loads on a part that may be left over when they balance."""
_SHOWN = 3

_G = np.array((9.81, 9810.0, 32.2, 386.0))
"""The earth's acceleration, in m, mm, feet and inches per second squared."""


def component_labels(n: int, pairs: np.ndarray) -> np.ndarray:
    """Return (n,) int: which connected part each node belongs to, numbered by first node.

    Every node points at one of its part, in the end at its first. Each round hangs what the two ends of an
    element point at together, then lets all point at the roots: the parts at least halve in two rounds.
    """
    first, (start, end) = np.arange(n), pairs.T
    while not np.array_equal(first[start], first[end]):
        least = np.minimum(first[start], first[end])
        np.minimum.at(first, first[start], least)
        np.minimum.at(first, first[end], least)
        while not np.array_equal(first, first[first]):
            first = first[first]
    return np.unique(first, return_inverse=True)[1].reshape(-1)


def all_pairs(groups: Sequence[Group]) -> np.ndarray:
    """Return the (b, 2) node rows of all groups, in the scene's element order."""
    return np.concatenate([group.pairs for group in groups])


def isolated_nodes(n: int, pairs: np.ndarray) -> np.ndarray:
    """Return the rows of nodes that no element joins."""
    return np.flatnonzero(np.bincount(pairs.ravel(), minlength=n) == 0)


def check_weight(
    findings: Findings,
    names: tuple[str, ...],
    labels: np.ndarray,
    supports: dict[int, str],
    groups: Sequence[Group],
    gravity: Sequence[float],
) -> None:
    """Record every part whose weight nothing holds, along any of the axes that gravity has a share in."""
    heavy = [group.pairs[group.weight != 0.0, 0] for group in groups if group.weight is not None]
    if not heavy:
        return
    parts = set(labels[np.concatenate(heavy)].tolist())
    down = np.abs(gravity) > ROUNDING * np.abs(gravity).max()
    for axis in (AXES[i] for i in np.flatnonzero(down).tolist()):
        held = {int(labels[row]) for row, axes in supports.items() if axis in axes}
        for part in sorted(parts - held):
            members = [names[row] for row in np.flatnonzero(labels == part)]
            findings.add_key(
                ("elements",),
                f"no equilibrium exists: the part with nodes {first_few(members)} has weight along {axis}, "
                f"and no support holds it along {axis}",
            )


def check_net_loads(
    findings: Findings,
    where: Where,
    names: tuple[str, ...],
    labels: np.ndarray,
    supports: dict[int, str],
    loads: Mapping[int, tuple[float, ...]],
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
            findings.add(
                where,
                f"no equilibrium exists: the forces along {AXES[axis]} on the part with nodes "
                f"{first_few(members)} add up to {net[part]:g}, and no support holds it along {AXES[axis]}",
                at_key=True,
            )


def warnings(
    names: tuple[str, ...],
    dimension: int,
    groups: Sequence[Group],
    labels: np.ndarray,
    supports: dict[int, str],
    gravity: Sequence[float] | None,
) -> tuple[str, ...]:
    """Return what is legal in a scene but seldom meant, one sentence each."""
    pairs = all_pairs(groups)
    said = [_parallel(names, groups, pairs), _parts(names, pairs, labels), _acceleration(gravity)]
    loose = [names[row] for row in isolated_nodes(len(names), pairs)]
    if loose:
        said.append(f"no element joins {first_few(loose)}")
    if sum(map(len, supports.values())) == len(names) * dimension:
        said.append("every direction of every node is held, so nothing can move")
    return tuple(sentence for sentence in said if sentence)


def _acceleration(gravity: Sequence[float] | None) -> str:
    size = 0.0 if gravity is None else float(np.linalg.norm(gravity))
    if not np.isclose(size, _G, rtol=0.005).any():
        return ""
    return (
        f"gravity is a direction, its size {size:g} counts for nothing: weight is a force per rest length, "
        "not a mass"
    )


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
