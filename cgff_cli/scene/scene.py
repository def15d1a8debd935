"""What a scene is: plain columns, names once, node rows everywhere else."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isnan

import numpy as np

from cgff_cli.errors import OptionError
from cgff_cli.hints import did_you_mean, meant_or_all
from cgff_cli.scene.laws import rules
from cgff_cli.values import DEAD

LAWS = ("paper", "hooke")
KINDS = ("cable", "strut")
AXES = "xyz"

Loads = Mapping[int, tuple[float, ...]]
"""Node row -> (d,) force."""


@dataclass(frozen=True, eq=False)  # arrays have no one answer to ==
class Group:
    """Elements of one kind: m pairs of node rows with their EA and rest lengths.

    pairs       : (m, 2) int array, rows into Scene.node_names: begin, end
    EA          : (m,) array, force under law `hooke`, force per length under law `paper`
    rest_length : (m,) array, the scene's length unit; NaN in a geometry
    pretension  : (m,) array, forces that rest_length was asked to give at the start; None where it was not
    weight      : (m,) array, force per rest length; None where there is none
    own         : keys that begin with x-, and their plain values
    """

    name: str
    kind: str
    pairs: np.ndarray
    EA: np.ndarray
    rest_length: np.ndarray
    pretension: np.ndarray | None = None
    weight: np.ndarray | None = None
    own: Mapping[str, object] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Scene:
    """One structure as its user described it; the reader has checked all of it.

    coordinates : (n, d) array, d = 2 or 3, the start shape
    supports    : node row -> axes held fixed, a subset of "xyz" in that order
    loads       : node row -> (d,) nodal force
    solver      : solve options asked for in the file
    files       : paths it was read from, its tables among them
    elements_at : line and column of the key `elements`, 0 where it has none
    gravity     : (d,) direction of weight; None: down the last axis
    load_cases  : name -> node row -> (d,) force, added to loads and weight where that case is asked for
    combinations : name -> case, or "dead" for loads and weight -> factor
    case        : the case or combination that loads and weight are of, "" where none is
    begins      : where a solve of a case begins        whole : the scene that it is a case of
    own         : keys that begin with x-, and their plain values
    notes       : what was passed over while reading, for whoever wants many words
    answer      : where it was read from the result of a solve, that result's verdict and history
    """

    name: str
    law: str
    node_names: tuple[str, ...]
    coordinates: np.ndarray
    groups: tuple[Group, ...]
    supports: Mapping[int, str] = field(default_factory=dict)
    loads: Loads = field(default_factory=dict)
    solver: Mapping[str, object] = field(default_factory=dict)
    path: str = "<python>"
    warnings: tuple[str, ...] = ()
    files: tuple[str, ...] = ()
    elements_at: tuple[int, int] = (0, 0)
    gravity: tuple[float, ...] | None = None
    load_cases: Mapping[str, Loads] = field(default_factory=dict)
    combinations: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    case: str = ""
    begins: str = ""
    whole: "Scene | None" = None
    own: Mapping[str, object] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    answer: Mapping[str, object] | None = None

    @property
    def dimension(self) -> int:
        """2 or 3, from the coordinates."""
        return int(self.coordinates.shape[1])

    @property
    def summary(self) -> dict[str, str | int]:
        """Name, path, law, dimension and the case, if it is in one: which scene it is."""
        case: dict[str, str | int] = {"case": self.case, "begins": self.begins} if self.case else {}
        return {"name": self.name, "path": self.path, "law": self.law, "dimension": self.dimension, **case}

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

    @cached_property
    def weights(self) -> np.ndarray | None:
        """(b,) weight of every element, force per rest length; None where none has any."""
        if all(group.weight is None for group in self.groups):
            return None
        zeros = (np.zeros_like(group.EA) for group in self.groups)
        own = zip(self.groups, zeros, strict=True)
        return np.concatenate([zero if group.weight is None else group.weight for group, zero in own])

    @property
    def down(self) -> np.ndarray:
        """(d,) unit vector along which weight acts."""
        way = self.gravity or (*[0.0] * (self.dimension - 1), -1.0)
        return np.array(way) / np.linalg.norm(way)

    @property
    def is_geometry(self) -> bool:
        """Whether no group has rest lengths: a shape that `prestress` is to hold."""
        return any(isnan(own) for group in self.groups for own in group.rest_length[:1].tolist())

    def in_case(self, name: str) -> "Scene":
        """Return the scene with the loads of a load case or combination, "dead" for none; see `load_cases`.

        Raises OptionError where there is none of that name.
        """
        if name in self.load_cases:
            factors = {DEAD: 1.0, name: 1.0}
        elif name == DEAD:
            factors = {DEAD: 1.0}
        elif name in self.combinations:
            factors = {DEAD: 0.0, **self.combinations[name]}
        else:
            known = meant_or_all(name, self.cases) if self.cases else ": the scene has no load cases"
            raise OptionError(f"no load case is named {name!r}{known}")
        total: dict[int, np.ndarray] = {}
        for part, factor in factors.items():
            for row, load in (self.loads if part == DEAD else self.load_cases[part]).items():
                total[row] = total.get(row, 0.0) + factor * np.array(load)
        scene = replace(
            self, case=name, whole=self, loads={row: tuple(load.tolist()) for row, load in total.items()}
        )
        if self.weights is None or factors[DEAD] == 1.0:
            return scene
        own = (None if group.weight is None else factors[DEAD] * group.weight for group in self.groups)
        pairs = zip(self.groups, own, strict=True)
        return replace(scene, groups=tuple(replace(group, weight=weight) for group, weight in pairs))

    @property
    def cases(self) -> tuple[str, ...]:
        """Names of all load cases and combinations."""
        return (*self.load_cases, *self.combinations)

    def with_loads(self, loads: Mapping[str, Sequence[float]]) -> "Scene":
        """Return the same scene with other loads, node name -> force, in place of its own, or OptionError."""
        return replace(self, loads={self.row_of(name): self._point(name, own) for name, own in loads.items()})

    def with_coordinates(self, coordinates: np.ndarray | Mapping[str, Sequence[float]]) -> "Scene":
        """Return the same scene at other coordinates, (n, d) or of some nodes by name, or OptionError.

        Rest lengths stay, those of pretensions too.
        """
        X = np.array(self.coordinates)
        if isinstance(coordinates, Mapping):
            for name, own in coordinates.items():
                X[self.row_of(name)] = self._point(name, own)
        else:
            given = _doubles(coordinates)
            if given is None or given.shape != X.shape or not np.isfinite(given).all():
                raise OptionError(f"coordinates must be finite numbers of the shape {X.shape}")
            X = given
        groups = tuple(replace(group, pretension=None) for group in self.groups)
        return replace(self, coordinates=X, groups=groups)

    def begun_at(self, shape: np.ndarray) -> "Scene":
        """Return the same scene with another start, (n, d); what supports hold stays where it is."""
        X = np.array(shape, dtype=float)
        for row, axes in self.supports.items():
            held = [AXES.index(axis) for axis in axes]
            X[row, held] = self.coordinates[row, held]
        return self.with_coordinates(X)

    def row_of(self, name: str) -> int:
        """Return the row of a node; raises OptionError where there is none of that name."""
        if name not in self._rows:
            raise OptionError(f"no node is named {name!r}{did_you_mean(name, self.node_names)}")
        return self._rows[name]

    @cached_property
    def _rows(self) -> dict[str, int]:
        return {name: row for row, name in enumerate(self.node_names)}

    def _point(self, name: str, numbers: Sequence[float]) -> tuple[float, ...]:
        found = _doubles(numbers)
        if found is None or found.shape != (self.dimension,) or not np.isfinite(found).all():
            raise OptionError(f"{name}: must be {self.dimension} finite numbers, got {numbers!r}")
        return tuple(found.tolist())

    def with_rest_lengths(self, rest_lengths: np.ndarray) -> "Scene":
        """Return the same scene with other rest lengths, (b,) in its element order, or OptionError.

        A geometry where all are NaN.
        """
        return self._with_elements("rest_length", "rest_lengths", rest_lengths)

    def with_weights(self, weights: np.ndarray) -> "Scene":
        """Return the same scene with other weights, (b,) per rest length in its order, or OptionError."""
        return self._with_elements("weight", "weights", weights)

    def with_axial_stiffness(self, EA: np.ndarray) -> "Scene":
        """Return the same scene with other EA, (b,) in its element order, or OptionError."""
        return self._with_elements("EA", "EA", EA)

    def _with_elements(self, column: str, called: str, values: object) -> "Scene":
        numbers, rule = _doubles(values), rules(self.law)[column]
        if numbers is None:
            raise OptionError(f"{called} must be an array of numbers")
        if numbers.shape != (self.element_count,):
            raise OptionError(f"{called} must have the shape ({self.element_count},), got {numbers.shape}")
        is_geometry = column == "rest_length" and np.isnan(numbers).all()
        for row in np.flatnonzero(~rule.fits(numbers))[: 0 if is_geometry else 1].tolist():
            raise OptionError(f"{called} must be finite numbers {rule.range}, got {numbers[row]:g}")
        ends = np.cumsum([len(group.EA) for group in self.groups])[:-1]
        own = zip(self.groups, np.split(numbers, ends), strict=True)
        gone = {"pretension": None} if column != "weight" else {}
        groups = tuple(Group(**{**vars(group), column: part, **gone}) for group, part in own)
        return replace(self, groups=groups)


def _doubles(values: object) -> np.ndarray | None:
    """Return values as an array of numbers, None where one is none."""
    try:
        return np.array(values, dtype=float)
    except (TypeError, ValueError):
        return None
