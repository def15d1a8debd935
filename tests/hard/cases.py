"""The hard scenes as data: read, built, solved and judged against references that no solver of ours made."""

import random
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml

import cgff_cli
from cgff_cli.scene.scene import AXES

FOLDER = Path(__file__).parent
STRUCTURES = FOLDER.parents[1] / "structures"
FILES = ("ends.yaml", "scales.yaml", "shapes.yaml", "large.yaml")
MOST_ITERATIONS = 200
"""No scene needs more: the work grows with the scene, not with its condition number."""
EPS = float(np.finfo(float).eps)
SAME_LENGTH = 1e-9
"""Lengths agree to this share of the largest, or to what the conditioning allows if that is more."""


@dataclass(frozen=True)
class Case:
    """One entry: how its scene is made, the options to solve it by, and what must come out."""

    id: str
    scene: dict[str, Any]
    options: dict[str, Any]
    expect: dict[str, Any]
    covers: list[str]
    source: str
    slow: bool = False
    reference: str = "none"
    near: list[list[float]] | None = None
    same_iterations_as: str | None = None
    wrong: str | None = None


@dataclass(frozen=True)
class Outcome:
    """What came out: a word such as converged-stable, the Result where there is one, errors by field."""

    word: str
    result: "cgff_cli.Result | None"
    errors: dict[str, float]
    allowed: dict[str, float]
    message: str = ""

    @property
    def share(self) -> float:
        """Largest error over what is allowed."""
        return max((self.errors[key] / self.allowed[key] for key in self.errors), default=0.0)


@cache
def cases() -> dict[str, Case]:
    """Return every case by its id."""
    found: dict[str, Case] = {}
    for name in FILES:
        for entry in yaml.safe_load((FOLDER / name).read_text()):
            case = Case(**{"options": {}, **entry})
            assert case.id not in found, case.id
            found[case.id] = case
    return found


@cache
def references() -> dict[str, dict[str, Any]]:
    """Return id -> what `make_references.py` computed to 30 digits."""
    path = FOLDER / "references.yaml"
    return yaml.load(path.read_text(), getattr(yaml, "CSafeLoader", yaml.SafeLoader)) or {}


def built(recipe: dict[str, Any], path: str = "<hard>") -> "cgff_cli.Scene":
    """Return a scene: inline, from structures/, or of a family, then moved, scaled or disturbed in order."""
    changes = dict(recipe)
    if "structure" in changes:
        scene = cgff_cli.load(STRUCTURES / f"{changes.pop('structure')}.yaml")
    elif "chain" in changes:
        scene = cgff_cli.from_dict(chain(**changes.pop("chain")))
    elif "family" in changes:
        scene = cgff_cli.new(changes.pop("family"), **changes.pop("parameters", {}))
    else:
        plain = {key: changes.pop(key) for key in tuple(changes) if key not in CHANGES}
        scene = cgff_cli.from_dict(plain)
    for name, value in changes.items():
        scene = CHANGES[name](scene, value)
    return scene


def chain(links: int, span: float, length: float, EA: list[float], weight: float) -> dict[str, Any]:
    """Return a chain of equal links, of the stiffnesses EA in turn, that starts as a level line."""
    last = f"n{links}"
    return {
        "law": "hooke",
        "nodes": {f"n{i}": [span * i / links, 0.0] for i in range(links + 1)},
        "elements": {
            "links": {
                "kind": "cable",
                "EA": [EA[i % len(EA)] for i in range(links)],
                "rest_length": length / links,
                "pairs": [[f"n{i}", f"n{i + 1}"] for i in range(links)],
            }
        },
        "supports": {"n0": "xy", last: "xy"},
        "loads": {f"n{i}": [0.0, -weight / links] for i in range(1, links)},
    }


def _flattened(scene, factors):
    return replace(scene, coordinates=scene.coordinates * np.array(factors))


def _offset(scene, by):
    return replace(scene, coordinates=scene.coordinates + np.array(by))


def _in_units(scene, units):
    length, force = units
    stiffness = force / length if scene.law == "paper" else force
    groups = tuple(
        replace(group, EA=group.EA * stiffness, rest_length=group.rest_length * length)
        for group in scene.groups
    )
    loads = {row: tuple(force * part for part in load) for row, load in scene.loads.items()}
    return replace(scene, coordinates=scene.coordinates * length, groups=groups, loads=loads)


