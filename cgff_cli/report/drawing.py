"""What a picture or a page shows of a structure: plain arrays, names once."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cgff_cli import pipeline
from cgff_cli.as_given import Analysis, analyse
from cgff_cli.cases import asked_cases, solve_cases
from cgff_cli.errors import OptionError
from cgff_cli.result import Result
from cgff_cli.scene.read import load


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


def results_of(path: str, case: str | None, as_given: bool) -> Iterator[Result]:
    """Yield what is drawn of the file at a path: a result or a geometry as it is, a scene solved.

    case : a load case or combination to solve the scene in, or "all": one result of each

    Raises SceneError for a bad file, OptionError for a case that is not there, or of what is not solved.
    """
    scene = load(path, results=True)
    is_solved = not (as_given or scene.is_geometry or scene.answer)
    if case is not None and not is_solved:
        raise OptionError(f"--case {case}: {path} is drawn as it is; a case is of a scene that is solved")
    if case is not None:
        yield from solve_cases(scene, asked_cases(scene, case))
    else:
        yield pipeline.solve(scene) if is_solved else analyse(scene).result


def drawing_of(result: Result) -> Drawing:
    """Return the drawing of a result, without forces in a geometry."""
    source, s = result.source, result.structure
    case = f", {source.case}" if source.case else ""
    is_geometry = source.is_geometry
    return Drawing(
        title=f"{source.name}{case}",
        node_names=source.node_names,
        group_names=[group.name for group in source.groups],
        coordinates=result.coordinates,
        start=None if np.array_equal(s.coordinates, result.coordinates) else s.coordinates,
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
