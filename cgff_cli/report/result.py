"""The one record of a solve: every field of the JSON result, as attributes of the same names."""

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from cgff_cli import TOOL
from cgff_cli.analysis.equilibrium import stability_warnings
from cgff_cli.options import SolveOptions
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.structure import Structure

SCHEMA = "cgff-result/1"


@dataclass(frozen=True, eq=False)
class Result:
    """A solved scene. Arrays: coordinates (n, d); lengths, forces, force_densities, slack (b,)."""

    source: Scene
    structure: Structure
    solve_options: SolveOptions
    solution: Solution
    analysis: dict[str, Any]
    seconds: float
    analysis_interrupted: bool = False
    schema: str = field(default=SCHEMA, init=False)

    @property
    def tool(self) -> dict[str, str]:
        """Name and version of what made this."""
        return dict(TOOL)

    @property
    def scene(self) -> dict[str, Any]:
        """Which scene was solved: name, path, law, dimension."""
        return self.source.summary

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
        message = self.solution.message
        return f"{message}; its analysis was interrupted" if self.analysis_interrupted else message

    @property
    def warnings(self) -> tuple[str, ...]:
        """What deserves a second look: the scene's warnings, the solver's, then what the analysis found."""
        return self.source.warnings + self.solution.warnings + stability_warnings(self.analysis)

    @property
    def residual(self) -> dict[str, float]:
        """Largest and total out-of-balance force, relative to the reference force, and its floor."""
        s = self.solution
        relative = s.residual_max / s.reference if s.reference > 0.0 else s.residual_max
        return {
            "max": s.residual_max,
            "norm": s.residual_norm,
            "relative": relative,
            "rounding_floor": s.floor,
            "reference_force": s.reference,
        }

    @property
    def energy(self) -> float:
        """Total potential energy: elastic energy less the work of the loads."""
        return self.solution.energy

    @property
    def max_strain(self) -> float | None:
        """Largest strain of either sign, a slack cable's being 0; None where no element has a rest length."""
        l, l0 = self.lengths, self.structure.rest_lengths
        strained = np.abs(np.where(self.slack, 0.0, l - l0)[l0 > 0.0] / l0[l0 > 0.0])
        return float(strained.max()) if len(strained) else None

    @property
    def counts(self) -> dict[str, int]:
        """Iterations, evaluations, factorizations, restarts."""
        s = self.solution
        return {
            "iterations": s.iterations,
            "evaluations": s.evaluations,
            "factorizations": s.factorizations,
            "restarts": s.restarts,
        }

    @property
    def timing(self) -> dict[str, float]:
        """Wall-clock seconds of the solve: the only field that may differ between two runs."""
        return {"seconds": self.seconds}

    @property
    def history(self) -> dict[str, list[Any]]:
        """Column name -> one value per iteration, row 0 the start."""
        return self.solution.history

    @property
    def coordinates(self) -> np.ndarray:
        """(n, d) final positions, in the scene's node order."""
        return self.solution.coordinates

    @property
    def lengths(self) -> np.ndarray:
        """(b,) final lengths, eq. (7), in the scene's element order."""
        return self.solution.state.l

    @property
    def forces(self) -> np.ndarray:
        """(b,) forces, eq. (2); tension > 0, a slack cable 0."""
        return self.solution.state.t

    @property
    def force_densities(self) -> np.ndarray:
        """(b,) force densities q = t / l."""
        return self.solution.state.q

    @property
    def slack(self) -> np.ndarray:
        """(b,) bool, cables shorter than their rest length."""
        return self.solution.state.slack

    @property
    def nodes(self) -> dict[str, list[float]]:
        """Final position of every node by name."""
        return dict(zip(self.source.node_names, self.coordinates.tolist(), strict=True))

    @property
    def elements(self) -> list[dict[str, Any]]:
        """One record per element, in the scene's element order."""
        return list(self.element_records())

    def element_records(self) -> Iterator[dict[str, Any]]:
        """Yield the record of each element; tension > 0."""
        names, s = self.source.node_names, self.structure
        columns = (self.lengths, self.forces, self.force_densities, self.slack)
        numbers = zip(*(column.tolist() for column in columns), strict=True)
        ends = zip(s.start.tolist(), s.end.tolist(), strict=True)
        for group in self.source.groups:
            for EA, rest_length in zip(group.EA.tolist(), group.rest_length.tolist(), strict=True):
                (begin, end), (length, force, density, slack) = next(ends), next(numbers)
                yield {
                    "group": group.name,
                    "start": names[begin],
                    "end": names[end],
                    "kind": group.kind,
                    "EA": EA,
                    "rest_length": rest_length,
                    "length": length,
                    "force": force,
                    "force_density": density,
                    "slack": slack,
                }

    @property
    def reactions(self) -> dict[str, list[float]]:
        """Force each support exerts on its node, zero in directions it leaves free."""
        held = np.where(self.structure.free, 0.0, -self.solution.state.eta)
        names = self.source.node_names
        return {names[row]: held[row].tolist() for row in sorted(self.source.supports)}

    def to_dict(self) -> dict[str, Any]:
        """Return every field of the JSON result, in the order it is written."""
        fields = {name: getattr(self, name) for name in FIELDS}
        if not self.source.supports:
            del fields["reactions"]
        return fields


FIELDS = (
    "schema",
    "tool",
    "scene",
    "options",
    "verdict",
    "converged",
    "message",
    "warnings",
    "residual",
    "energy",
    "counts",
    "timing",
    "analysis",
    "nodes",
    "elements",
    "reactions",
    "history",
)
