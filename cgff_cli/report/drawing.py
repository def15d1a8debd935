"""What a picture or a page shows of a structure: plain arrays, names once."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from cgff_cli.as_given import Analysis
from cgff_cli.errors import OptionError
from cgff_cli.result import Result


@dataclass(frozen=True, eq=False)
class Drawing:
    """A shape with what acts on it.

    coordinates : (n, d)                        start   : (n, d) where it began, or None
    pairs       : (b, 2) node rows              owners  : (b,) number of each element's group
    struts, slack : (b,) bool                   forces  : (b,), tension > 0, None in a geometry
    supports    : (s,) node rows                loads   : (n, d) as solved, weight included
    size        : diagonal of the box around it
    """

    title: str
    node_names: tuple[str, ...]
    group_names: list[str]
    coordinates: np.ndarray
    start: np.ndarray | None
    pairs: np.ndarray
    owners: np.ndarray
    struts: np.ndarray
    slack: np.ndarray
    forces: np.ndarray | None
    lengths: np.ndarray
    strains: np.ndarray | None
    force_densities: np.ndarray | None
    supports: np.ndarray
    loads: np.ndarray

    @property
    def size(self) -> float:
        """Diagonal of the box around the shape, 1 where it has none."""
        return float(np.linalg.norm(np.ptp(self.coordinates, axis=0))) or 1.0


def drawing_of(result: Result, is_geometry: bool = False, has_start: bool = True) -> Drawing:
    """Return the drawing of a result; is_geometry: without forces; has_start: it began elsewhere."""
    source, s = result.source, result.structure
    case = f", {source.case}" if source.case else ""
    moved = has_start and not np.array_equal(s.coordinates, result.coordinates)
    return Drawing(
        title=f"{source.name}{case}",
        node_names=source.node_names,
        group_names=[group.name for group in source.groups],
        coordinates=result.coordinates,
        start=s.coordinates if moved else None,
        pairs=np.column_stack([s.start, s.end]),
        owners=source.owners,
        struts=~s.tension_only,
        slack=np.zeros_like(s.tension_only) if is_geometry else result.slack,
        forces=None if is_geometry else result.forces,
        lengths=result.lengths,
        strains=None if is_geometry else result.strains,
        force_densities=None if is_geometry else result.force_densities,
        supports=np.array(sorted(source.supports), dtype=int),
        loads=s.loads,
    )


def mode_of(found: Analysis, number: int) -> tuple[np.ndarray, str]:
    """Return the motion (n, d) of a mode, largest motion 1, and what it is; the first is 1.

    Raises OptionError where there are fewer.
    """
    modes: list[dict[str, Any]] = found.analysis["modes"] or []
    if not 1 <= number <= len(modes):
        there = f"there are {len(modes)}" if modes else "none is known"
        raise OptionError(f"mode {number}: {there}")
    mode = modes[number - 1]
    shape = np.array(list(mode["shape"].values()))
    size = float(np.linalg.norm(shape, axis=1).max()) or 1.0
    stiffness = "" if mode["stiffness"] is None else f", stiffness {mode['stiffness']:.3g}"
    return shape / size, f"{mode['kind']} {number}{stiffness}"
