"""The one record of a solve: every field of the JSON result, as attributes of the same names."""

from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from cgff_cli import TOOL
from cgff_cli.analysis import measures
from cgff_cli.analysis.equilibrium import analysed, stability_warnings
from cgff_cli.cautions import Found, cautions
from cgff_cli.options import SolveOptions
from cgff_cli.scene.results import RESULT_SCHEMA
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.structure import Structure

if TYPE_CHECKING:
    from cgff_cli.analysis.given import Given
    from cgff_cli.analysis.sensitivity import Sensitivity


@dataclass(frozen=True, eq=False)
class Result:
    """A solved scene. Arrays: coordinates (n, d); lengths, forces, force_densities, strains, slack (b,)."""

    source: Scene
    structure: Structure
    solve_options: SolveOptions
    solution: Solution
    seconds: float
    found: dict[str, Any] | None = None
    analysis_interrupted: bool = False
    schema: str = field(default=RESULT_SCHEMA, init=False)
    tool: dict[str, str] = field(default_factory=TOOL.copy, init=False)

    @property
    def scene(self) -> dict[str, Any]:
        """Which scene was solved: name, path, law, dimension."""
        return self.source.summary

    @cached_property
    def analysis(self) -> dict[str, Any]:
        """What kind of equilibrium it is."""
        return self.found or analysed(self.source, self.solution, self.solve_options)

    @property
    def options(self) -> dict[str, Any]:
        """Every solve option in force."""
        return self.solve_options.to_dict()

    @property
    def verdict(self) -> str:
        """How the run ended, one of Verdict's values."""
        return self.solution.verdict.value

    @property
    def converged(self) -> bool:
        """True where the forces balance."""
        return self.solution.verdict.converged

    @property
    def interrupted(self) -> bool:
        """True where Ctrl-C ended the solver, or the analysis of what it had found."""
        return self.analysis_interrupted or self.solution.verdict is Verdict.INTERRUPTED

    @property
    def message(self) -> str:
        """One sentence for a person."""
        return self.solution.message + ("; its analysis was interrupted" if self.analysis_interrupted else "")

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """What deserves a second look: in the scene, on the way, in the shape found, in its stability."""
        arrays = (self.coordinates, self.forces, self.slack, self.strains)
        found = Found(self.source, self.structure, *arrays, self.residual["rounding_floor"])
        said = self.source.warnings + self.solution.warnings
        return said + cautions(found) + stability_warnings(self.analysis)

    @property
    def residual(self) -> dict[str, float]:
        """Largest and total out-of-balance force, relative to the reference force, and its floor."""
        s = self.solution
        return {
            "max": s.residual_max,
            "norm": s.residual_norm,
            "relative": s.relative,
            "rounding_floor": s.floor,
            "reference_force": s.reference,
        }

    @property
    def energy(self) -> float:
        """Total potential energy: elastic energy less the work of the loads."""
        return self.solution.energy

    @property
    def max_strain(self) -> float | None:
        """Largest strain of either sign; None where no element has a rest length."""
        return measures.max_strain(self.strains, self.structure.rest_lengths)

    @property
    def max_displacement(self) -> float | None:
        """Largest distance a node moved from its start, over the structure's size."""
        s = self.structure
        return measures.max_displacement(s.coordinates, self.coordinates, s.rest_lengths)

    @property
    def counts(self) -> dict[str, int]:
        """Iterations, evaluations, factorizations, restarts."""
        names = ("iterations", "evaluations", "factorizations", "restarts")
        return {name: getattr(self.solution, name) for name in names}

    @property
    def timing(self) -> dict[str, float]:
        """Wall-clock seconds of the solve: the only field that may differ between two runs."""
        return {"seconds": self.seconds}

    @property
    def history(self) -> dict[str, list[Any]]:
        """Column name -> one value per iteration, row 0 the start."""
        return self.solution.history

    @cached_property
    def coordinates(self) -> np.ndarray:
        """(n, d) final positions, in the scene's node order."""
        return self.solution.coordinates

    @cached_property
    def lengths(self) -> np.ndarray:
        """(b,) final lengths, eq. (7), in the scene's element order."""
        return self.solution.lengths

    @cached_property
    def forces(self) -> np.ndarray:
        """(b,) forces, eq. (2); tension > 0, a slack cable 0."""
        return self.solution.forces

    @cached_property
    def force_densities(self) -> np.ndarray:
        """(b,) force densities q = t / l."""
        return self.solution.force_densities

    @cached_property
    def slack(self) -> np.ndarray:
        """(b,) bool, cables shorter than their rest length."""
        return self.solution.slack

    @cached_property
    def strains(self) -> np.ndarray:
        """(b,) strains (l - l0) / l0; a slack cable 0, NaN where l0 is 0."""
        return measures.strains(self.lengths, self.structure.rest_lengths, self.slack)

    @property
    def supports(self) -> dict[str, str]:
        """Directions held, by node."""
        return {self.source.node_names[row]: axes for row, axes in sorted(self.source.supports.items())}

    @property
    def loads(self) -> dict[str, list[float]]:
        """Forces that act on nodes, by node."""
        names, loads = self.source.node_names, self.structure.loads
        return {names[row]: loads[row].tolist() for row in np.flatnonzero(loads.any(axis=1)).tolist()}

    @property
    def groups(self) -> dict[str, dict[str, Any]]:
        """For each group its count, its slack elements, least and greatest length, force, force density."""
        counts = [len(group.EA) for group in self.source.groups]
        columns = {
            "count": counts,
            "length": measures.spans(self.lengths, counts),
            "force": measures.spans(self.forces, counts),
            "force_density": measures.spans(self.force_densities, counts),
            "slack": np.add.reduceat(self.slack, measures.firsts(counts), dtype=int).tolist(),
        }
        return dict(zip((group.name for group in self.source.groups), _records(columns), strict=True))

    @property
    def nodes(self) -> dict[str, list[float]]:
        """Final position of every node by name."""
        return dict(zip(self.source.node_names, self.coordinates.tolist(), strict=True))

    @property
    def elements(self) -> list[dict[str, Any]]:
        """One record per element, in the scene's element order; tension > 0."""
        columns = self.element_columns(slice(None))
        strains = (strain if isfinite(strain) else None for strain in columns["strain"])
        return _records({**columns, "strain": list(strains)})

    def element_columns(self, rows: slice) -> dict[str, list[Any]]:
        """Return the columns of some elements' records, by name; a strain may be NaN."""
        s, source = self.structure, self.source
        groups = [source.groups[owner] for owner in source.owners[rows].tolist()]
        return {
            "group": [group.name for group in groups],
            "start": [source.node_names[row] for row in s.start[rows].tolist()],
            "end": [source.node_names[row] for row in s.end[rows].tolist()],
            "kind": [group.kind for group in groups],
            "EA": source.axial_stiffness[rows].tolist(),
            "rest_length": s.rest_lengths[rows].tolist(),
            "length": self.lengths[rows].tolist(),
            "force": self.forces[rows].tolist(),
            "force_density": self.force_densities[rows].tolist(),
            "slack": self.slack[rows].tolist(),
            "strain": self.strains[rows].tolist(),
        }

    @property
    def reactions(self) -> dict[str, list[float]]:
        """Force each support exerts on its node, zero in directions it leaves free."""
        held, names = self.solution.reactions, self.source.node_names
        return {names[row]: held[row].tolist() for row in sorted(self.source.supports)}

    def sensitivity(self, of: str) -> "Sensitivity":
        """Return what a unit of rest length does, in all of a group or in the element that joins A,B.

        Its coordinates are (n, d) motions of nodes, its forces (b,) changes. Raises OptionError where there
        is no such group or element.
        """
        return self._given.sensitivity(of)

    @cached_property
    def _given(self) -> "Given":
        """The shape with one factor of K, for all that is asked."""
        from cgff_cli.analysis.given import Given

        return Given(self.source, self.solution, self.solve_options, 0)

    def to_dict(self) -> dict[str, Any]:
        """Return every field of the JSON result, in the order it is written."""
        fields = {name: getattr(self, name) for name in FIELDS}
        if not self.source.supports:
            del fields["reactions"]
        return fields


def _records(columns: dict[str, list[Any]]) -> list[dict[str, Any]]:
    """Return the rows of some columns, each by the columns' names."""
    return [dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True)]


FIELDS = (
    *("schema", "tool", "scene", "options", "verdict", "converged", "message", "warnings"),
    *("residual", "energy", "max_strain", "max_displacement", "counts", "timing", "analysis"),
    *("supports", "loads", "groups", "nodes", "elements", "reactions", "history"),
)
"""Fields of the JSON result, in the order they are written."""
