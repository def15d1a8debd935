"""The shifted tangent as a sparse matrix, for large structures of any kind.

As in the dense one, but its signs are always looked at, which costs little here. A floating body is pinned in
six directions that leave it statically determinate: the forces on it balance, so pins carry nothing and only
choose one of the many solutions, from which the rigid motions are then projected out.
"""

import numpy as np

from cgff_cli.mechanics.pattern import TangentPattern
from cgff_cli.mechanics.rigid import all_motions
from cgff_cli.mechanics.signs import blurred_at_most
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.mechanics.tangent import Parts
from cgff_cli.solvers.factors import Factor, factory
from cgff_cli.solvers.line_search import TENFOLD
from cgff_cli.solvers.preconditioners.base import Solve, Tangent

INVERSE_ITERATIONS = 30
"""Steps towards the softest motion (10 did as well: tests/solvers/test_large.py; no hard scene needs one)."""


class SparseTangent(Tangent):
    """M with the pattern of the structure's graph, node by node."""

    def __init__(self, mechanics: Mechanics, squared: bool, kind: str):
        super().__init__(mechanics, squared)
        self.pattern = TangentPattern(mechanics)
        self.factory = factory(self.pattern.indices, self.pattern.indptr, kind)
        self.S = mechanics.scale_stiffness
        self.is_afloat = mechanics.all_free and mechanics.F is None

    def system(self, parts: Parts, shift: float, *, trusted: bool = False) -> Solve | None:
        """Return M^-1 as a function, or None where it has no Cholesky factor."""
        factor = self._factor(parts, shift * self.S)
        if factor is None:
            return None
        R = all_motions(parts.X) if self.is_afloat else None

        def solve(g: np.ndarray) -> np.ndarray:
            """Return M^-1 g without rigid motions of a body afloat."""
            z = factor.solve(g.T.reshape(-1))
            if self.squared:
                z = factor.solve(z)
            z = np.ascontiguousarray(z.reshape(g.shape[::-1]).T)
            if R is not None:
                flat = z.reshape(-1)
                flat -= R @ np.linalg.lstsq(R.T @ R, flat @ R, rcond=None)[0]
            return z

        return solve

    def steepest_fall(self, state: State) -> np.ndarray | None:
        """Return a unit direction of negative stiffness, or None: by inverse iteration below zero.

        K has no eigenvalue below -sigma when K + sigma has a Cholesky factor; sigma is raised from rounding.
        Whether the energy falls that way, forces out of balance or not, is seen by going there.
        """
        sigma = blurred_at_most(state)
        if self._definite(state, sigma) is not None:
            return None
        factor = None
        while factor is None:
            sigma *= TENFOLD
            factor = self._definite(state, sigma)
        z = np.cos(np.arange(self.pattern.size) ** 2.0)
        for _ in range(INVERSE_ITERATIONS):
            z = factor.solve(z / np.linalg.norm(z))
        d = z.reshape(state.X.shape[::-1]).T
        d = d if self.mechanics.mask is None else d * self.mechanics.mask
        return d / (np.linalg.norm(d) * np.sign(d.flat[np.abs(d).argmax()]))

    def _definite(self, state: State, sigma: float) -> Factor | None:
        """Return the factor of K + sigma, or None unless no eigenvalue of K is below -sigma."""
        return self._factor(state.parts(), sigma)

    def _factor(self, parts: Parts, shift: np.ndarray | float) -> Factor | None:
        """Return the factor of K of its parts and a shift per node, pinned if afloat, or None."""
        X, V, w, q = parts
        held = float(self.S.mean())
        pins = [(row, held * block) for row, block in _pins(X.T)] if self.is_afloat else ()
        self.factorizations += 1
        return self.factory.factor(self.pattern.fill(V, w, q, shift, pins, held))


def _pins(X: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """Return nodes and (d, d) projectors that hold a body and no more: 3 + 2 + 1 directions, or 2 + 1."""
    d = X.shape[1]
    first = int(np.square(X - X.mean(axis=0)).sum(axis=1).argmax())
    away = X - X[first]
    second = int(np.square(away).sum(axis=1).argmax())
    t = away[second] / (np.linalg.norm(away[second]) or 1.0)
    across = np.eye(d) - np.outer(t, t)
    pins = [(first, np.eye(d)), (second, across)]
    if d > 2:
        off_line = away @ across
        third = int(np.square(off_line).sum(axis=1).argmax())
        normal = np.cross(t, off_line[third])
        normal /= np.linalg.norm(normal) or 1.0
        pins.append((third, np.outer(normal, normal)))
    return pins
