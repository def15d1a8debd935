"""Stability of large scenes: by Lanczos' method on the inverse of K, or by what cables alone cannot do."""

from functools import cached_property, partial
from math import inf, sqrt
from typing import Any

import numpy as np

from cgff_cli.analysis.lanczos import largest_of
from cgff_cli.analysis.nulls import below, shifted_factor
from cgff_cli.analysis.stability import SignsOf, resists, stability, stiffnesses, told
from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import largest, norm
from cgff_cli.mechanics.pattern import TangentPattern
from cgff_cli.mechanics.signs import BLUR, DRIVEN, blurred_at_most, idle_motions, shortest
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.factors import Factor, factory

SOLVED = 1e-10
"""Share of a force that may be left; what the shift of a factor leaves is solved for again."""


def stability_of_large(
    state: State, kind: str, floor: float, most: float = float("inf"), signs: SignsOf | None = None
) -> dict[str, Any]:
    """Return what `stability` returns of a balanced state.

    Of cables alone K is at least D, axis by axis, so that all is stable that taut cables tie to a support;
    stiffnesses are then told up to `most` free directions. kind: the sparse factors to use, as in the
    solve option `factor`, unless signs tell; floor: the rounding error of forces.
    """
    mechanics, taut = state.mechanics, resists(state, floor)
    signs = signs or partial(LargeSpectrum, kind=kind)
    if not (mechanics.structure.tension_only.all() and mechanics.mask is None):
        return stability(state, floor, signs)
    found = told("stable" if mechanics.structure.is_tied(taut) else "neutral", state, float("inf"))
    if len(mechanics.dofs) > most:
        return found
    spectrum = signs(state, taut, floor)
    return found | stiffnesses(state, spectrum, spectrum.doubt)


