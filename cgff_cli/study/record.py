"""What a comparison found: the fields of schema cgff-compare/1, as attributes of the same names."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from cgff_cli import TOOL
from cgff_cli.scene.scene import Scene

SCHEMA = "cgff-compare/1"

Nodes = dict[str, list[float]]


class Point(NamedTuple):
    """When a run first had a relative residual within the tolerance, and its shape error then."""

    tolerance: float
    iterations: int | None
    seconds: float | None
    shape_error: float | None


class ShapePoint(NamedTuple):
    """When a run first had a shape error within the tolerance, and its relative residual then."""

    tolerance: float
    iterations: int | None
    seconds: float | None
    residual_relative: float | None


class Method(NamedTuple):
    """One method's row; None is what was not computed, or never reached.

    verdict           : one of Verdict's, or "other_equilibrium" (of its own force densities, not of the
                        scene's), "gave_up", "time_limit", "failed"; message says it in a sentence
    seconds           : median of the runs, like those of the curves
    residual_relative, energy : of the scene at the method's aligned shape
    lengths           : of that shape, in the scene's element order, like force_densities
    force_densities   : the scene's at that shape, or the method's own, for fdm scaled to CGFF's
    max_..., distance_matrix_difference : against cgff, lengths in the scene's unit
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
    nodes: Nodes | None = None
    lengths: list[float] | None = None
    force_densities: list[float] | None = None
    max_node_difference: float | None = None
    max_length_difference: float | None = None
    max_force_density_difference: float | None = None
    distance_matrix_difference: float | None = None
    curve: tuple[Point, ...] = ()
    shape_curve: tuple[ShapePoint, ...] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return the fields by name, the curves as lists of objects."""
        curves = {name: [point._asdict() for point in getattr(self, name)] for name in CURVES}
        return self._asdict() | curves


CURVES = ("curve", "shape_curve")


@dataclass(frozen=True, eq=False)
class Comparison:
    """One scene by several methods, CGFF first; reference is the answer that shape errors are measured by."""

    source: Scene
    options: dict[str, Any]
    reference: dict[str, Any]
    methods: tuple[Method, ...]
    schema: str = field(default=SCHEMA, init=False)

    @property
    def tool(self) -> dict[str, str]:
        """Name and version of what made this."""
        return dict(TOOL)

    @property
    def scene(self) -> dict[str, Any]:
        """Which scene was solved: name, path, law, dimension."""
        return self.source.summary

    def to_dict(self) -> dict[str, Any]:
        """Return every field of the JSON, in the order it is written."""
        return {
            "schema": self.schema,
            "tool": self.tool,
            "scene": self.scene,
            "options": self.options,
            "reference": self.reference,
            "methods": [method.to_dict() for method in self.methods],
        }
