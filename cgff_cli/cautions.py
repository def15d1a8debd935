"""What may be wrong though the forces balance: one sentence each, first what, then what to do next."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from cgff_cli.analysis.measures import reach
from cgff_cli.scene.findings import first_few, quoted
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.stopping import VANISHED
from cgff_cli.structure import Structure
from cgff_cli.values import DEAD

STRAINED = 0.1 * (1.0 + 1e-9)
"""Strain above which neither elastic law describes a cable or a strut; 0.1 but for rounding is not above."""

UNLIKE = 3.0
"""Factor between start and rest lengths, in the median, above which their units seem to differ."""

RESIZED = 2.0
"""Factor of size above which the start was hardly that of this structure."""

UNEVEN = 0.05
"""Share of the largest pretension out of balance at the start, above which no more than a sign is right."""

TOGETHER = 1e-6
"""Distance of two nodes, as a share of the median element, below which they are at one point."""

_ASKEW = np.sqrt((2.0, 3.0, 5.0)) / np.sqrt(10.0)
"""Along this line nodes at one point are neighbours, and those of a lattice have places of their own."""

_NAMED = 3


class Found(NamedTuple):
    """A shape that was found for a scene, in the scene's order and units; floor: rounding error of forces."""

    scene: Scene
    structure: Structure
    coordinates: np.ndarray
    forces: np.ndarray
    slack: np.ndarray
    strains: np.ndarray
    floor: float


def cautions(found: Found) -> tuple[str, ...]:
    """Return what deserves a second look in a shape, converged or not; causes come before effects."""
    with np.errstate(over="ignore", invalid="ignore"):  # a run that diverged may hold anything
        said = [caution(found) for caution in CAUTIONS]
    return tuple(sentence for sentence in said if sentence)


