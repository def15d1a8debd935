"""What a scene is: plain columns, names once, node rows everywhere else."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isnan

import numpy as np

from cgff_cli.errors import OptionError

LAWS = ("paper", "hooke")
KINDS = ("cable", "strut")
AXES = "xyz"


@dataclass(frozen=True, eq=False)  # arrays have no one answer to ==
class Group:
    """Elements of one kind: m pairs of node rows with their EA and rest lengths.

    pairs       : (m, 2) int array, rows into Scene.node_names: begin, end
    EA          : (m,) array, force under law `hooke`, force per length under law `paper`
    rest_length : (m,) array, the scene's length unit; NaN in a geometry
    """

    name: str
    kind: str
    pairs: np.ndarray
    EA: np.ndarray
    rest_length: np.ndarray


@dataclass(frozen=True, eq=False)
class Scene:
    """One structure as its user described it; the reader has checked all of it.

    coordinates : (n, d) array, d = 2 or 3, the start shape
    supports    : node row -> axes held fixed, a subset of "xyz" in that order
    loads       : node row -> (d,) nodal force
    solver      : solve options asked for in the file
    files       : paths it was read from, its tables among them
    elements_at : line and column of the key `elements`, 0 where it has none
    """

    name: str
    law: str
    node_names: tuple[str, ...]
    coordinates: np.ndarray
    groups: tuple[Group, ...]
    supports: Mapping[int, str] = field(default_factory=dict)
    loads: Mapping[int, tuple[float, ...]] = field(default_factory=dict)
    solver: Mapping[str, object] = field(default_factory=dict)
    path: str = "<python>"
    warnings: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    elements_at: tuple[int, int] = (0, 0)

    @property
    def dimension(self) -> int:
        """2 or 3, from the coordinates."""
        return int(self.coordinates.shape[1])

    @property
    def summary(self) -> dict[str, str | int]:
        """Name, path, law and dimension: which scene it is."""
        return {"name": self.name, "path": self.path, "law": self.law, "dimension": self.dimension}

    @cached_property
    def owners(self) -> np.ndarray:
        """(b,) the number of each element's group."""
        return np.repeat(np.arange(len(self.groups)), [len(group.EA) for group in self.groups])

    @cached_property
    def axial_stiffness(self) -> np.ndarray:
        """(b,) EA of every element, in order of groups."""
        return np.concatenate([group.EA for group in self.groups])

    @property
    def element_count(self) -> int:
        """How many elements all groups hold."""
        return sum(len(group.EA) for group in self.groups)

    @property
    def is_geometry(self) -> bool:
        """Whether no group has rest lengths: a shape that `prestress` is to hold."""
        return any(isnan(own) for group in self.groups for own in group.rest_length[:1].tolist())

    def with_rest_lengths(self, rest_lengths: np.ndarray) -> "Scene":
        """Return the same scene with other rest lengths, (b,) in its element order, or OptionError."""
        return self._with_elements("rest_length", "rest_lengths", rest_lengths)

    def with_axial_stiffness(self, EA: np.ndarray) -> "Scene":
        """Return the same scene with other EA, (b,) in its element order, or OptionError."""
        return self._with_elements("EA", "EA", EA)

    def _with_elements(self, column: str, called: str, values: np.ndarray) -> "Scene":
        if np.shape(values) != (self.element_count,):
            shape = np.shape(values)
            raise OptionError(f"{called} must have the shape ({self.element_count},), got {shape}")
        ends = np.cumsum([len(group.EA) for group in self.groups])[:-1]
        own = zip(self.groups, np.split(np.asarray(values, dtype=float), ends), strict=True)
        groups = tuple(Group(**{**vars(group), column: part}) for group, part in own)
        return replace(self, groups=groups)
