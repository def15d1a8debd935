"""What a comparison found: the fields of schema cgff-compare/1, as attributes of the same names."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from cgff_cli import TOOL
from cgff_cli.rivals.task import AtResidual, AtShape
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.solution import Solution


class Method(NamedTuple):
    """One method's row; None is what was not computed, or never reached.

    verdict           : one of Verdict's, or "same_shape" (CGFF's, but out of balance by the difference),
                        "other_equilibrium" (of its own force densities, not of the scene's), "gave_up",
                        "time_limit", "failed"; message says it in a sentence
    converged         : whether the scene's own forces balance: verdict converged or rounding_floor
    seconds           : median of the runs, like those of the curves
    residual_relative, energy : of the scene at the method's aligned shape
    X                 : (n, d) that shape, where the user has it
    lengths           : (b,) of that shape, in the scene's element order, like force_densities
    force_densities   : the scene's at that shape, or the method's own, for fdm scaled to CGFF's
    max_..., distance_matrix_difference : against cgff, lengths in the scene's unit
    shape_error       : the farthest node's from its place in the reference, over the structure's size
    """

    name: str
    verdict: str
    converged: bool
    message: str
    stable: bool | None = None
    iterations: int | None = None
    evaluations: int | None = None
    seconds: float | None = None
    residual_relative: float | None = None
    energy: float | None = None
    alignment: str = "none"
    X: np.ndarray | None = None
    lengths: np.ndarray | None = None
    force_densities: np.ndarray | None = None
    max_node_difference: float | None = None
    max_length_difference: float | None = None
    max_force_density_difference: float | None = None
    distance_matrix_difference: float | None = None
    curve: tuple[AtResidual, ...] = ()
    shape_curve: tuple[AtShape, ...] = ()
    shape_error: float | None = None
    node_names: tuple[str, ...] = ()

    @property
    def nodes(self) -> dict[str, list[float]] | None:
        """The shape by node name."""
        return None if self.X is None else by_name(self.node_names, self.X)

    def to_dict(self) -> dict[str, Any]:
        """Return the fields by name, as they are written: arrays as lists, curves as lists of objects."""
        told = {name: getattr(self, name) for name in WRITTEN}
        for name in ("curve", "shape_curve"):
            told[name] = [point._asdict() for point in told[name]]
        for name in ("lengths", "force_densities"):
            told[name] = None if told[name] is None else told[name].tolist()
        return told


WRITTEN = tuple("nodes" if name == "X" else name for name in Method._fields[:-2])
"""The fields of a method that its record has."""


def by_name(node_names: tuple[str, ...], X: np.ndarray) -> dict[str, list[float]]:
    """Return positions (n, d) by node name."""
    return dict(zip(node_names, X.tolist(), strict=True))


@dataclass(frozen=True, eq=False)
class Comparison:
    """One scene by several methods, CGFF first; best is its answer to the rounding floor."""

    source: Scene
    options: dict[str, Any]
    best: Solution
    methods: tuple[Method, ...]
    schema: str = field(default="cgff-compare/1", init=False)
    tool: dict[str, str] = field(default_factory=TOOL.copy, init=False)

    @property
    def scene(self) -> dict[str, Any]:
        """Which scene was solved: name, path, law, dimension."""
        return self.source.summary

    @property
    def reference(self) -> dict[str, Any]:
        """The answer that shape errors are measured against."""
        return {
            "verdict": self.best.verdict.value,
            "residual_relative": self.best.relative,
            "energy": self.best.energy,
            "nodes": by_name(self.source.node_names, self.best.coordinates),
        }

    def to_dict(self) -> dict[str, Any]:
        """Return every field of the JSON, in the order it is written."""
        names = ("schema", "tool", "scene", "options", "reference")
        return {name: getattr(self, name) for name in names} | {
            "methods": [method.to_dict() for method in self.methods]
        }
