"""`prestress`: a geometry in, its self-stress, rest lengths, and a scene that they hold out."""

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from cgff_cli import TOOL, pipeline
from cgff_cli.analysis import measures
from cgff_cli.analysis.equilibrium import labels
from cgff_cli.analysis.heavy import SAME_LENGTH, heavy
from cgff_cli.analysis.orbits import ALIKE, orbits
from cgff_cli.analysis.prestress import Answer, Question, prestressed
from cgff_cli.analysis.ranks import LEAST_TOLERANCE
from cgff_cli.as_given import unmoved
from cgff_cli.errors import OptionError, Problem, SceneError
from cgff_cli.hints import meant_or_all
from cgff_cli.options import DEFAULTS
from cgff_cli.own_lengths import or_its_own
from cgff_cli.refusals import UNSURE, refusal, second_looks
from cgff_cli.result import Result
from cgff_cli.scene.scene import Scene
from cgff_cli.structure import Structure, from_scene, loads_of, weight_at_nodes
from cgff_cli.values import Rule

TOLERABLE = Rule(kind=float, positive=True, below=1.0)
FORCE = Rule(kind=float, largest=1e30)


@dataclass(frozen=True, eq=False)
class Prestressed:
    """What came of a prestress: the fields of the JSON, and what they were found by.

    source, options : the scene that was given, and the options in force
    scene           : the same with rest lengths that hold it, None where there are none
    result          : that scene as `solve` sees it without a step, or None
    feasible        : None where rounding decides       reason  : why it is not True
    never           : elements that carry their sign in no state       idle : those that carry nothing in any
    certificate     : node -> motion; these lengthen cables and shorten struts of `never`, and no others
    force_densities, forces, rest_lengths : (b,) in the scene's element order; tension > 0
    groups          : name -> count, and least and greatest of what the elements have
    """

    source: Scene
    options: dict[str, Any]
    scene: Scene | None
    result: Result | None
    feasible: bool | None
    reason: str | None
    warnings: tuple[str, ...]
    self_stress_states: int | None
    group_states: int | None
    mechanisms: int | None
    rank_gap: float | None
    never: list[str]
    idle: list[str]
    certificate: dict[str, list[float]] | None
    stability: str | None
    super_stable: bool | None
    max_node_motion: float | None
    groups: dict[str, dict[str, Any]]
    force_densities: np.ndarray | None
    forces: np.ndarray | None
    rest_lengths: np.ndarray | None

    schema = "cgff-prestress/1"

    def to_dict(self) -> dict[str, Any]:
        """Return every field of the JSON, in the order it is written."""
        own = {field.name: getattr(self, field.name) for field in fields(self)[4:]}
        source = self.source.summary
        return {"schema": self.schema, "tool": dict(TOOL), "scene": source, "options": self.options, **own}


def prestress(
    scene: Scene | str,
    *,
    by_group: bool = False,
    by_symmetry: bool = False,
    equal: str | None = None,
    force: Mapping[str, float] | None = None,
    tolerance: float | None = None,
) -> Prestressed:
    """Return rest lengths that hold a scene, or the scene file at a path, at its own coordinates.

    Its rest lengths, if it has any, are taken only where rounding hides others; supports, loads and
    weight hold. by_group, by_symmetry: members of a group, or that a symmetry exchanges, share a force
    density; equal="force": a force. force: {group: its greatest force}; default: cables strained by 1 %.
    tolerance: singular values up to it count as states, and the shape gives way to make one of them
    exact. Raises SceneError for a bad file, OptionError for a bad option; where nothing holds the shape,
    `feasible` is not True and `reason` says why.
    """
    if not isinstance(scene, Scene):
        from cgff_cli.scene.read import load

        scene = load(scene)
    asked = _checked(scene, by_group, by_symmetry, equal, force, tolerance)
    structure = _at_rest(scene)
    owners = scene.owners
    classes = owners if by_group else None
    if by_symmetry:
        classes = orbits(structure, max(ALIKE, asked["tolerance"]))
    members, value = None, 0.0
    for name, number in asked["force"].items():
        members, value = owners == [group.name for group in scene.groups].index(name), abs(number)
    EA = scene.axial_stiffness
    shared = (classes, equal == "force", members, value, asked["tolerance"])
    question = Question(structure, EA, scene.law, *shared)
    answer = prestressed(question)
    if scene.weights is not None and scene.weights.any():
        weights, down = scene.weights, scene.down
        answer = heavy(
            question, lambda l0: loads_of(scene) + weight_at_nodes(structure, weights * l0, down), answer
        )
    return _told(scene, asked, or_its_own(scene, asked, answer))


