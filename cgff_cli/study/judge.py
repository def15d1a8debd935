"""Running a method under the clock, and the facts of its row: all methods by the same rules."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from statistics import median
from typing import NamedTuple, TypeVar

import numpy as np

from cgff_cli.analysis.equilibrium import analysed
from cgff_cli.errors import CgffError
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.rivals.registry import REGISTRY
from cgff_cli.rivals.task import TOLERANCES, AtResidual, AtShape, End, Stop, Task, Trace
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Gauge, Verdict, Watch
from cgff_cli.study.alignment import (
    SAME_SHAPE,
    affinely,
    distance_difference,
    laid_over,
    largest_move,
    size,
)
from cgff_cli.study.record import Method

EVALUATIONS_PER_ITERATION = 50
"""Evaluations a rival may take for every iteration that the option max_iterations gives CGFF."""

CONVERGED = (Verdict.CONVERGED, Verdict.ROUNDING_FLOOR)
"""Verdicts that stand for an equilibrium of the scene; a balance of other force densities is none."""

EXACT = 2.0**12
"""Rounding floors of force that a shape right to about 1e-12 of its size may leave out of balance."""

At = TypeVar("At", AtResidual, AtShape)


class Attempt(NamedTuple):
    """One run: where it came to, how long it took, what it passed through."""

    end: End
    seconds: float
    trace: Trace

    @property
    def tells_all(self) -> bool:
        """Whether another run would add nothing: this one failed, or ran out of time."""
        return self.end.verdict in ("failed", "time_limit")


def attempted(name: str, task: Task, time_limit: float) -> Attempt:
    """Run a method once; an error is a run that failed, and its words say how."""
    entry, target, unit = REGISTRY[name], task.best.shape, size(task.best.shape)
    mechanics = Mechanics(task.structure)
    most = EVALUATIONS_PER_ITERATION * task.options.max_iterations
    watch = None if entry.judges_itself else Watch(Gauge(mechanics), task.options.tolerance, most)

    def distance(X: np.ndarray) -> float:
        """Return the error in shape of (n, d) positions, over the structure's size."""
        return largest_move(X if entry.is_affine else laid_over(X, target, task.alignment), target) / unit

    trace = Trace(mechanics, watch, time_limit, distance)
    if entry.is_affine:
        trace.judged = lambda X: affinely(X, target)
    try:
        end = entry.run(task, trace)
    except Stop as stop:
        end = End(trace.X, stop.verdict)
    except CgffError as error:
        end = End(None, "failed", str(error))
    except Exception as error:  # a rival of any make: its row says how it failed
        end = End(None, "failed", f"{type(error).__name__}: {error}".rstrip(": "))
    return Attempt(end, trace.seconds, trace)


def solution_at(task: Task, X: np.ndarray) -> Solution:
    """Return the Solution that a shape (n, d) about the centroid of the start amounts to."""
    mechanics, tolerance = Mechanics(task.structure), task.options.tolerance
    found = Solution(mechanics.at(mechanics.moving(X)), Verdict.STEP_VANISHED, tolerance, 0)
    return replace(found, verdict=found.balance.reached(tolerance) or found.verdict)


