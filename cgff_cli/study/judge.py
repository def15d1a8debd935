"""From where a method came to, the facts of its row: all methods by the same rules."""

from dataclasses import replace
from statistics import median
from typing import NamedTuple

import numpy as np

from cgff_cli.analysis.equilibrium import analysed
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.rivals.registry import REGISTRY
from cgff_cli.rivals.trace import TOLERANCES, Mark
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.study.alignment import aligned, distance_difference, largest_move
from cgff_cli.study.record import Method, Nodes, Point, ShapePoint
from cgff_cli.study.runs import Case, Run

CONVERGED = (Verdict.CONVERGED, Verdict.ROUNDING_FLOOR, "other_equilibrium")
"""Verdicts that stand for an equilibrium: of the scene, or of a method's own force densities."""

EXACT = 2.0**12
"""Rounding floors of force that a shape right to about 1e-12 of its size may leave out of balance."""


class Answer(NamedTuple):
    """CGFF's shape (n, d) about the centroid of the start, its lengths and force densities (b,)."""

    X: np.ndarray
    lengths: np.ndarray
    force_densities: np.ndarray


def solution_at(case: Case, X: np.ndarray) -> Solution:
    """Return the Solution that a shape (n, d) about the centroid of the start amounts to."""
    mechanics = Mechanics(case.structure)
    tolerance = case.options.tolerance
    found = Solution(mechanics.at(mechanics.moving(X)), Verdict.STEP_VANISHED, tolerance, 0)
    if found.relative <= tolerance:
        return replace(found, verdict=Verdict.CONVERGED)
    return replace(found, verdict=Verdict.ROUNDING_FLOOR) if found.balance.at_floor else found


def judged(scene: Scene, case: Case, name: str, runs: list[Run], cgff: Answer | None) -> Method:
    """Return the row of a method from its runs; the first tells, all are timed."""
    end = runs[0].end
    if end is None or not np.isfinite(end.X).all():
        verdict = "failed" if end is None else end.verdict
        return Method(name, verdict, False, runs[0].failure or "its shape has no finite size")
    alignment = "affine" if REGISTRY[name].is_affine else case.alignment
    X = end.X if cgff is None else aligned(end.X, cgff.X, alignment)
    solution = solution_at(case, X if alignment == "affine" else end.X)
    verdict, message = _verdict(solution, end.verdict, end.message, case.time_limit)
    stable = None
    if verdict in (Verdict.CONVERGED, Verdict.ROUNDING_FLOOR):
        balanced = replace(solution, verdict=Verdict(verdict))
        stable = analysed(scene, balanced, case.options)["stable"]
    lengths, q = solution.lengths, solution.force_densities
    if end.force_densities is not None:
        q = _scaled(end.force_densities, cgff) if alignment == "affine" else end.force_densities
    return Method(
        name,
        verdict,
        verdict in CONVERGED,
        message,
        stable,
        runs[0].trace.iterations,
        runs[0].trace.evaluations,
        median(run.seconds for run in runs),
        solution.relative,
        solution.energy,
        alignment,
        nodes(scene, solution.placed(X)),
        lengths.tolist(),
        q.tolist(),
        *_differences(X, lengths, q, cgff or Answer(X, lengths, q)),
        tuple(_curve([run.trace.by_residual for run in runs])),
        tuple(_shape_curve([run.trace.by_shape for run in runs])),
    )


def nodes(scene: Scene, X: np.ndarray) -> Nodes:
    """Return positions (n, d) by node name."""
    return dict(zip(scene.node_names, X.tolist(), strict=True))


def _verdict(solution: Solution, ended: str, message: str, time_limit: float) -> tuple[str, str]:
    """Return the verdict and a sentence on it: what the forces say first, then what the method says."""
    if solution.verdict.converged:
        own = f" ({message})" if ended == "form_found" else ""
        return solution.verdict.value, solution.message + own
    left = f"out-of-balance force {solution.relative:.1e} of the largest force"
    if ended == "form_found" and _is_rounding(solution):
        return Verdict.ROUNDING_FLOOR.value, (
            f"equilibrium to the rounding of its coordinates: {left} ({message})"
        )
    if ended == "form_found":
        return "other_equilibrium", (
            f"a self-stressed form of this connectivity, {message}, which the scene's EA and rest lengths "
            f"do not hold: {left}"
        )
    if ended == "time_limit":
        return ended, f"no equilibrium yet: stopped after {time_limit:g} s with {left}"
    if ended == "max_iterations" and not message:
        return ended, f"no equilibrium yet: evaluation limit reached with {left}"
    if not ended or ended in CONVERGED:
        return "gave_up", f"no equilibrium: it ended by itself with {left}; {message}".rstrip("; ")
    return ended, message or f"no equilibrium: {left}"


def _is_rounding(solution: Solution) -> bool:
    """Return whether a shape that was not found from the scene's forces balances them all the same."""
    return solution.residual_max <= EXACT * solution.floor


def _scaled(q: np.ndarray, cgff: Answer | None) -> np.ndarray:
    """Return force densities known up to a factor, scaled to CGFF's, least squares."""
    return q if cgff is None else q * float(q @ cgff.force_densities) / float(q @ q)


def _differences(
    X: np.ndarray, lengths: np.ndarray, q: np.ndarray, cgff: Answer
) -> tuple[float, float, float, float | None]:
    return (
        largest_move(X, cgff.X),
        float(np.abs(lengths - cgff.lengths).max()),
        float(np.abs(q - cgff.force_densities).max()),
        distance_difference(X, cgff.X),
    )


def _curve(runs: list[dict[float, Mark]]) -> list[Point]:
    return [
        Point(tolerance, mark.iterations, seconds, mark.shape_error)
        if mark
        else Point(tolerance, None, None, None)
        for tolerance, mark, seconds in _medians(runs)
    ]


def _shape_curve(runs: list[dict[float, Mark]]) -> list[ShapePoint]:
    return [
        ShapePoint(tolerance, mark.iterations, seconds, mark.residual)
        if mark
        else ShapePoint(tolerance, None, None, None)
        for tolerance, mark, seconds in _medians(runs)
    ]


def _medians(runs: list[dict[float, Mark]]) -> list[tuple[float, Mark | None, float | None]]:
    """Return for each tolerance the first run's mark and the median time of all that reached it."""
    rows: list[tuple[float, Mark | None, float | None]] = []
    for tolerance in TOLERANCES:
        reached = [run[tolerance].seconds for run in runs if tolerance in run]
        mark = runs[0].get(tolerance)
        rows.append((tolerance, mark, median(reached) if mark else None))
    return rows
