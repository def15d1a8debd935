"""Stability of large scenes: by Lanczos' method on the inverse of K, or by what cables alone cannot do."""

from collections.abc import Callable
from functools import cached_property, partial
from math import inf, sqrt
from typing import Any

import numpy as np

from cgff_cli.analysis.nulls import below, factored
from cgff_cli.analysis.stability import SignsOf, resists, stability, stiffnesses, told
from cgff_cli.mechanics.norms import largest, norm
from cgff_cli.mechanics.pattern import TangentPattern
from cgff_cli.mechanics.signs import BLUR, DRIVEN, blurred_at_most, idle_motions, shortest
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.factors import Factor, factory

MOST_VECTORS = 200
MOST_SOLVES = 20

Operator = Callable[[np.ndarray], np.ndarray]

CLOSE = 1e-8
"""Residual of the softest motion, relative, at which Lanczos' method has found it."""


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

    values: only the least `count`.

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
        data = pattern.fill(*state.parts(None, taut)[1:], held=float(mechanics.scale_stiffness.mean()))
        self.K = pattern, data, kind
        stiffest = max(float(mechanics.scale_stiffness.max()), largest(data))
        self.shift, self.factor = _shifted(*self.K, BLUR * stiffest)
        self.matrix = csc_of(pattern, data)
        self.count = len(self.places) - idle.shape[1]
        self._found = self._softest(min(count, self.count))
        self.values = self._found[0]
        if self.count:
            self.is_sure &= self._found[2]
            self.softest = float(self.values[0])

    def newton_steps(self) -> list[np.ndarray]:
        """Return Newton steps, (d, m), apart from idle motions, and from what has hardly a stiffness."""
        g = self.state.g
        flat, steps = self._cleared(g.T.reshape(-1)), []
        for factor in (self.factor, _shifted(*self.K, sqrt(self.shift))[1]):
            z = self._cleared(factor.solve(flat)).reshape(g.shape[::-1])
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
        if (
            not sides
            or max(own for _, own in sides) > 2.0 * error
            or sides[1][0] - self.R.shape[1] != sides[0][0]
        ):
            return None
        return sides[0][0]

    def modes(self, count: int) -> tuple[np.ndarray, np.ndarray, bool]:
        """Return the (c,) least stiffnesses, unit shapes (c, d, m), and whether these are they."""
        count, (d, m) = min(count, self.count), self.state.X.shape
        values, x, is_found = self._found if count <= len(self.values) else self._softest(count)
        return values[:count], x[:, :count].T.reshape(count, m, d).swapaxes(1, 2), is_found

    def solved(self, F: np.ndarray, doubt: float) -> np.ndarray | None:
        """Return x, (d, m), with K x = F and no idle motion in it; None where F drives what is not stiff.

        What the shift of the factor leaves wrong is solved for again.
        """
        b = self._cleared(F.T.reshape(-1))
        soft = self._found[1][:, np.abs(self.values) <= doubt]
        if largest(soft.T @ b) > DRIVEN * norm(b):
            return None
        x, left = np.zeros_like(b), b
        for _ in range(MOST_SOLVES):
            if norm(left) <= DRIVEN * norm(b):
                return np.ascontiguousarray(x.reshape(F.shape[::-1]).T)
            x = x + self._cleared(self._direct.solve(left))
            left = self._cleared(b - self.matrix @ x)
        return None

    @cached_property
    def _direct(self) -> Factor:
        """A factor of K with hardly a shift, definite or not."""
        least = BLUR * max(float(self.state.mechanics.scale_stiffness.max()), largest(self.matrix.data))
        return self.factor if self.shift <= least else factored(self.matrix, least)

    def stress_rates(self, dq: np.ndarray) -> np.ndarray | None:
        """Return the least eigenvalue, (1,), of K_G(dq) against K - K_G(dq); None unless that is positive.

        dq: (b,) force densities that change with the loads.
        """
        from scipy.sparse.linalg import LinearOperator, eigsh

        (pattern, data, kind), V = self.K, self.state.V
        change = pattern.fill(V, np.zeros(len(dq)), dq, held=0.0)
        unloaded = data - change
        shifted = unloaded.copy()
        shifted[pattern.diagonal] += BLUR * max(largest(unloaded), self.shift)
        factor = factory(pattern.indices, pattern.indptr, kind).factor(shifted)
        if factor is None:
            return None
        M, G = (csc_of(pattern, own) for own in (unloaded, change))
        inverse = LinearOperator(M.shape, lambda y: self._cleared(factor.solve(y)), dtype=float)
        return eigsh(
            *(G, 1, M),
            which="SA",
            v0=self._start(1)[:, 0],
            tol=CLOSE,
            Minv=inverse,
            return_eigenvectors=False,
        )

    def _softest(self, count: int) -> tuple[np.ndarray, np.ndarray, bool]:
        """Return least eigenvalues (count,) of K, their vectors (f, count), and whether these were found.

        More vectors at a time than are asked for find motions that are equally stiff.
        """
        if not count:
            return np.zeros(0), np.zeros((len(self.R), 0)), True
        width = min(count + 1, self.count) if count > 1 else 1
        x, is_found = largest_of(self._inverse, self._start(width), count, self.count)
        values, turned = np.linalg.eigh(x.T @ (self.matrix @ x))
        return values, x @ turned, is_found

    def _start(self, width: int) -> np.ndarray:
        """Return vectors (f, width) in which no motion is missing."""
        start = np.zeros((len(self.R), width))
        start[self.places] = np.cos(np.arange(len(self.places) * width) ** 2.0).reshape(width, -1).T
        return self._cleared(start)

    def _inverse(self, y: np.ndarray) -> np.ndarray:
        return self._cleared(self.factor.solve(y))

    def _cleared(self, y: np.ndarray) -> np.ndarray:
        """Return a vector without idle motions."""
        return y - self.R @ (self.R.T @ y)


def csc_of(pattern: TangentPattern, data: np.ndarray) -> Any:
    """Return a sparse matrix of a pattern."""
    from scipy.sparse import csc_array

    return csc_array((data, pattern.indices, pattern.indptr))


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


def largest_of(inverse: Operator, start: np.ndarray, count: int, room: int) -> tuple[np.ndarray, bool]:
    """Return orthonormal vectors (f, count) to a symmetric operator's largest values, and if they were found.

    Lanczos' method from the columns of start, (f, width), side by side, with all vectors kept and
    orthogonalised twice. room: dimension of where it acts.
    """
    Q, T, width = np.linalg.qr(start)[0], np.zeros((0, 0)), start.shape[1]
    while True:
        z, size = inverse(Q[:, -width:]), Q.shape[1]
        column = Q.T @ z
        T = np.block([[T, column[:-width]], [column[:-width].T, column[-width:]]])
        z -= Q @ column
        z -= Q @ (Q.T @ z)
        onward, beside = np.linalg.qr(z)
        values, vectors = np.linalg.eigh(0.5 * (T + T.T))
        left = np.linalg.norm(beside @ vectors[-width:, -count:], axis=0)
        is_found = size == room or bool((left <= CLOSE * np.abs(values[-count:])).all())
        if is_found or size >= MOST_VECTORS:
            break
        width = min(width, room - size)
        Q = np.concatenate((Q, onward[:, :width]), axis=1)
    x = Q @ vectors[:, -count:]
    for _ in range(2):  # where K is all but singular its inverse is hardly linear, and x is the better for it
        x = np.linalg.qr(inverse(x))[0]
    return x, is_found
