"""Stability of large scenes: by Lanczos' method on the inverse of K, or by what cables alone cannot do."""

from collections.abc import Callable
from functools import partial
from math import sqrt
from typing import Any

import numpy as np

from cgff_cli.analysis.stability import resists, stability, told
from cgff_cli.mechanics.norms import largest
from cgff_cli.mechanics.pattern import TangentPattern
from cgff_cli.mechanics.signs import BLUR, blurred_at_most, idle_motions, shortest
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.factors import Factor, factory

MOST_VECTORS = 200

Operator = Callable[[np.ndarray], np.ndarray]

CLOSE = 1e-8
"""Residual of the softest motion, relative, at which Lanczos' method has found it."""


def stability_of_large(state: State, kind: str, floor: float, most: float = float("inf")) -> dict[str, Any]:
    """Return `stable`, `stability` and `smallest_stiffness` of a balanced state.

    Of cables alone K is at least D, axis by axis, so that all is stable that taut cables tie to a support;
    smallest_stiffness is then told up to `most` free directions. kind: the sparse factors to use, as in the
    solve option `factor`; floor: the rounding error of forces.
    """
    mechanics, taut = state.mechanics, resists(state, floor)
    signs = partial(LargeSpectrum, kind=kind)
    if not (mechanics.structure.tension_only.all() and mechanics.mask is None):
        return stability(state, floor, signs)
    found = told("stable" if mechanics.structure.is_tied(taut) else "neutral", state, float("inf"))
    softest = signs(state, taut, floor).softest if len(mechanics.dofs) <= most else float("nan")
    softest *= mechanics.frame.stiffness
    return found | {"smallest_stiffness": softest if np.isfinite(softest) else None}


class LargeSpectrum:
    """What `mechanics.signs.Spectrum` tells, from one sparse factor; vectors run node by node.

    No stiffness is below -shift, as K + shift has a Cholesky factor: the least is where its inverse is
    largest. The start is the same for every scene and has no symmetry that could hide a motion.
    """

    def __init__(self, state: State, taut: np.ndarray, floor: float, kind: str = "auto"):
        from scipy.sparse import csc_array

        self.state, mechanics = state, state.mechanics
        self.shortest = shortest(state)
        self.doubt = blurred_at_most(state) + 4.0 * largest(state.g) / self.shortest
        idle, self.is_sure = idle_motions(state, floor)
        self.softest, (d, m) = float("inf"), state.X.shape
        self.places = mechanics.dofs % m * d + mechanics.dofs // m
        self.R = np.zeros((m * d, idle.shape[1]))
        self.R[self.places] = idle
        pattern = TangentPattern(mechanics)
        data = pattern.fill(*state.parts(None, taut)[1:], held=float(mechanics.scale_stiffness.mean()))
        self.K = pattern, data, kind
        stiffest = max(float(mechanics.scale_stiffness.max()), largest(data))
        self.shift, self.factor = _shifted(*self.K, BLUR * stiffest)
        self.matrix = csc_array((data, pattern.indices, pattern.indptr))
        self.count = len(self.places) - idle.shape[1]
        if self.count:
            values, _, is_found = self._softest(1, 1)
            self.is_sure &= is_found
            self.softest = float(values[0])

    def newton_steps(self) -> list[np.ndarray]:
        """Return Newton steps, (d, m), apart from idle motions, and from what has hardly a stiffness."""
        g = self.state.g
        flat, steps = self._cleared(g.T.reshape(-1)), []
        for factor in (self.factor, _shifted(*self.K, sqrt(self.shift))[1]):
            z = self._cleared(factor.solve(flat)).reshape(g.shape[::-1])
            steps.append(-np.ascontiguousarray(z.T))
        return steps

    def modes(self, count: int) -> tuple[np.ndarray, np.ndarray, bool]:
        """Return the (c,) least stiffnesses, unit shapes (c, d, m), and whether none is missing or blurred.

        As many vectors at a time find motions that are equally stiff.
        """
        count = min(count, self.count)
        values, x, is_found = self._softest(count, min(count + 1, self.count))
        d, m = self.state.X.shape
        return values, x.T.reshape(count, m, d).swapaxes(1, 2), is_found

    def _softest(self, count: int, width: int) -> tuple[np.ndarray, np.ndarray, bool]:
        """Return least eigenvalues (count,) of K, their vectors (f, count), and whether these were found."""
        start = np.zeros((len(self.R), width))
        start[self.places] = np.cos(np.arange(len(self.places) * width) ** 2.0).reshape(width, -1).T
        x, is_found = largest_of(self._inverse, self._cleared(start), count, self.count)
        values, turned = np.linalg.eigh(x.T @ (self.matrix @ x))
        return values, x @ turned, is_found

    def _inverse(self, y: np.ndarray) -> np.ndarray:
        return self._cleared(self.factor.solve(y))

    def _cleared(self, y: np.ndarray) -> np.ndarray:
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