def _told(source: Scene, asked: dict[str, Any], answer: Answer) -> Prestressed:
    """Return an answer with names, and the judgement of the scene that it makes."""
    scene = _held(source, answer, asked["tolerance"] > LEAST_TOLERANCE)
    result = None if scene is None else _result(scene)
    analysis = {} if result is None else result.analysis
    said = () if result is None else second_looks(answer, result)
    moved = np.zeros((1, 1)) if scene is None else scene.coordinates - source.coordinates
    is_moved = scene is not None and scene.coordinates is not source.coordinates
    motion = None if answer.motion is None else answer.motion.tolist()
    return Prestressed(
        source=source,
        options=asked,
        scene=scene,
        result=result,
        feasible=None if answer.why in UNSURE else not answer.why,
        reason=refusal(source, answer, asked) if answer.why else None,
        warnings=source.warnings + said,
        self_stress_states=answer.states,
        group_states=answer.group_states,
        mechanisms=answer.mechanisms,
        rank_gap=answer.gap,
        never=labels(source, np.flatnonzero(answer.never)),
        idle=labels(source, np.flatnonzero(answer.idle)),
        certificate=motion and dict(zip(source.node_names, motion, strict=True)),
        stability=analysis.get("stability"),
        super_stable=analysis.get("super_stable"),
        max_node_motion=float(np.linalg.norm(moved, axis=1).max()) if is_moved else None,
        groups={} if result is None else _groups(result, answer),
        force_densities=None if result is None else answer.force_densities,
        forces=None if result is None else answer.forces,
        rest_lengths=None if result is None else result.structure.rest_lengths,
    )


def _result(scene: Scene) -> Result:
    """Return a scene as it is, be it unstable, as a result with all that can be told of it."""
    solution = unmoved(scene, DEFAULTS.merged(scene.solver).tolerance)
    structure = solution.mechanics.structure
    return pipeline.analysed_in_full(Result(scene, structure, DEFAULTS, solution, 0.0))


def _held(source: Scene, answer: Answer, moved: bool) -> Scene | None:
    """Return the scene that is in balance at its own start; None where there is none."""
    if answer.why or answer.rest_lengths is None or answer.coordinates is None:
        return None
    ends = np.cumsum([len(group.EA) for group in source.groups])[:-1]
    own = [_evened(part) for part in np.split(answer.rest_lengths, ends)]
    scene = replace(source, coordinates=answer.coordinates) if moved else source
    return scene.with_rest_lengths(np.concatenate(own))


def _groups(result: Result, answer: Answer) -> dict[str, dict[str, Any]]:
    """Return for each group its count and the least and greatest of what its elements have."""
    counts = [len(group.EA) for group in result.source.groups]
    columns = {
        "force_density": answer.force_densities,
        "force": answer.forces,
        "rest_length": result.structure.rest_lengths,
        "strain": result.strains,
    }
    spans = {name: measures.spans(values, counts) for name, values in columns.items()}
    return {
        group.name: {"count": count, **{name: spans[name][i] for name in spans}}
        for i, (group, count) in enumerate(zip(result.source.groups, counts, strict=True))
    }


def _checked(
    scene: Scene,
    by_group: bool,
    by_symmetry: bool,
    equal: str | None,
    force: Mapping[str, float] | None,
    tolerance: float | None,
) -> dict[str, Any]:
    """Return the options by name; raises OptionError where one is none, or two contradict each other."""
    equal, tolerance = equal or EQUAL[0], LEAST_TOLERANCE if tolerance is None else tolerance
    if by_group and by_symmetry:
        raise OptionError("members share values by group or by symmetry, not by both")
    if equal not in EQUAL:
        raise OptionError(f"equal must be one of {', '.join(EQUAL)}, got {equal!r}")
    if equal == "force" and not (by_group or by_symmetry):
        raise OptionError("an equal force needs members that share it: by group or by symmetry")
    kinds, forces = {group.name: group.kind for group in scene.groups}, dict(force or {})
    if len(forces) > 1:
        raise OptionError("one force alone sets the level of a self-stress")
    for name, value in forces.items():
        if name not in kinds:
            raise OptionError(f"unknown group {name!r}{meant_or_all(name, kinds)}")
        forces[name] = number = FORCE.checked(f"force of {name}", value)
        if number == 0.0 or (number < 0.0 and kinds[name] == "cable"):
            raise OptionError(f"force of {name} must be a number > 0, got {value!r}")
    return {
        "by_group": by_group,
        "by_symmetry": by_symmetry,
        "equal": equal,
        "force": forces,
        "tolerance": max(LEAST_TOLERANCE, TOLERABLE.checked("tolerance", tolerance)),
    }


EQUAL = ("force density", "force")
"""What members may share."""


def _at_rest(scene: Scene) -> Structure:
    """Return the arrays of a scene whose rest lengths are its lengths; SceneError where one is none."""
    X, pairs = scene.coordinates, np.concatenate([group.pairs for group in scene.groups])
    l = np.linalg.norm(X[pairs[:, 0]] - X[pairs[:, 1]], axis=1)
    without = np.flatnonzero(l <= 1e-12 * np.ptp(X, axis=0).max())
    if len(without):
        label = labels(scene, without[:1])[0]
        message = f"elements: {label!r} has no length, so that its force has no direction"
        raise SceneError([Problem(scene.path, *scene.elements_at, message)])
    return from_scene(scene.with_rest_lengths(l))


def _evened(values: np.ndarray) -> np.ndarray:
    """Return the rest lengths of a group; those that differ by rounding alone are made equal."""
    middle = float(np.sort(values)[len(values) // 2])
    return np.full_like(values, middle) if np.ptp(values) <= SAME_LENGTH * middle else values