def judged(scene: Scene, task: Task, name: str, runs: list[Attempt], cgff: Solution | None) -> Method:
    """Return the row of a method from its runs; the first tells, all are timed.

    cgff : the answer that the method is held against, None for CGFF itself
    """
    end = runs[0].end
    if end.X is None or not np.isfinite(end.X).all():
        return Method(name, end.verdict, False, end.message or "its shape has no finite size")
    alignment = "affine" if REGISTRY[name].is_affine else task.alignment
    X = end.X if cgff is None else laid_over(end.X, cgff.shape, alignment)
    solution = solution_at(task, X if alignment == "affine" else end.X)
    shape_error = _shape_error(X, alignment, task)
    verdict, message = _verdict(solution, end, runs[0].trace.time_limit, shape_error)
    lengths, q = solution.lengths, solution.force_densities
    if end.force_densities is not None:
        q = _scaled(end.force_densities, cgff) if alignment == "affine" else end.force_densities
    own = cgff or solution
    return Method(
        name=name,
        verdict=verdict,
        converged=verdict in CONVERGED,
        message=message,
        stable=_stable(scene, task, solution, verdict),
        iterations=runs[0].trace.iterations,
        evaluations=runs[0].trace.evaluations,
        seconds=median(run.seconds for run in runs),
        residual_relative=solution.relative,
        energy=solution.energy,
        alignment=alignment,
        X=solution.placed(X),
        lengths=lengths,
        force_densities=q,
        max_node_difference=largest_move(X, own.shape),
        max_length_difference=float(np.abs(lengths - own.lengths).max()),
        max_force_density_difference=float(np.abs(q - own.force_densities).max()),
        distance_matrix_difference=distance_difference(X, own.shape),
        curve=_medians(AtResidual, [run.trace.by_residual for run in runs]),
        shape_curve=_medians(AtShape, [run.trace.by_shape for run in runs]),
        shape_error=shape_error,
        node_names=scene.node_names,
    )


def _verdict(solution: Solution, end: End, time_limit: float, shape_error: float) -> tuple[str, str]:
    """Return the verdict and a sentence on it: what the forces say first, then what the method says."""
    ended, message, formed = end.verdict, end.message, end.verdict == "form_found"
    if solution.verdict.converged:
        return solution.verdict.value, solution.message + (f" ({message})" if formed else "")
    left = f"out-of-balance force {solution.relative:.1e} of the largest force"
    if formed and solution.residual_max <= EXACT * solution.floor:
        words = f"equilibrium to the rounding of its coordinates: {left} ({message})"
        return Verdict.ROUNDING_FLOOR.value, words
    if formed and shape_error <= SAME_SHAPE:
        return "same_shape", (
            f"cgff's shape to {shape_error:.1e} of its size, {message}; so small a difference, times the "
            f"stiffness, leaves an {left}"
        )
    if formed:
        return "other_equilibrium", (
            f"a self-stressed form of this connectivity, {message}, which the scene's EA and rest lengths "
            f"do not hold: {left}"
        )
    if ended == "time_limit":
        return ended, f"no equilibrium yet: stopped after {time_limit:g} s with {left}"
    if ended == "max_iterations" and not message:
        return ended, f"no equilibrium yet: limit of iterations or evaluations reached with {left}"
    if not ended or ended in CONVERGED:
        return "gave_up", f"no equilibrium: it ended by itself with {left}; {message}".rstrip("; ")
    return ended, message or f"no equilibrium: {left}"


def _stable(scene: Scene, task: Task, solution: Solution, verdict: str) -> bool | None:
    """Return whether an equilibrium of the scene is stable; None where it is none, or that is not known."""
    if verdict not in CONVERGED:
        return None
    balanced = replace(solution, verdict=Verdict(verdict))
    stable: bool | None = analysed(scene, balanced, task.options)["stable"]
    return stable


def _scaled(q: np.ndarray, cgff: Solution | None) -> np.ndarray:
    """Return force densities known up to a factor, scaled to CGFF's, least squares."""
    return q if cgff is None else q * float(q @ cgff.force_densities) / float(q @ q)


def _shape_error(X: np.ndarray, alignment: str, task: Task) -> float:
    """Return the largest distance of a node from its place in the reference, over the structure's size.

    A form known up to an affine map already lies where CGFF's answer is.
    """
    target = task.best.shape
    laid = X if alignment == "affine" else laid_over(X, target, task.alignment)
    return largest_move(laid, target) / size(target)


def _medians(at: Callable[[float], At], runs: Sequence[dict[float, At]]) -> tuple[At, ...]:
    """Return what the first run passed, at each tolerance, with the median time of all that reached it."""
    found = []
    for tolerance in TOLERANCES:
        reached = [run[tolerance].seconds or 0.0 for run in runs if tolerance in run]
        first = runs[0].get(tolerance)
        found.append(first._replace(seconds=median(reached)) if first else at(tolerance))
    return tuple(found)