class LargeSpectrum:
    """What `mechanics.signs.Spectrum` tells, from one sparse factor; vectors run node by node.

    values: only the least `count`; blur: the least shift that keeps a factor from breaking down.

    No stiffness is below -shift, as K + shift has a Cholesky factor: the least is where its inverse is
    largest. The start is the same for every scene and has no symmetry that could hide a motion.
    """

    def __init__(self, state: State, taut: np.ndarray, floor: float, kind: str = "auto", count: int = 1):
        self.state, mechanics = state, state.mechanics
        self.shortest = shortest(state)
        self.blurred = blurred_at_most(state)
        self.doubt = self.blurred + 4.0 * largest(state.g) / self.shortest
        idle, self.is_sure = idle_motions(state, floor)
        self.softest, (d, m) = inf, state.X.shape
        self.places = mechanics.dofs % m * d + mechanics.dofs // m
        self.R = np.zeros((m * d, idle.shape[1]))
        self.R[self.places] = idle
        pattern = TangentPattern(mechanics)
        held = largest(mechanics.scale_stiffness)
        data = pattern.fill(*state.parts(None, taut)[1:], held=held)
        self.K = self.pattern, self.data, _ = pattern, data, kind
        self.blur = BLUR * max(held, largest(data))
        self.shift, self.factor = _shifted(*self.K, self.blur)
        self.matrix = pattern.matrix(data)
        self.count = len(self.places) - idle.shape[1]
        self._asked = min(count, self.count)
        self._found = self._softest(self._asked)
        self.values = self._found[0]
        if self.count:
            self.is_sure &= self._found[2]
            self.softest = float(self.values[0])

    def newton_steps(self) -> list[np.ndarray]:
        """Return Newton steps, (d, m), apart from idle motions, and from what has hardly a stiffness."""
        g = self.state.g
        flat, steps = self.cleared(g.T.reshape(-1)), []
        for factor in (self.factor, _shifted(*self.K, sqrt(self.shift))[1]):
            z = self.cleared(factor.solve(flat)).reshape(g.shape[::-1])
            steps.append(-np.ascontiguousarray(z.T))
        return steps

    def negative(self, doubt: float) -> int | None:
        """Return 0 where no stiffness is below -doubt; to count them takes factors, see `counted`."""
        return 0 if self.shift <= doubt or (self.is_sure and self.softest >= -doubt) else None

    def counted(self, doubt: float) -> int | None:
        """Return how many stiffnesses are below -doubt, by the signs of pivots (Sylvester)."""
        if self.negative(doubt) == 0:
            return 0
        count, error = below(self.matrix, -doubt)
        if error <= 0.1 * doubt:
            return count
        sides = [below(self.matrix, side) for side in (-10.0 * error, 10.0 * error)] if error < inf else []
        # Where nothing but idle motions lies in what the factor blurs, no sign hangs on that.
        if not sides or max(own for _, own in sides) > 2.0 * error:
            return None
        return sides[0][0] if sides[1][0] - self.R.shape[1] == sides[0][0] else None

    def modes(self, count: int) -> tuple[np.ndarray, np.ndarray, bool]:
        """Return the (c,) least stiffnesses, unit shapes (c, d, m), and whether the least was found."""
        count, (d, m) = min(count, self.count), self.state.X.shape
        values, x, is_found = self._found if count <= self._asked else self._softest(count)
        return values[:count], x[:, :count].T.reshape(len(values[:count]), m, d).swapaxes(1, 2), is_found

    def solved(self, F: np.ndarray, doubt: float) -> np.ndarray | None:
        """Return x, (d, m), with K x = F and no idle motion in it; None where F drives what is not stiff.

        What the shift of the factor leaves wrong is solved for again.
        """
        b = self.cleared(F.T.reshape(-1))
        if not self.count:
            return np.zeros_like(F)
        soft = self._found[1][:, np.abs(self.values) <= doubt]
        if largest(soft.T @ b) > DRIVEN * norm(b):
            return None
        x, left = self.refined(b)
        # A soft motion makes x so large that rounding of K x alone is more than what is asked for.
        rounding = 8.0 * EPS * largest(self.state.mechanics.scale_stiffness) * norm(x)
        if left > max(DRIVEN * norm(b), rounding):
            return None
        return np.ascontiguousarray(x.reshape(F.shape[::-1]).T)

    def refined(self, b: np.ndarray) -> tuple[np.ndarray, float]:
        """Return K^-1 b without idle motions, (f,), whatever the shift, and the norm of what is left."""
        x, rest, left = np.zeros_like(b), b, norm(b)
        while left > SOLVED * norm(b):
            better = x + self.cleared(self._direct.solve(rest))
            rest = self.cleared(b - self.matrix @ better)
            if not norm(rest) < 0.5 * left:
                break
            x, left = better, norm(rest)
        return x, left

    @cached_property
    def _direct(self) -> Factor:
        """A factor of K with hardly a shift, definite or not."""
        return self.factor if self.shift <= self.blur else shifted_factor(self.matrix, self.blur)

    def _softest(self, count: int) -> tuple[np.ndarray, np.ndarray, bool]:
        """Return up to `count` least eigenvalues of K, their vectors (f, c), and whether the least was found.

        More vectors at a time than are asked for find motions that are equally stiff.
        """
        if not count:
            return np.zeros(0), np.zeros((len(self.R), 0)), True
        width = min(count + 1, self.count) if count > 1 else 1
        x, is_found = largest_of(self._inverse, self.start(width), count, self.count)
        values, turned = np.linalg.eigh(x.T @ (self.matrix @ x))
        return values, x @ turned, is_found

    def factor_of(self, data: np.ndarray) -> Factor | None:
        """Return a factor of a matrix of the same pattern, None where it is negative beyond rounding."""
        shifted = data.copy()
        shifted[self.pattern.diagonal] += max(self.blur, BLUR * largest(data))
        return factory(self.pattern.indices, self.pattern.indptr, self.K[2]).factor(shifted)

    def start(self, width: int) -> np.ndarray:
        """Return vectors (f, width) in which no motion is missing."""
        start = np.zeros((len(self.R), width))
        start[self.places] = np.cos(np.arange(len(self.places) * width) ** 2.0).reshape(width, -1).T
        return self.cleared(start)

    def _inverse(self, y: np.ndarray) -> np.ndarray:
        return self.cleared(self.factor.solve(y))

    def cleared(self, y: np.ndarray) -> np.ndarray:
        """Return a vector without idle motions."""
        return y - self.R @ (self.R.T @ y)


def _shifted(pattern: TangentPattern, data: np.ndarray, kind: str, shift: float) -> tuple[float, Factor]:
    """Return the first shift, growing tenfold, with which K has a Cholesky factor, and that factor."""
    factors = factory(pattern.indices, pattern.indptr, kind)
    while True:
        shifted = data.copy()
        shifted[pattern.diagonal] += shift
        found = factors.factor(shifted)
        if found is not None:
            return shift, found
        shift *= 10.0