def _random_start(scene, seed):
    """Return the scene with its free directions anywhere in a box of twice the longest rest length."""
    return _moved(scene, seed, max(float(group.rest_length.max()) for group in scene.groups), 0.0)


def _noisy(scene, given):
    seed, reach = given
    X, groups = scene.coordinates, scene.groups
    l = np.concatenate([np.linalg.norm(X[g.pairs[:, 0]] - X[g.pairs[:, 1]], axis=1) for g in groups])
    return _moved(scene, seed, reach * float(l.mean()), 1.0)


def _moved(scene, seed, reach, kept):
    draw = random.Random(f"hard {seed}").uniform
    X = scene.coordinates
    moved = kept * X + np.array([draw(-reach, reach) for _ in range(X.size)]).reshape(X.shape)
    for row, axes in scene.supports.items():
        held = [AXES.index(axis) for axis in axes]
        moved[row, held] = X[row, held]
    return replace(scene, coordinates=moved)


def _stiffened(scene, factors):
    groups = tuple(replace(group, EA=group.EA * factors.get(group.name, 1.0)) for group in scene.groups)
    return replace(scene, groups=groups)


def _every_other_stiffened(scene, factor):
    """Return the scene with every other element of each group stiffer."""
    groups = tuple(
        replace(group, EA=group.EA * np.where(np.arange(len(group.EA)) % 2, factor, 1.0))
        for group in scene.groups
    )
    return replace(scene, groups=groups)


CHANGES = {
    "flatten": _flattened,
    "units": _in_units,
    "random_start": _random_start,
    "noise": _noisy,
    "stiffen": _stiffened,
    "stiffen_every_other": _every_other_stiffened,
    "offset": _offset,
}


def solved(case: Case) -> Outcome:
    """Return what cgff makes of a case, measured against its reference."""
    try:
        scene = built(case.scene, case.id)
    except cgff_cli.SceneError as error:
        return Outcome("refused", None, {}, {}, str(error))
    result = cgff_cli.solve(scene, **case.options)
    word = result.verdict
    if result.converged:
        kind = result.analysis["stability"] or "unjudged"
        word = f"{'floor' if word == 'rounding_floor' else 'converged'}-{kind}"
    reference = references().get(case.id)
    if reference is None or not result.converged:
        return Outcome(word, result, {}, {}, result.message)
    errors, allowed = measured(result, reference, case.expect)
    return Outcome(word, result, errors, allowed, result.message)


def agrees(word: str, expected: str) -> bool:
    """Return whether an outcome is the one expected; `balanced` stands for `converged` or `floor`."""
    if expected.startswith("balanced"):
        return word in (expected.replace("balanced", kind, 1) for kind in ("converged", "floor"))
    return word == expected


def measured(
    result: "cgff_cli.Result", reference: dict[str, Any], expect: dict[str, Any]
) -> tuple[dict[str, float], dict[str, float]]:
    """Return errors and allowed errors, each relative: lengths, distances to the longest length and so on.

    A shape is known to the out-of-balance force over the softest stiffness, forces to that times k; what
    the reference's `softest` or the entry's `tolerance` allow beyond 1e-9 follows from that.
    """
    longest = float(np.abs(result.lengths).max()) or 1.0
    size = float(np.ptp(result.coordinates, axis=0).max()) or longest
    strength = max(result.residual["reference_force"], float(np.abs(result.forces).max())) or 1.0
    stiffest = float(result.structure.stiffness.max())
    left = float(result.options["tolerance"]) * strength + rounding(result)
    moved = expect.get("tolerance", SAME_LENGTH) * longest
    if reference.get("softest"):
        moved = max(moved, 4.0 * np.sqrt(result.coordinates.size) * left / float(reference["softest"]))
    errors, allowed = {}, {}
    if "lengths" in reference:
        errors["lengths"] = _difference(result.lengths, reference["lengths"]) / longest
        allowed["lengths"] = moved / longest
    if "forces" in reference:
        errors["forces"] = _difference(result.forces, reference["forces"]) / strength
        allowed["forces"] = max(1e-9, 2.0 * stiffest * moved / strength)
    if "distances" in reference:
        X = result.solution.state.X
        own = np.linalg.norm(X[:, None] - X[None, :], axis=-1)[np.triu_indices(len(X), 1)]
        errors["shape"] = _difference(own, reference["distances"]) / longest
        allowed["shape"] = 4.0 * moved / longest
    if "energy" in reference:
        unit = max(abs(float(reference["energy"])), float((result.forces * result.lengths).max()), 1e-300)
        if abs(float(reference["energy"])) < 1e-30 * stiffest * longest**2:  # none, but for rounding
            unit = 1e-10 * stiffest * longest**2
        unit += float(np.abs(result.structure.loads * result.coordinates).sum())
        errors["energy"] = abs(result.energy - float(reference["energy"])) / unit
        allowed["energy"] = 1e-9
    for name, length in reference.get("group_lengths", {}).items():
        rows = np.concatenate([np.full(len(g.EA), g.name == name) for g in result.source.groups])
        wrong = float(np.abs(result.lengths[rows] - float(length)).max()) / longest
        errors["lengths"] = max(errors.get("lengths", 0.0), wrong)
        allowed["lengths"] = moved / longest
    for name, place in reference.get("nodes", {}).items():
        wrong = _difference(np.array(result.nodes[name]), place) / size
        errors["nodes"] = max(errors.get("nodes", 0.0), wrong)
        allowed["nodes"] = max(moved / longest, 4.0 * EPS * float(np.abs(result.coordinates).max()) / size)
    return errors, allowed


