"""A path: one number changes step by step, and each shape is the start of the next.

Between two points the shape should move as the tangent stiffness says, K u = -(g(X, b) - g(X, a)). Where it
moves much farther the step is halved: what is smooth then comes near, what branches off moves as the root of
the step, and what falls goes on falling however small the step, which tells where an equilibrium is lost.
"""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, NamedTuple
from weakref import WeakKeyDictionary

import numpy as np

from cgff_cli.analysis.given import Given
from cgff_cli.as_given import unmoved
from cgff_cli.errors import OptionError, SceneError
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.pipeline import solve
from cgff_cli.result import Result
from cgff_cli.scene.scene import Scene
from cgff_cli.structure import from_scene
from cgff_cli.study.alignment import alignment_of, laid_over, largest_move
from cgff_cli.study.outs import Answers
from cgff_cli.study.starts import size_of_start
from cgff_cli.study.sweep import HOW_ROWS_ENDED, NO_SCENE, Sweep

SMALL, SHARE = 1e-4, 0.25
"""A step is followed that moves no node farther beyond what is predicted than this share of the size, or of
the largest predicted motion, as far as that is no larger than the structure."""

NARROW = 1e-10
"""Share of a value to which a step is halved before what moves is said to fall: a shape that branches off has
come within SMALL by then, and six digits of the value are sure."""

DIGITS = 1e-6
"""Share of a value within which a shape that is not stable is what an equilibrium ends as, and falls are
one."""

BETWEEN_ROWS = 1e-13
"""The tolerance between rows: what is left of an equilibrium that has just ended balances to looser ones."""

TO_ROUNDING = 8.0
"""Rounding errors of a residual that leave the stability of a shape in no doubt."""

LEAST_VALUE = 1e-3
"""Share of all values' span below which one has no six digits of its own, and to which a step is halved from
a shape that is one of many: nearer to that one what makes the others stable is within rounding."""

OF_PATHS = ("jump", "lost")
"""What the rows of a path tell more; lost: the value at which an equilibrium ended since the last row."""


@dataclass(frozen=True, eq=False)
class PathPoint:
    """A shape, (n, d), in balance at a value, and its stability."""

    value: float
    shape: np.ndarray
    stability: str | None


class PathRow(NamedTuple):
    """A row, by column; the last point in balance, where the path goes on; where equilibria were lost.

    not_judged, no_jump: it balances, and has all the same no stability, no jump from the row before
    """

    row: dict[str, Any]
    here: PathPoint | None
    lost: tuple[float, ...]
    not_judged: bool = False
    no_jump: bool = False