def _middle(values: np.ndarray) -> float:
    """Return the median; numpy's own imports masked arrays, a tenth of the whole command."""
    n, ordered = len(values), np.sort(values)
    return 0.5 * float(ordered[(n - 1) // 2] + ordered[n // 2])


def _units(found: Found) -> str:
    rest, start = found.structure.rest_lengths, _start_lengths(found.structure)
    known = (rest > 0.0) & (start > 0.0)  # nodes may well start in one point
    ratios = start[known] / rest[known]
    ratio = _middle(ratios) if len(ratios) else 1.0
    if 1.0 / UNLIKE <= ratio <= UNLIKE:
        return ""
    off = np.flatnonzero(known)[ratios > UNLIKE if ratio > 1.0 else ratios < 1.0 / UNLIKE]
    what = (
        f"lengths at the start are {_figures(ratio)} times the rest lengths"
        if ratio > 1.0
        else f"rest lengths are {_figures(1.0 / ratio)} times the lengths at the start"
    )
    return (
        f"units: {what} in the median ({_groups(found, off)}); give coordinates and rest lengths in the "
        "same unit, or start from a shape nearer to the rest lengths"
    )


def _without_force(found: Found) -> str:
    cables = found.structure.tension_only
    if cables.any() and found.slack[cables].all():
        return (
            f"slack: every cable is slack ({_groups(found, np.flatnonzero(cables))}); shorten their rest "
            "lengths, or give loads that pull them tight"
        )
    idle = np.abs(found.forces) <= VANISHED * found.floor
    if not idle.all():
        return ""
    return (
        f"no force: no element carries any beyond rounding ({_groups(found, np.flatnonzero(idle))}); "
        "shorten cables or lengthen struts for prestress, or give loads"
    )


def _strained(found: Found) -> str:
    rows = np.flatnonzero(np.abs(found.strains) > STRAINED)
    if not len(rows):
        return ""
    worst_first = np.argsort(-np.abs(found.strains[rows]).round(9), kind="stable")
    rows = rows[worst_first]  # equal but for rounding: in scene order
    owners, worst = np.unique(found.scene.owners[rows], return_index=True)
    worst = rows[np.sort(worst)]
    named = [_strain_of(found, row) for row in worst[:_NAMED].tolist()]
    return (
        f"strain: {', '.join(named)}{_more(len(owners), 'groups')}, more than a linear law holds for; "
        "check EA, rest lengths and loads, unless these are springs"
    )


def _strain_of(found: Found, row: int) -> str:
    ends = _nodes(found, found.structure.start[row], found.structure.end[row])
    return f"{_figures(found.strains[row])} in {_groups(found, np.array([row]))} ({ends})"


def _resized(found: Found) -> str:
    before, after = reach(found.structure.coordinates), reach(found.coordinates)
    first, last = float(before.max()), float(after.max())
    if not 0.0 < first < np.inf or not last < np.inf or first / RESIZED <= last <= first * RESIZED:
        return ""
    farthest = quoted(found.scene.node_names[int(after.argmax())])
    what = f"{'grew' if last > first else 'shrank'} to {_figures(last / first)} times"
    return (
        f"size: the structure {what} the size of its start ({farthest} is now the farthest from its centre, "
        f"{_figures(last)}); check rest lengths and supports, or start from a shape nearer to this"
    )


def _together(found: Found) -> str:
    start, X = found.structure.coordinates, found.coordinates
    usual = np.maximum(found.structure.rest_lengths, _start_lengths(found.structure))
    near = TOGETHER * _middle(usual)
    along = (X - X[0]) @ _ASKEW[: X.shape[1]]
    order = np.argsort(along, kind="stable")
    close = np.flatnonzero(np.diff(along[order]) <= near)
    pairs = np.sort(np.stack((order[close], order[close + 1]), axis=1), axis=1)
    fell = (_apart(X, pairs) <= near) & (_apart(start, pairs) > near)
    if not fell.any():
        return ""
    names = [_nodes(found, *pair) for pair in np.unique(pairs[fell], axis=0)[:_NAMED].tolist()]
    return (
        f"fallen together: nodes {', '.join(names)}{_more(int(fell.sum()), 'pairs')}; make them one node, or "
        "hold them apart by a strut, a rest length or a support"
    )


def _uneven(found: Found) -> str:
    """Say where forces asked for do not balance; those of 0 ask for a length, not for a force."""
    groups, structure = found.scene.groups, found.structure
    asked = [group.pretension for group in groups if group.pretension is not None and group.pretension.all()]
    if len(asked) < len(groups) or found.scene.case not in ("", DEAD):
        return ""
    t = np.concatenate(asked)
    pulls = _pulls(structure, t)
    ways = [np.abs(np.where(structure.free, total, 0.0)) for total in (pulls, pulls + structure.loads)]
    left = min(ways, key=np.max)  # balanced alone, or with the loads that always act
    share = float(left.max() / np.abs(t).max())
    if not share > UNEVEN:
        return ""
    node = quoted(found.scene.node_names[int(left.max(axis=1).argmax())])
    row = int(np.abs(found.forces - t).argmax())
    group = _groups(found, np.array([row]))
    has = f"{group} has {_figures(found.forces[row])} in place of {_figures(t[row])}"
    return (
        f"pretension: at the coordinates given, {_figures(100.0 * share)} % of the largest is out of "
        f"balance, most at node {node}; in balance {has}; check signs and sizes"
    )


def _pulls(structure: Structure, t: np.ndarray) -> np.ndarray:
    """Return (n, d) what forces t (b,) pull at the nodes where they start."""
    V = structure.coordinates[structure.end] - structure.coordinates[structure.start]
    pull = V * (t / _start_lengths(structure))[:, None]
    total = np.zeros_like(structure.coordinates)
    np.add.at(total, structure.start, pull)
    np.subtract.at(total, structure.end, pull)
    return total


CAUTIONS: tuple[Callable[[Found], str], ...] = (
    *(_units, _without_force, _strained, _uneven),
    *(_resized, _together),
)


def _apart(X: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Return (m,) distances between pairs of rows."""
    return np.linalg.norm(X[pairs[:, 0]] - X[pairs[:, 1]], axis=1)


def _start_lengths(structure: Structure) -> np.ndarray:
    return _apart(structure.coordinates, np.stack((structure.start, structure.end), axis=1))


def _groups(found: Found, rows: np.ndarray) -> str:
    """Return the groups of some elements by name."""
    owners = np.unique(found.scene.owners[rows]).tolist()
    names = first_few([found.scene.groups[owner].name for owner in owners])
    return f"group{'s' if len(owners) > 1 else ''} {names}"


def _nodes(found: Found, begin: int, end: int) -> str:
    names = found.scene.node_names
    return f"{quoted(names[begin])} and {quoted(names[end])}"


def _more(number: int, kind: str) -> str:
    return f", ... ({number} {kind} in all)" if number > _NAMED else ""


def _figures(value: float) -> str:
    """Return three figures, 1020 rather than 1.02e+03."""
    return f"{float(f'{value:.3g}'):g}"
