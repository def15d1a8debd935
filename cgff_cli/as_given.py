"""The analysis of coordinates as given: a scene's own, or those of a result; nothing is solved."""

import os
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from cgff_cli import TOOL
from cgff_cli.analysis.equilibrium import labels
from cgff_cli.analysis.given import Given
from cgff_cli.analysis.sensitivity import Sensitivity
from cgff_cli.errors import OptionError, Problem, SceneError
from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import largest
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import DEFAULTS
from cgff_cli.result import Result
from cgff_cli.scene.physics import all_pairs
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.structure import from_scene

MODES = 3
"""Motions of each kind that are told unless others are asked for."""


@dataclass(frozen=True, eq=False)
class Analysis:
    """What coordinates as given are, every field of the JSON by name; result: the shape, as if solved."""

    result: Result
    given: Given
    sensitivity: dict[str, Sensitivity]
    schema: str = field(default="cgff-analysis/1", init=False)

    @property
    def tool(self) -> dict[str, str]:
        """Name and version of what made this."""
        return dict(TOOL)

    @property
    def scene(self) -> dict[str, Any]:
        """Which scene it is: name, path, law, dimension."""
        return self.result.scene

    @property
    def is_geometry(self) -> bool:
        """Whether there are no rest lengths, and so no forces."""
        return self.result.source.is_geometry

    @property
    def balanced(self) -> bool | None:
        """Whether the forces balance; None where there are none to speak of, in a geometry."""
        return None if self.is_geometry else self.result.converged

    @property
    def message(self) -> str:
        """One sentence for a person on the balance of forces."""
        if self.is_geometry:
            return "a geometry without rest lengths: states of self-stress and mechanisms are told"
        residual, state = self.result.residual, self.result.solution.state
        share = f"out-of-balance force {residual['relative']:.1e} of the largest force"
        if self.balanced:
            return f"the forces balance: {share}"
        moves, row = state.mechanics.moves, int(np.abs(state.g).max(axis=0).argmax())
        row = row if moves is None else int(np.flatnonzero(moves)[row])
        return f"the forces do not balance: {share}, at node {self.result.source.node_names[row]!r}"

    @property
    def residual(self) -> dict[str, float] | None:
        """Largest and total out-of-balance force, as in a result; None of a geometry."""
        return None if self.is_geometry else self.result.residual

    @property
    def groups(self) -> dict[str, dict[str, Any]]:
        """For each group what a result tells; of a geometry no forces."""
        groups = self.result.groups
        gone = dict.fromkeys(("force", "force_density", "slack")) if self.is_geometry else {}
        return {name: own | gone for name, own in groups.items()}

    @cached_property
    def analysis(self) -> dict[str, Any]:
        """States, mechanisms, stability, modes, and a reason for all that is null."""
        return self.given.analysis()

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What deserves a second look, as in a result; of a geometry only in the scene."""
        if self.is_geometry:
            return self.result.source.warnings
        return replace(self.result, found=self.analysis).warnings

    def to_dict(self) -> dict[str, Any]:
        """Return every field of the JSON, in the order it is written."""
        fields, names = {name: getattr(self, name) for name in ANALYSIS_FIELDS}, self.result.source.node_names
        fields["sensitivity"] = {
            of: {
                "nodes": None if X is None else dict(zip(names, X.tolist(), strict=True)),
                "forces": None if t is None else t.tolist(),
                "reason": reason or None,
            }
            for of, (X, t, reason) in self.sensitivity.items()
        }
        return fields


ANALYSIS_FIELDS = (
    *("schema", "tool", "scene", "balanced", "message", "warnings", "residual", "groups", "analysis"),
    "sensitivity",
)


def analyse(
    scene: Scene | Result | str | os.PathLike[str],
    *,
    modes: int = MODES,
    sensitivity: str | Sequence[str] = (),
    **changes: object,
) -> Analysis:
    """Judge a scene at its own coordinates, a result at those found, or either at a path.

    modes: how many motions of each kind to tell; sensitivity: groups, or elements as A,B, to tell what a
    unit of their rest length does; changes: the solve options tolerance and factor. Raises SceneError for a
    bad file, and for elements of no length; OptionError for a bad option.
    """
    if not isinstance(modes, int) or modes < 0:
        raise OptionError(f"modes must be a whole number >= 0, got {modes!r}")
    if isinstance(scene, (str, os.PathLike)):
        from cgff_cli.scene.read import load

        scene = load(scene, results=True)
    if isinstance(scene, Result):
        source, options = scene.source, scene.solve_options.merged(changes)
        solution = _judged(replace(scene.solution, tolerance=options.tolerance))
    else:
        source, options = scene, DEFAULTS.merged({**scene.solver, **changes})
        solution = unmoved(scene, options.tolerance)
    given = Given(source, solution, options, modes)
    of = (sensitivity,) if isinstance(sensitivity, str) else sensitivity
    found = {name: given.sensitivity(name) for name in of}
    return Analysis(Result(source, solution.mechanics.structure, options, solution, 0.0), given, found)


def unmoved(scene: Scene, tolerance: float) -> Solution:
    """Return a scene's own coordinates as the outcome of a run without steps.

    Raises SceneError for elements of no length.
    """
    vectors = scene.coordinates[(pairs := all_pairs(scene.groups))[:, 0]] - scene.coordinates[pairs[:, 1]]
    lengths = np.linalg.norm(vectors, axis=1)
    if scene.is_geometry:
        scene = scene.with_rest_lengths(lengths)
    structure = from_scene(scene)
    gone = np.flatnonzero((lengths == 0.0) & (structure.rest_lengths > 0.0))
    if len(gone):
        message = f"nothing can be told of an element without length: {', '.join(labels(scene, gone[:3]))}"
        raise SceneError([Problem(scene.path, *scene.elements_at, message)])
    mechanics = Mechanics(structure)
    return _judged(Solution(mechanics.at(mechanics.start), Verdict.MAX_ITERATIONS, tolerance, 1))


def _judged(solution: Solution) -> Solution:
    """Return a solution with the verdict of its balance; what the digits of coordinates blur is rounding."""
    m, balance = solution.mechanics, solution.balance
    digits = EPS * largest(m.nodal_stiffness) * largest(m.structure.coordinates) / m.frame.length
    is_rounding = balance.near_floor or balance.residual <= 2.0 * digits
    verdict = balance.reached(solution.tolerance) or (Verdict.ROUNDING_FLOOR if is_rounding else None)
    return replace(solution, verdict=verdict or solution.verdict)
