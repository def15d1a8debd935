"""Anchored cable nets: d scalar factors in local frames at the nodes.

At each node the taut elements span a tangent plane; along its normal a net resists by its forces, in the
plane by its far larger elastic stiffness. With the frames as columns of Q the preconditioner is the block
diagonal of Q^T K Q, one n x n matrix per local direction f:

    M_f: diagonal (k - q) (u.f)^2 + q at both ends, (k - q) (u.f)(u.f') + q f.f' between them

with f, f' at an element's two nodes. Coordinate axes instead of local frames mix the two stiffnesses where
a net is curved and take two to four times the iterations. The factors are kept while they serve.
"""

from math import log10

import numpy as np

from cgff_cli.mechanics.elements import TINY
from cgff_cli.mechanics.pattern import GraphPattern
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.solvers.factors import Factor, factory
from cgff_cli.solvers.line_search import FLAT, Goal, strong_wolfe
from cgff_cli.solvers.objectives import Energy

SLACK_SHARE = 1e-3
"""Stiffness that a slack cable keeps in M, so that a node held by slack cables has some."""

MOST_RESTS = 4
"""Repetitions of the force density start."""

WINDOW = 6
"""Iterations over which the rate of convergence is taken."""

HOPED_RATE = 1.3
"""Decades of <g, z> per iteration that new factors are first hoped to bring."""

RENEWAL_COST = 10.0
"""What renewing the factors costs, in iterations: about that at 10^4 to 10^6 nodes."""

SHORT_STEP = 0.2
"""Renew after a step this short."""


class NodeFrames:
    """d scalar factors; for structures of cables whose nodes are either held or free."""

    predicts_full_steps = False

    def __init__(self, mechanics: Mechanics, kind: str):
        structure = mechanics.structure
        n, d = structure.coordinates.shape
        self.mechanics = mechanics
        self.moves = structure.free[:, 0]
        rows = np.where(self.moves, np.cumsum(self.moves) - 1, -1)
        self.pattern = GraphPattern(structure.start, structure.end, rows)
        parts = self.pattern.indices, self.pattern.indptr
        self.factories = [factory(*parts, kind) for _ in range(d)]
        self.factors: list[Factor] = []
        self.shared: Factor | None = None
        self.scale = self.shared_scale = 1.0
        self.frames = np.zeros((n, d, d))
        self.factorizations = 0
        self.is_spent = True
        self.progress: list[float] = []
        self.hope = HOPED_RATE

    def better_start(self, state: State) -> State:
        """Return the force density solution (Schek 1974) with q = k if its energy is lower, else `state`.

        Where its lengths do not fit the rest lengths (they scatter more than the cables are strained) it is
        repeated with q in proportion to l / l0, which pulls at what is too long.

        D_ff x_f = F - D_fc x_c, one factor for all coordinates. Loads would need force densities of the
        right size, not only proportion: their share of the shape is scaled to the least energy along it.
        The factor serves on as the one for the normals until the first renewal.
        """
        q = self.mechanics.structure.stiffness
        best = self._force_density_state(state, q)
        for _ in range(MOST_RESTS):
            ratio = best.l / self.mechanics.structure.rest_lengths.clip(TINY)
            mean = float(ratio.mean())
            if float(ratio.std()) <= mean - 1.0 or mean < 0.01:  # a net drawn into its anchors has no ratio
                break
            q = q * (ratio / mean).clip(0.01, 100.0)
            found = self._force_density_state(state, q)
            if found.energy >= best.energy:
                break
            best = found
        return best if best.energy < state.energy else state

    def _force_density_state(self, state: State, q: np.ndarray) -> State:
        """Return the state at the force density solution with (b,) q, and keep its factor."""
        structure, connectivity = self.mechanics.structure, self.mechanics.connectivity
        factor = self._factor(-1, q, q, -q)
        held = np.where(structure.free, 0.0, state.X)
        pull = connectivity.gather(q[:, None] * connectivity.differences(held))
        found = self.mechanics.at(held + self._solved(factor, -pull))
        self.shared, self.shared_scale = factor, float(q.sum())
        if not self.mechanics.has_loads:
            return found
        energy = Energy(self.mechanics)
        sag = self._solved(factor, structure.loads)
        line = energy.line(found, sag)
        goal = Goal(line(0.0).slope, energy.noise(found), FLAT)
        return self.mechanics.at(found.X + strong_wolfe(line, goal, 1.0).length * sag)

    def refresh(self, state: State) -> None:
        """Set up frames and factors at a state if the present ones are spent."""
        if not self.is_spent:
            return
        structure = self.mechanics.structure
        slack, u = state.slack, state.u
        k = np.where(slack, SLACK_SHARE, 1.0) * structure.stiffness
        q = np.where(slack, k, state.q)
        self.frames = self._frames(k, u)
        self.factors, self.scale = [], 1.0
        for axis in range(u.shape[1] - (self.shared is not None)):
            f, g = self.frames[structure.start, :, axis], self.frames[structure.end, :, axis]
            uf, ug = np.einsum("ij,ij->i", u, f), np.einsum("ij,ij->i", u, g)
            across = -((k - q) * uf * ug + q * np.einsum("ij,ij->i", f, g))
            self.factors.append(self._factor(axis, (k - q) * uf**2 + q, (k - q) * ug**2 + q, across))
        if self.shared is not None:
            self.factors.append(self.shared)
            self.scale = float(q.sum()) / self.shared_scale
            self.shared = None
        self.is_spent = False
        self.progress = []

    def apply(self, g: np.ndarray) -> np.ndarray:
        """Return M^-1 g, (n, d)."""
        local = np.einsum("nij,ni->jn", self.frames, g)
        z = np.zeros_like(local)
        for axis, factor in enumerate(self.factors):
            z[axis, self.moves] = factor.solve(local[axis, self.moves])
        z[-1] /= self.scale
        z = np.einsum("nij,jn->ni", self.frames, z)
        self.progress.append(float(np.vdot(g, z)))
        return z

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

    def steepest_fall(self, state: State) -> np.ndarray | None:
        """Return None: without compression no stiffness is negative."""
        return None

    def _factor(self, axis: int, at_start: np.ndarray, at_end: np.ndarray, across: np.ndarray) -> Factor:
        """Return a factor of the matrix with these entries, stiffened a little where rounding asks for it."""
        data = self.pattern.fill(at_start, at_end, across)
        diagonal = self.pattern.diagonal
        share = 1e-14
        while True:
            self.factorizations += 1
            factor = self.factories[axis].factor(data, is_definite=True)
            if factor is not None:
                return factor
            data[diagonal] *= 1.0 + share
            share *= 100.0

    def _solved(self, factor: Factor, b: np.ndarray) -> np.ndarray:
        """Return (n, d) M^-1 b coordinate by coordinate, zero at held nodes."""
        x = np.zeros_like(b)
        for axis in range(b.shape[1]):
            x[self.moves, axis] = factor.solve(b[self.moves, axis])
        return x

    def _frames(self, k: np.ndarray, u: np.ndarray) -> np.ndarray:
        """Return (n, d, d) orthonormal frames as columns, the normal last.

        The normal is the softest direction of A = sum k u u^T over a node's elements: the largest column
        of its adjugate. The first tangent follows one direction of the whole net, the one most elements
        run along, so that frames at neighbours agree.
        """
        structure = self.mechanics.structure
        n, d = structure.coordinates.shape
        ends = np.concatenate((structure.start, structure.end))
        A = np.empty((n, d, d))
        for i in range(d):
            for j in range(i, d):
                w = k * u[:, i] * u[:, j]
                A[:, i, j] = A[:, j, i] = np.bincount(ends, np.concatenate((w, w)), minlength=n)
        along = _prevailing(k, u)
        if d == 2:
            tangent = _normalized(A @ along + 1e-9 * along)
            return np.stack((tangent, tangent[:, ::-1] * (-1.0, 1.0)), axis=2)
        normal = _softest(A)
        tangent = _normalized(_across(normal, along + np.zeros((n, 1))))
        return np.stack((tangent, np.cross(normal, tangent), normal), axis=2)


