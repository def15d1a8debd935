"""The hard scenes as data: read, built, solved and judged against references that no solver of ours made."""

from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import yaml

import cgff_cli
from cgff_cli.study.case import Case as Entry
from cgff_cli.study.case import agrees, as_expected, built, outcome
from cgff_cli.study.suite import cases_of

FOLDER = Path(__file__).parent
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
    scene: Entry
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
    entries = cases_of(str(FOLDER / name) for name in FILES)
    return {own.id: Case(own.id, own, own.options, own.expect, **own.notes) for own in entries}


@cache
def references() -> dict[str, dict[str, Any]]:
    """Return id -> what `make_references.py` computed to 30 digits."""
    path = FOLDER / "references.yaml"
    return yaml.load(path.read_text(), getattr(yaml, "CSafeLoader", yaml.SafeLoader)) or {}


def solved(case: Case) -> Outcome:
    """Return what cgff makes of a case, measured against its reference."""
    try:
        scene = built(case.scene)
    except cgff_cli.SceneError as error:
        return Outcome("refused", None, {}, {}, str(error))
    result = cgff_cli.solve(scene, **case.options)
    word = outcome(result)
    reference = references().get(case.id)
    if reference is None or not result.converged:
        return Outcome(word, result, {}, {}, result.message)
    errors, allowed = measured(result, reference, case.expect)
    return Outcome(word, result, errors, allowed, result.message)


def measured(
    result: "cgff_cli.Result", reference: dict[str, Any], expect: dict[str, Any]
) -> tuple[dict[str, float], dict[str, float]]:
    """Return errors and allowed errors, each relative: lengths, distances to the longest length and so on.

    A shape is known to the out-of-balance force over the softest stiffness, forces to that times k; what
    the reference's `softest` or the entry's `tolerance` allow beyond 1e-9 follows from that. Where only nodes
    are known, force over length is the stiffness that holds them, and their relative errors are alike.
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
        X = result.solution.shape
        own = np.linalg.norm(X[:, None] - X[None, :], axis=-1)[np.triu_indices(len(X), 1)]
        errors["shape"] = _difference(own, reference["distances"]) / longest
        allowed["shape"] = 4.0 * moved / longest
    if "energy" in reference:
        unit = max(abs(float(reference["energy"])), float((result.forces * result.lengths).max()), 1e-300)
        start = max(longest, float(np.ptp(result.structure.coordinates, axis=0).max()))
        if abs(float(reference["energy"])) < 1e-30 * stiffest * start**2:  # none, but for rounding
            unit = 1e-10 * stiffest * start**2
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
        rounded = 4.0 * EPS * float(np.abs(result.coordinates).max()) / size
        allowed["nodes"] = max(moved / longest, rounded, result.residual["relative"])
    return errors, allowed


def _difference(values: np.ndarray, digits: list[str]) -> float:
    expected = np.array([float(number) for number in digits])
    return float(np.abs(values - expected).max(initial=0.0))


def rounding(result: "cgff_cli.Result") -> float:
    """Return the rounding error of the largest nodal force about the middle of the structure."""
    s, X = result.structure, result.solution.shape
    far = np.abs(X - X.mean(axis=0)).max(axis=1)
    each = EPS * s.stiffness * (result.lengths + far[s.start] + far[s.end])
    ends = np.concatenate((s.start, s.end))
    return float(np.bincount(ends, np.concatenate((each, each))).max())


def imbalance(result: "cgff_cli.Result") -> tuple[float, float]:
    """Return the largest out-of-balance force and its rounding error, by a loop over elements.

    Both relative to the largest element force or load, or k l where no force is more than rounding.
    """
    s, X = result.structure, result.solution.shape
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
    start = s.coordinates[s.start] - s.coordinates[s.end]
    whole = float((s.stiffness * np.sqrt((start * start).sum(axis=1))).max())  # a shape may shrink to a point
    if strength <= 16.0 * max(error, EPS * whole):
        return float(np.abs(total[s.free]).max(initial=0.0)) / max(stiffest, whole, 1e-300), 16.0 * EPS
    unit = strength
    return float(np.abs(total[s.free]).max(initial=0.0)) / (unit or 1.0), error / (unit or 1.0)


def is_balanced(case: Case, result: "cgff_cli.Result") -> bool:
    """Return whether the loop confirms a balance to the tolerance, or to four times its rounding error."""
    left, blur = imbalance(result)
    return left <= 1.01 * float(case.options.get("tolerance", 1e-10)) + 4.0 * blur


def is_right(case: Case, found: Outcome) -> bool:
    """Return whether outcome, errors, slack cables and warnings are those expected, and forces balance."""
    result = found.result
    if not agrees(found.word, case.expect["outcome"]) or found.share > 1.0:
        return False
    if result is None:
        return True
    if result.converged and result.counts["iterations"] > MOST_ITERATIONS:
        return False
    if not as_expected(result, case.expect):
        return False
    return not result.converged or is_balanced(case, result)
