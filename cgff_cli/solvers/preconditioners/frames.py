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
from math import log10
from typing import Any

import numpy as np

from cgff_cli.mechanics.elements import TINY
from cgff_cli.mechanics.pattern import GraphPattern
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.solvers.factors import Factor, factory, kind_of_factor
from cgff_cli.solvers.preconditioners.force_density import force_density_start
from cgff_cli.solvers.preconditioners.planes import local_frames

SLACK_SHARE = 1e-3
"""Stiffness that a slack cable keeps in M, so that a node held by slack cables has some."""

WINDOW = 6
"""Iterations over which the rate of convergence is taken."""

HOPED_RATE = 1.3
"""Decades of <g, z> per iteration that new factors are first hoped to bring."""

RENEWAL_COST = 10.0
"""What renewing the factors costs, in iterations: about that at 10^4 to 10^6 nodes."""

SHORT_STEP = 0.2
"""Renew after a step this short."""

PATIENCE, LONG_PATIENCE = 15, 50
"""Renewals, or iterations without headway, after which the tangent is to take over; long where it is dear."""

DEAR = 5_000
"""Free nodes from which a factor of the tangent by SuperLU costs that of many renewals."""

MOST_NODES = 100_000
"""Free nodes up to which a factor of the tangent is to be had: it takes ten times the memory of ours."""