def _difference(values: np.ndarray, digits: list[str]) -> float:
    expected = np.array([float(number) for number in digits])
    return float(np.abs(values - expected).max(initial=0.0))


def rounding(result: "cgff_cli.Result") -> float:
    """Return the rounding error of the largest nodal force about the middle of the structure."""
    s, X = result.structure, result.solution.state.X
    far = np.abs(X - X.mean(axis=0)).max(axis=1)
    each = EPS * s.stiffness * (result.lengths + far[s.start] + far[s.end])
    ends = np.concatenate((s.start, s.end))
    return float(np.bincount(ends, np.concatenate((each, each))).max())


def imbalance(result: "cgff_cli.Result") -> tuple[float, float]:
    """Return the largest out-of-balance force and its rounding error, by a loop over elements.

    Both relative to the largest element force or load, or k l where no force is more than rounding.
    """
    s, X = result.structure, result.solution.state.X
    X = X - X.mean(axis=0)
    total = np.where(s.free, s.loads, 0.0)
    blur, strength, stiffest = np.zeros(len(X)), float(np.abs(s.loads).max()), 0.0
    for e, (i, j) in enumerate(zip(s.start.tolist(), s.end.tolist(), strict=True)):
        V = X[j] - X[i]
        l = float(np.sqrt(V @ V))
        k, stretch = float(s.stiffness[e]), l - float(s.rest_lengths[e])
        known = EPS * k * (l + float(np.abs(X[i]).max()) + float(np.abs(X[j]).max()))
        blur[[i, j]] += known
        stiffest = max(stiffest, k * l)
        if l == 0.0 or (s.tension_only[e] and stretch < 0.0):
            continue
        pull = k * stretch * V / l
        strength = max(strength, k * abs(stretch))
        total[i] += pull
        total[j] -= pull
    error = float(blur.max())
    unit = strength if strength > 16.0 * error else stiffest
    return float(np.abs(total[s.free]).max(initial=0.0)) / (unit or 1.0), error / (unit or 1.0)


def is_balanced(case: Case, result: "cgff_cli.Result") -> bool:
    """Return whether the loop confirms a balance to the tolerance, or to four times its rounding error."""
    left, blur = imbalance(result)
    return left <= 1.01 * float(case.options.get("tolerance", 1e-10)) + 4.0 * blur


def is_right(case: Case, outcome: Outcome) -> bool:
    """Return whether outcome, errors, slack cables and warnings are those expected, and forces balance."""
    result = outcome.result
    if not agrees(outcome.word, case.expect["outcome"]) or outcome.share > 1.0:
        return False
    if result is None:
        return True
    if result.converged and result.counts["iterations"] > MOST_ITERATIONS:
        return False
    if case.expect.get("slack", result.analysis["slack_count"]) != result.analysis["slack_count"]:
        return False
    if not any(
        case.expect.get("warns", "") in said for said in (*result.warnings, case.expect.get("warns", ""))
    ):
        return False
    return not result.converged or is_balanced(case, result)