class Path:
    """A path under way; here: the last point in balance, before it begins none."""

    def __init__(self, plan: Sweep, here: PathPoint | None = None):
        self.plan, self.here = plan, here
        self.lost: list[float] = []
        self.structure = from_scene(plan.scene)
        self.size = size_of_start(self.structure)
        self.alignment = alignment_of(self.structure.coordinates, self.structure.free)
        (self.axis,) = plan.axes
        self.span = float(np.ptp(self.axis.values))
        self._kept: WeakKeyDictionary[PathPoint, Given] = WeakKeyDictionary()

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the columns, in order."""
        return (self.axis.key, *HOW_ROWS_ENDED, *OF_PATHS, *self.plan.outs)

    def stops(self, first: int = 0) -> Iterator[PathRow]:
        """Yield the rows from a first one on, in the order of the values."""
        for value in self.axis.values[first:].tolist():
            self.lost, before = [], self.here
            result = self._to(value)
            jump = None
            if result.converged:
                here = self._point(value, result)
                jump, self.here = None if before is None else self.jump(before, here), here
            row, is_there = self._row(value, result, jump), result.converged
            empty = is_there and row["stability"] is None, is_there and before is not None and jump is None
            yield PathRow(row, self.here, tuple(self.lost), *empty)

    def _row(self, value: float, result: Result, jump: float | None) -> dict[str, Any]:
        told = (
            result.verdict,
            result.converged,
            result.analysis.get("stability"),
            result.counts["iterations"],
            result.residual["relative"],
            result.energy,
        )
        of_one = (result.coordinates[None], result.forces[None], result.structure.rest_lengths[None])
        shapes = Answers(result.structure, *of_one)
        return {
            self.axis.key: value,
            **dict(zip(HOW_ROWS_ENDED, told, strict=True)),
            **dict(zip(OF_PATHS, (jump, self.lost[0] if self.lost else None), strict=True)),
            **{name: out(shapes)[0].item() for name, out in self.plan.outs.items()},
        }

    def _at(self, value: float, start: PathPoint | None, tolerance: float = 1.0) -> Result:
        """Return the solve at a value, a nearer one where what is left of the forces blurs stability."""
        scene = self.plan.scene_at(np.array([value]), None if start is None else start.shape)
        tolerance = min(tolerance, self.plan.options.tolerance)
        found = self._solved(scene, tolerance)
        if found.converged and found.analysis.get("stability") is None:
            balance = found.solution.balance
            nearer = self._solved(scene, min(TO_ROUNDING * balance.floor / balance.reference, tolerance))
            return nearer if nearer.converged else found
        return found

    def _solved(self, scene: Scene, tolerance: float) -> Result:
        result = solve(scene, **self.plan.options.to_dict() | {"tolerance": tolerance})
        if result.interrupted:
            raise KeyboardInterrupt
        return result

    def _point(self, value: float, result: Result) -> PathPoint:
        return PathPoint(value, result.coordinates, result.analysis.get("stability"))

    def _to(self, value: float) -> Result:
        """Walk to a value, in smaller steps where one moves too far; note where an equilibrium is lost."""
        a, ahead, end, sure = self.here, [value], self._at(value, self.here), float("nan")
        while a is not None:
            if a.stability == "stable":
                sure = a.value
            is_one = self._is_near(sure, a.value, DIGITS)  # right at its end an equilibrium is hardly stable
            b = self._point(ahead[-1], end)
            is_followed = end.converged and self._is_followed(a, b)
            if is_followed or (end.converged and self._is_narrow(a.value, b.value, is_one)):
                if not is_followed and is_one:
                    if not any(self._is_near(value, b.value, DIGITS) for value in self.lost):
                        self.lost.append(b.value)
                    ahead[1:-1] = []
                a = b
                ahead.pop()
            elif end.converged or len(ahead) > 1:
                ahead.append(0.5 * (a.value + b.value))
            else:
                break
            if not ahead:
                break
            end = self._at(ahead[-1], a, 1.0 if len(ahead) == 1 else BETWEEN_ROWS)
        return end

    def _is_narrow(self, a: float, b: float, is_one: bool) -> bool:
        """Return whether a step is halved no more; is_one: from the one equilibrium, not from one of many."""
        return self._is_near(a, b, NARROW) if is_one else abs(b - a) <= LEAST_VALUE * self.span

    def _is_near(self, a: float, b: float, share: float) -> bool:
        return abs(b - a) <= share * max(abs(a), abs(b), LEAST_VALUE * self.span)

    def _is_followed(self, a: PathPoint, b: PathPoint) -> bool:
        """Return whether a step moves the shape about as far as is predicted, there and back.

        Where an equilibrium has hardly any stiffness left, any motion is predicted, but not back from where
        it fell; and what fell may by chance lie where it is predicted, but not back.
        """
        steps = [(self.predicted(a, b.value), a, b), (self.predicted(b, a.value), b, a)]
        moves = [
            (self._off(there, end), largest_move(there, start.shape) / self.size)
            for there, start, end in steps
            if there is not None
        ]
        jumps, motions = zip(*moves, strict=True) if moves else ((0.0,), (1.0,))
        return max(jumps) <= max(SMALL, SHARE * min(*motions, 1.0))

    def jump(self, a: PathPoint, b: PathPoint) -> float | None:
        """Return the largest distance of a node from where it is predicted, over the structure's size."""
        there = self.predicted(a, b.value)
        return None if there is None else self._off(there, b)

    def _off(self, there: np.ndarray, end: PathPoint) -> float:
        return largest_move(laid_over(end.shape, there, self.alignment, mirror=False), there) / self.size

    def predicted(self, a: PathPoint, value: float) -> np.ndarray | None:
        """Return the shape, (n, d), that the tangent stiffness at a point predicts at another value.

        None for what is not stable, one of many equilibria perhaps, and where elements have no length.
        """
        given = self._given(a) if a.stability == "stable" else None
        if given is None:
            return None
        there, (state, _, signs) = self.plan.scene_at(np.array([value]), a.shape), given.tangent
        m, other = state.mechanics, Mechanics(from_scene(there))
        g = other.at(other.start).g * (other.frame.force / m.frame.force) - m.at(m.start).g
        u = signs.solved(-g, given.doubt)
        if u is None:
            return None
        moved = there.coordinates.copy()
        moved[slice(None) if m.moves is None else m.moves] += u.T * m.frame.length
        return moved

    def _given(self, a: PathPoint) -> Given | None:
        """Return a point with its tangent stiffness, while it lives; None where elements have no length."""
        if a not in self._kept:
            scene, options = self.plan.scene_at(np.array([a.value]), a.shape), self.plan.options
            with suppress(SceneError):
                self._kept[a] = Given(scene, unmoved(scene, options.tolerance), options, 0)
        return self._kept.get(a)


def followed(plan: Sweep) -> Path:
    """Return a path from its beginning; raises OptionError where a sweep is none."""
    if len(plan.axes) != 1 or plan.order != "grid":
        raise OptionError("a path follows one swept number, through all its values in their order")
    if plan.options.analysis == "never":
        raise OptionError("what a path loses shows in the stability of its shapes: not with analysis never")
    (axis,), structure = plan.axes, from_scene(plan.scene)
    if axis.array == "coordinates" and structure.free[axis.place]:
        raise OptionError(f"{axis.key}: no path follows a start that is free to move")
    good = plan.may_be(plan.arrays(plan.values(0, plan.rows)), plan.rows)
    if not good.all():
        value = axis.values[good.argmin()]
        raise OptionError(f"{axis.key}: at {value:g} {NO_SCENE}")
    return Path(plan)