class NodeFrames:
    """d scalar factors; for structures of cables whose nodes are either held or free."""

    predicts_full_steps = False

    def __init__(self, mechanics: Mechanics, kind: str):
        structure = mechanics.structure
        n, d = structure.coordinates.shape
        self.mechanics = mechanics
        self.moves = np.flatnonzero(structure.free[:, 0])
        rows = np.full(n, -1)
        rows[self.moves] = np.arange(len(self.moves))
        self.pattern = GraphPattern(structure.start, structure.end, rows)
        parts = self.pattern.indices, self.pattern.indptr
        self.kind = kind_of_factor(kind)
        self.factories = [factory(*parts, self.kind) for _ in range(d)]
        self.factors: list[Factor] = []
        self.shared: tuple[Factor, np.ndarray] | None = None
        self.scale = 1.0
        self.frames = np.zeros((d, len(self.moves), d))
        self.between: dict[tuple[int, int], Any] = {}
        self.factorizations = self.renewals = 0
        self.is_spent = True
        self.progress: list[float] = []
        self.hope = HOPED_RATE

    def better_start(self, state: State) -> State:
        """Return the force density solution if its energy is lower, else `state`.

        Its factor serves on as the one for the normals until the first renewal.
        """

        def factored(q: np.ndarray) -> Factor:
            """Return a factor of D_ff, and keep it."""
            factor = self._factor(-1, self.pattern.fill(q, q, -q))
            self.shared = factor, q
            return factor

        start = force_density_start(self.mechanics, state, factored)
        if start is state:
            self.shared = None
        return start

    def refresh(self, state: State) -> None:
        """Set up frames, factors and the blocks between them at a state if the present ones are spent.

        At a force density start they take its own force densities, which balance, and not those that its
        lengths give, which scatter about them by as much as lengths do over the strain.
        """
        if not self.is_spent:
            return
        structure, d = self.mechanics.structure, state.X.shape[1]
        if self.shared is not None:
            factor, q = self.shared
            self.scale = max(float(state.q.sum()), TINY) / float(q.sum())
            k, q = structure.stiffness, self.scale * q
            known = [factor]
        else:
            slack = state.slack
            k = np.where(slack, SLACK_SHARE, 1.0) * structure.stiffness
            q = np.where(slack, k, state.q)
            self.scale, known = 1.0, []
        frames = local_frames(structure, k, state.u)
        self.frames = frames[:, self.moves]
        block = _blocks(self.pattern, k - q, q, state.u, frames)
        self.factors = [self._factor(f, block(f, f)) for f in range(d - len(known))] + known
        self.shared = None
        self.between = {}
        for f in range(d):
            for g in range(f):
                self.between[f, g] = self.pattern.matrix(block(f, g))
                self.between[g, f] = self.between[f, g].T
        self.is_spent = False
        self.renewals += 1
        self.progress = []

    def apply(self, g: np.ndarray) -> np.ndarray:
        """Return M^-1 g, (n, d)."""
        d, here = len(self.frames), g[self.moves]
        r = [np.einsum("ni,ni->n", f, here) for f in self.frames]
        x: list[np.ndarray] = []
        for f in range(d):
            x.append(self._solved(f, r[f], x[:f]))
        x[-1] /= self.scale
        for f in reversed(range(d - 1)):
            x[f] = self._solved(f, r[f], x)
        z = np.zeros_like(g)
        z[self.moves] = sum(x[f][:, None] * self.frames[f] for f in range(d))
        self.progress.append(float(np.vdot(g, z)))
        return z

    def _solved(self, f: int, r: np.ndarray, x: list[np.ndarray]) -> np.ndarray:
        """Return the solution for local direction f, given those of others."""
        for g in range(len(x)):
            if g != f:
                r = r - self.between[f, g] @ x[g]
        return self.factors[f].solve(r)

    def adapt(self, alpha: float, shrinkage: float, excess: float) -> None:
        """Renew the factors when steps are short, or when new ones are expected to pay.

        At the present rate some number of iterations is left to go; at the rate that new factors are hoped
        to bring it may be smaller by more than they cost. Hope follows experience after each renewal.
        """
        self.is_spent = alpha < SHORT_STEP and len(self.progress) > 1
        if len(self.progress) <= WINDOW or self.is_spent:
            return
        rate = max(log10(self.progress[-1 - WINDOW] / self.progress[-1]) / WINDOW, 1e-3)
        if len(self.progress) == WINDOW + 1:
            self.hope = 0.5 * (self.hope + rate)
        left = 2.0 * log10(max(excess, 1.0))
        self.is_spent = left / rate > left / self.hope + RENEWAL_COST

    def stiffen(self) -> None:
        """Ask for new factors."""
        self.is_spent = True

    def is_beaten(self, waited: int) -> bool:
        """Return whether factors are asked for too often or no longer help."""
        count = len(self.moves)
        patience = LONG_PATIENCE if self.kind == "superlu" and count > DEAR else PATIENCE
        return count <= MOST_NODES and (self.renewals > patience or waited > patience)

    def steepest_fall(self, state: State) -> np.ndarray | None:
        """Return None: without compression no stiffness is negative."""
        return None

    def _factor(self, f: int, data: np.ndarray) -> Factor:
        """Return a factor of the matrix with this data, stiffened a little where rounding asks for it."""
        diagonal = self.pattern.diagonal
        share = 1e-14 * float(data[diagonal].max())
        while True:
            self.factorizations += 1
            factor = self.factories[f].factor(data, is_definite=True)
            if factor is not None:
                return factor
            data[diagonal] += share
            share *= 100.0


def _blocks(
    pattern: GraphPattern, stiff: np.ndarray, q: np.ndarray, u: np.ndarray, frames: np.ndarray
) -> Callable[[int, int], np.ndarray]:
    """Return a function of two local directions that gives the data of the block M_fg of Q^T K Q.

    stiff: (b,) k - q; q: (b,); u: (b, d) unit vectors; frames: (d, n, d).
    """
    here, there = frames[:, pattern.start], frames[:, pattern.end]
    along, beyond = (np.einsum("ei,fei->fe", u, ends) for ends in (here, there))

    def entries(f: np.ndarray, g: np.ndarray, rate: np.ndarray, other: np.ndarray) -> np.ndarray:
        """Return what each element puts into a block, (b,)."""
        return stiff * rate * other + q * np.einsum("ei,ei->e", f, g)

    def block(f: int, g: int) -> np.ndarray:
        """Return the (nnz,) data of M_fg."""
        return pattern.fill(
            entries(here[f], here[g], along[f], along[g]),
            entries(there[f], there[g], beyond[f], beyond[g]),
            -entries(here[f], there[g], along[f], beyond[g]),
            -entries(there[f], here[g], beyond[f], along[g]),
        )

    return block
