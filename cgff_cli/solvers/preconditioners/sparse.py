"""The shifted tangent as a sparse matrix, for large structures of any kind.

As in the dense one, but M is kept while its steps shrink the gradient well, unless its factor is so thin
that a new one costs no more than an iteration (towers). A floating body is pinned in six directions that
leave it statically determinate: the forces on it balance, so pins carry nothing and only choose one of the
many solutions, from which the rigid motions are then projected out.
"""

import numpy as np

from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.pattern import TangentPattern
from cgff_cli.mechanics.rigid import all_motions
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.solvers.factors import Factor, factory
from cgff_cli.solvers.preconditioners.base import Shift

THIN = 12
"""A factor with at most this many entries per entry of K is renewed every iteration."""

GOOD_PROGRESS = 0.25
"""A step that shrinks the gradient to this share earns the factor another one."""


class SparseTangent(Shift):
    """M = K + mu S for the energy, (K + mu S)^2 for eq. (10)."""

    predicts_full_steps = True

    def __init__(self, mechanics: Mechanics, squared: bool, kind: str):
        super().__init__()
        structure = mechanics.structure
        self.mechanics, self.squared = mechanics, squared
        self.factorizations = 0
        self.pattern = TangentPattern(structure.start, structure.end, structure.free)
        self.factory = factory(self.pattern.indices, self.pattern.indptr, kind)
        self.moves = structure.free.any(axis=1)
        self.S = mechanics.scale_stiffness[self.moves]
        self.is_afloat = mechanics.all_free and not mechanics.has_loads
        self.factor: Factor | None = None
        self.keep = False
        self.R: np.ndarray | None = None

    def refresh(self, state: State) -> None:
        """Factor M anew unless the last factor still serves."""
        if self.factor is not None and self.keep:
            return
        self.factor = self._factor(state, state.q, self.mu * self.S, definite=self.squared)
        q = np.maximum(state.q, 0.0)
        while self.factor is None:
            self.factor = self._factor(state, q, self.mu * self.S)
            self.mu *= 1.0 if self.factor else 10.0
        self.R = all_motions(state.X) if self.is_afloat else None

    def apply(self, g: np.ndarray) -> np.ndarray:
        """Return M^-1 g, (n, d)."""
        if self.factor is None:
            return g
        z = self.factor.solve(g[self.moves].reshape(-1))
        if self.squared:
            z = self.factor.solve(z)
        full = np.zeros_like(g)
        full[self.moves] = z.reshape(-1, g.shape[1])
        if self.R is not None:
            flat = full.reshape(-1)
            flat -= self.R @ np.linalg.lstsq(self.R, flat, rcond=None)[0]
        return self.mechanics.on_free(full)

    def adapt(self, alpha: float, shrinkage: float, excess: float) -> None:
        """Adapt mu, and decide whether the factor is kept for another step."""
        super().adapt(alpha, shrinkage, excess)
        thick = self.factor is not None and self.factor.fill > THIN * len(self.pattern.indices)
        self.keep = thick and shrinkage < GOOD_PROGRESS

    def stiffen(self) -> None:
        """Raise mu a hundredfold and ask for a new factor."""
        super().stiffen()
        self.keep = False

    def steepest_fall(self, state: State) -> np.ndarray | None:
        """Return a unit direction of negative stiffness, or None: by inverse iteration below zero.

        K has no eigenvalue below -sigma when K + sigma has a Cholesky factor; sigma is raised from doubt.
        """
        sigma: np.ndarray = np.full(len(self.S), self._doubt(state))
        if self._factor(state, state.q, sigma) is not None:
            return None
        factor = None
        while factor is None:
            sigma = 10.0 * sigma
            factor = self._factor(state, state.q, sigma)
        z = np.cos(np.arange(self.pattern.size) ** 2.0)
        for _ in range(30):
            z = factor.solve(z / np.linalg.norm(z))
        full = np.zeros_like(state.X)
        full[self.moves] = z.reshape(-1, state.X.shape[1])
        direction = self.mechanics.on_free(full)
        return direction / (np.linalg.norm(direction) * np.sign(direction.flat[np.abs(direction).argmax()]))

    def kind_of_balance(self, state: State, k: np.ndarray) -> str:
        """Return "stable", "unstable" or "neutral" for a balanced state: the inertia of K either side of 0.

        k: (b,) stiffnesses to take. The rigid motions of a floating body are pinned; others that supports
        allow may be what is neutral.
        """
        doubt = np.full_like(self.S, self._doubt(state))
        if self._factor(state, state.q, -doubt, k=k) is not None:
            return "stable"
        return "neutral" if self._factor(state, state.q, doubt, k=k) is not None else "unstable"

    def refined(self, state: State) -> State:
        """Return the state after a Newton step, or itself where K is singular or the step gains nothing."""
        factor = self._factor(state, state.q, np.zeros_like(self.S))
        if factor is None:
            return state
        step = np.zeros_like(state.X)
        step[self.moves] = factor.solve(state.free_eta[self.moves].reshape(-1)).reshape(-1, step.shape[1])
        there = self.mechanics.at(state.X + self.mechanics.on_free(step))
        return there if norm(there.free_eta) < norm(state.free_eta) else state

    def _doubt(self, state: State) -> float:
        """Return the size below which an eigenvalue of K has no sign."""
        size = float(np.abs(state.X).max()) or 1.0
        return 1e-14 * float(self.S.max()) + float(np.abs(state.free_eta).max()) / size

    def _factor(
        self,
        state: State,
        q: np.ndarray,
        shift: np.ndarray,
        definite: bool = False,
        k: np.ndarray | None = None,
    ) -> Factor | None:
        """Return the factor of K with force densities q, stiffnesses k and a shift per node, and pins."""
        k = state.active_stiffness if k is None else k
        extra = shift[:, None, None] * np.eye(state.X.shape[1])
        if self.is_afloat:
            for node, block in _pins(state.X):
                extra[node] += float(self.S.mean()) * block
        held = float(self.S.mean())
        self.factorizations += 1
        data = self.pattern.fill(state.u, k, q, extra, held)
        return self.factory.factor(data, definite)


def _pins(X: np.ndarray) -> list[tuple[int, np.ndarray]]:
    """Return nodes and (d, d) projectors that hold a body and no more: 3 + 2 + 1 directions, or 2 + 1."""
    d = X.shape[1]
    first = int(np.square(X - X.mean(axis=0)).sum(axis=1).argmax())
    away = X - X[first]
    second = int(np.square(away).sum(axis=1).argmax())
    t = away[second] / (np.linalg.norm(away[second]) or 1.0)
    across = np.eye(d) - np.outer(t, t)
    pins = [(first, np.eye(d)), (second, across)]
    if d == 3:
        off_line = away @ across
        third = int(np.square(off_line).sum(axis=1).argmax())
        normal = np.cross(t, off_line[third])
        normal /= np.linalg.norm(normal) or 1.0
        pins.append((third, np.outer(normal, normal)))
    return pins
