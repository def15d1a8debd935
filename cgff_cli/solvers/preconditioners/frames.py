"""Anchored cable nets: d scalar factors in local frames at the nodes, coupled by block Gauss-Seidel.

At each node the taut elements span a tangent plane; along its normal a net resists by its forces, in the
plane by its far larger elastic stiffness. With the frames as columns of Q the d x d blocks of Q^T K Q are
n x n matrices, one for each pair of local directions f, g:

    M_fg: (k - q) (u.f)(u.g) + q f.g at both ends, -((k - q) (u.f)(u.g') + q f.g') between them

g' at an element's other node. Factors of the d diagonal blocks and products with the others make a
symmetric Gauss-Seidel sweep: down the directions and up again, 2 d - 1 scalar solves. The sweep takes half
the iterations of the diagonal blocks alone, and those a half to a quarter of what coordinate axes take,
which mix the two stiffnesses where a net is curved. Factors are kept while they serve.
"""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from cgff_cli.mechanics.elements import EPS, TINY
from cgff_cli.mechanics.pattern import GraphPattern
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.solvers.factors import Factor, factory
from cgff_cli.solvers.line_search import FLAT_ENOUGH, HUNDREDFOLD, Goal, strong_wolfe
from cgff_cli.solvers.objectives import Energy
from cgff_cli.solvers.preconditioners.base import FIRST_SHIFT, QUARTER, Preconditioner
from cgff_cli.solvers.preconditioners.planes import local_frames


class NodeFrames(Preconditioner):
    """d scalar factors; for structures of cables whose nodes are either held or free."""

    has_detours = True

    def __init__(self, mechanics: Mechanics, kind: str):
        structure = mechanics.structure
        d = structure.coordinates.shape[1]
        self.mechanics = mechanics
        moves = structure.free.any(axis=1)
        self.pattern = GraphPattern(structure.start, structure.end, np.where(moves, np.cumsum(moves) - 1, -1))
        self.factory = factory(self.pattern.indices, self.pattern.indptr, kind)
        self.factors: list[Factor] = []
        self.shared: tuple[Factor, np.ndarray] | None = None
        self.scale = 1.0
        self.frames = np.zeros((d, d, self.pattern.size))
        self.between: dict[tuple[int, int], Any] = {}
        self.factorizations = 0
        self.is_spent = True
        self.served = 0

    def better_start(self, state: State) -> State:
        """Return the force density solution (Schek 1974) with q = k if its energy is lower, else `state`.

        D_ff x_f = F - D_fc x_c, one factor for all axes, which serves on as the one for the normals until
        the first renewal. Loads would need force densities of the right size, not only proportion: their
        share of the shape is scaled to the least energy along it.
        """
        mechanics, q = self.mechanics, self.mechanics.k
        factor = self._factor(-1, self.pattern.fill(q, q, -q))
        fixed = mechanics.connectivity.gather(q * (0.0 if mechanics.fixed is None else mechanics.fixed))
        found = mechanics.at(np.stack([factor.solve(-f) for f in fixed]))
        if mechanics.F is not None:
            sag, energy = np.stack([factor.solve(f) for f in mechanics.F]), Energy()
            line = energy.line(found, sag)
            goal = Goal(line(0.0).slope, partial(energy.noise, found), FLAT_ENOUGH)
            step, _ = strong_wolfe(line, goal, line(1.0))
            found = mechanics.at(found.X + step.step * sag)
        if found.energy >= state.energy:
            return state
        self.shared = factor, q
        return found

    def refresh(self, state: State) -> None:
        """Set up frames, factors and the blocks between them at a state if the present ones are spent.

        At a force density start they take its own force densities, which balance, and not those that its
        lengths give, which scatter about them by as much as lengths do over the strain.
        """
        if not self.is_spent:
            return
        d = len(state.X)
        if self.shared is not None:
            factor, q = self.shared
            self.scale = max(float(state.q.sum()), TINY) / float(q.sum())
            k, q = self.mechanics.k, self.scale * q
            known = [factor]
        else:
            slack = state.slack  # which keeps some stiffness, so that a node held by slack cables has some
            k = np.where(slack, FIRST_SHIFT, 1.0) * self.mechanics.k
            q = np.where(slack, k, state.q)
            self.scale, known = 1.0, []
        u = state.V / state.l
        self.frames = local_frames(self.pattern, k, u)
        block = _blocks(self.pattern, k - q, q, u, self.frames)
        self.factors = [self._factor(f, block(f, f)) for f in range(d - len(known))] + known
        self.shared = None
        self.between = {}
        for f in range(d):
            for g in range(f):
                self.between[f, g] = self.pattern.matrix(block(f, g))
                self.between[g, f] = self.between[f, g].T
        self.is_spent, self.served = False, 0

    def apply(self, g: np.ndarray) -> np.ndarray:
        """Return M^-1 g, (d, m)."""
        d = len(self.frames)
        r = [np.einsum("an,an->n", f, g) for f in self.frames]
        x: list[np.ndarray] = []
        for f in range(d):
            for h in range(f):
                r[f] -= self.between[f, h] @ x[h]
            x.append(self.factors[f].solve(r[f]))
        x[-1] /= self.scale
        for f in reversed(range(d - 1)):
            for h in range(f + 1, d):
                r[f] -= self.between[f, h] @ x[h]
            x[f] = self.factors[f].solve(r[f])
        return np.einsum("fan,fn->an", self.frames, np.stack(x))

    def adapt(self, alpha: float, shrinkage: float) -> None:
        """Renew the factors after a short step."""
        self.served += 1
        self.is_spent = alpha < QUARTER and self.served > 1

    def stiffen(self) -> None:
        """Ask for new factors."""
        self.is_spent = True

    def steepest_fall(self, state: State) -> np.ndarray | None:
        """Return None: without compression no stiffness is negative."""
        return None

    def _factor(self, f: int, data: np.ndarray) -> Factor:
        """Return a factor of the matrix with this data, stiffened a little where rounding asks for it."""
        diagonal = self.pattern.diagonal
        share = EPS * float(data[diagonal].max())
        while True:
            self.factorizations += 1
            factor = self.factory.factor(data, f, is_definite=True)
            if factor is not None:
                return factor
            data[diagonal] += share
            share *= HUNDREDFOLD


def _blocks(
    pattern: GraphPattern, stiff: np.ndarray, q: np.ndarray, u: np.ndarray, frames: np.ndarray
) -> Callable[[int, int], np.ndarray]:
    """Return a function of two local directions that gives the data of the block M_fg of Q^T K Q.

    stiff: (b,) k - q; q: (b,); u: (d, b) unit vectors; frames: (d, d, m) at the pattern's nodes.
    """
    everywhere = np.zeros((*frames.shape[:2], pattern.count))
    everywhere[:, :, pattern.nodes] = frames
    here, there = everywhere[:, :, pattern.start], everywhere[:, :, pattern.end]
    along, beyond = (np.einsum("ae,fae->fe", u, ends) for ends in (here, there))

    def entries(f: np.ndarray, g: np.ndarray, rate: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Return what each element puts into a block, (b,)."""
        return stiff * rate * other + q * np.einsum("ae,ae->e", f, g)

    def block(f: int, g: int) -> np.ndarray:
        """Return the (nnz,) data of M_fg."""
        across = -entries(here[f], there[g], along[f], beyond[g])
        return pattern.fill(
            entries(here[f], here[g], along[f], along[g]),
            entries(there[f], there[g], beyond[f], beyond[g]),
            across,
            across if f == g else -entries(there[f], here[g], beyond[f], along[g]),
        )

    return block