def _prevailing(k: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Return the unit direction t, near the first element's, that maximises sum k (u.t)^4."""
    t = u[0]
    for _ in range(10):
        t = (k * (u @ t) ** 3) @ u
        t = t / (np.linalg.norm(t) or 1.0)
    return t


def _softest(A: np.ndarray) -> np.ndarray:
    """Return (n, 3) unit vectors of the least stiffness of (n, 3, 3) matrices, exact where it is zero."""
    A = A + 1e-6 * np.trace(A, axis1=1, axis2=2)[:, None, None] * np.eye(3)
    adjugate = np.stack((np.cross(A[:, 1], A[:, 2]), np.cross(A[:, 2], A[:, 0]), np.cross(A[:, 0], A[:, 1])))
    best = np.einsum("cni,cni->cn", adjugate, adjugate).argmax(axis=0)
    return _normalized(adjugate[best, np.arange(len(A))])


def _across(normal: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return (n, 3) what of t is across the normals; some direction across where nothing is."""
    rest = t - normal * np.einsum("ni,ni->n", normal, t)[:, None]
    lost = np.einsum("ni,ni->n", rest, rest) < 1e-4
    other = np.eye(3)[np.abs(normal).argmin(axis=1)]
    rest[lost] = np.cross(normal, other)[lost]
    return rest


def _normalized(vectors: np.ndarray) -> np.ndarray:
    lengths = np.sqrt(np.einsum("ni,ni->n", vectors, vectors))
    return vectors / np.where(lengths > 0.0, lengths, 1.0)[:, None]
