"""The signs of the tangent stiffness: its least value apart from idle motions, and where it falls most.

Dense, for small structures; of large ones only what blurs them (see analysis.large). Positive and negative
mean beyond doubt: rounding blurs K, and a force density is known no better than the residual and its
element's own rounding allow, over its length.
"""

from functools import cached_property
from math import sqrt

import numpy as np

from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.norms import largest, norm
from cgff_cli.mechanics.state import State

BLUR = 1e-14
"""Rounding error of an eigenvalue over the norm of its matrix and the root of its size, with some room."""

DRIVEN = 1e-9
"""Share of a force that rounding may put along a motion which it does not drive."""

SETTLED = 8.0
"""Kantorovich: where K changes by at most L per length, a smallest stiffness s with s^2 > 8 L |eta| keeps
its sign on the way to the exact equilibrium, with room to spare (2 would do)."""


def blurred(K: np.ndarray, state: State) -> float:
    """Return the size below which rounding leaves an eigenvalue of K no sign, were the forces in balance."""
    return BLUR * sqrt(len(K)) * norm(K) + _own_rounding(state)


def blurred_at_most(state: State) -> float:
    """Return the same of a sparse K, from the largest sum of stiffnesses at a node, which bounds its norm."""
    return BLUR * largest(state.mechanics.scale_stiffness) + _own_rounding(state)


def _own_rounding(state: State) -> float:
    """Return how far rounding of an element's own length and place blurs its stiffness, at most."""
    m, reach = state.mechanics, largest(state.X)
    own = m.k * (state.taut & (m.l0 > 0.0)) * (1.0 + (reach + np.abs(state.e)) / state.l)
    return 4.0 * EPS * float(own.max())


def shortest(state: State) -> float:
    """Return the least length of an element whose force density depends on its length; infinity for none."""
    sure = (state.mechanics.l0 > 0.0) & state.taut & (state.stretch > -state.mechanics.l0)
    return float(state.l.min(initial=float("inf"), where=sure))


def is_positive(K: np.ndarray, shift: float | np.ndarray = 0.0) -> bool:
    """Return whether K and a shift of its diagonal, which it keeps, has a Cholesky factor."""
    K.reshape(-1)[:: len(K) + 1] += shift
    try:
        np.linalg.cholesky(K)
    except np.linalg.LinAlgError:
        return False
    return True


def steepest_fall(state: State) -> np.ndarray | None:
    """Return the unit (d, m) direction of most negative stiffness, or None if there is none.

    A Cholesky factor of K and a little more is the quick way to see that there is none. What forces out of
    balance blur counts for negative: whether the energy falls that way is seen by going there.
    """
    K = state.own_tangent
    if is_positive(K.copy(), BLUR * sqrt(len(K)) * norm(K)):
        return None
    values, vectors = np.linalg.eigh(K)
    if values[0] >= -blurred(K, state):
        return None
    d = vectors[:, 0]
    return (d * np.sign(d[np.abs(d).argmax()])).reshape(state.X.shape)


def idle_motions(state: State, floor: float) -> tuple[np.ndarray, bool]:
    """Return the rigid motions that cost a balanced state nothing, (f, i), and whether that is sure.

    It is where rounding (floor: that of reactions), not what is left of the forces, decides which they are.
    """
    m, rigid = state.mechanics, state.rigid
    if not rigid.basis.size or (m.all_free and m.F is None):
        return rigid.basis, True
    outer = m.structure.loads.T * (1.0 / m.frame.force)
    if not m.all_free:
        outer = np.where(m.structure.free.T, outer, state.pull().T)
    blur = 0.0 if m.mask is None else state.norm + floor
    idle = rigid.idle(outer, blur)
    count = idle.shape[1]
    return idle, count == 0 or count == rigid.idle(outer, min(blur, floor)).shape[1]


class Spectrum:
    """Stiffnesses apart from idle rigid motions, and what of them is told.

    values  : (count,) eigenvalues of K apart from idle motions, rising
    softest : the least of them; infinity where nothing but idle motions can happen
    shortest : see above
    blurred, doubt : the size that rounding hides, and the size that has no sign
    is_sure        : whether rounding alone, not what is left of the forces, decides which motions are idle
    """

    def __init__(self, state: State, taut: np.ndarray, floor: float):
        """taut: (b,) bool, elements that resist; floor: rounding error of reactions."""
        self.state, mechanics = state, state.mechanics
        same = bool((taut == state.taut).all())
        K = state.own_tangent.copy() if same else state.dense_tangent(taut=taut)
        if mechanics.mask is not None:
            K = K[np.ix_(mechanics.dofs, mechanics.dofs)]
        self.blurred = blurred(K, state)
        self.shortest = shortest(state)
        self.doubt = self.blurred + 4.0 * state.norm / self.shortest
        R, self.is_sure = idle_motions(state, floor)
        if R.size:
            KR, above = K @ R, 2.0 * norm(K)
            if largest(KR) ** 2 > self.blurred * above:  # forces out of balance tie R to the rest
                K -= KR @ R.T + R @ (KR - R @ (R.T @ KR)).T
            K += (above * R) @ R.T  # above all else, where it leaves the rest alone
        self.K, self.count = K, len(K) - R.shape[1]
        self.values = np.linalg.eigvalsh(K)[: self.count]
        self.softest = float(self.values[0]) if self.count else float("inf")

    @cached_property
    def eigen(self) -> tuple[np.ndarray, np.ndarray]:
        """Eigenvalues (count,) of K apart from idle motions, rising, and their vectors (f, count)."""
        values, vectors = np.linalg.eigh(self.K)
        return values[: self.count], vectors[:, : self.count]

    def newton_steps(self) -> list[np.ndarray]:
        """Return Newton steps, (d, m), along all that has stiffness beyond rounding, and beyond doubt."""
        return [-self._along(self.state.g, least)[0] for least in (self.blurred, self.doubt)]

    def solved(self, F: np.ndarray, doubt: float) -> np.ndarray | None:
        """Return x, (d, m), with K x = F and no idle motion in it; None where F drives what is not stiff."""
        x, left = self._along(F, doubt)
        return x if left <= DRIVEN * norm(F) else None

    def _along(self, F: np.ndarray, doubt: float) -> tuple[np.ndarray, float]:
        """Return K^-1 F along what is stiffer than the doubt, and the largest part of F along what is not."""
        values, vectors = self.eigen
        sure, parts = np.abs(values) > doubt, vectors.T @ F.reshape(-1)[self.state.mechanics.dofs]
        return self._spread(vectors[:, sure] @ (parts[sure] / values[sure])), largest(parts[~sure])

    def _spread(self, free: np.ndarray) -> np.ndarray:
        """Return (d, m) of what free directions hold, (f,)."""
        full = np.zeros(self.state.X.size)
        full[self.state.mechanics.dofs] = free
        return full.reshape(self.state.X.shape)

    def negative(self, doubt: float) -> int:
        """Return how many eigenvalues are below -doubt."""
        return int((self.values < -doubt).sum())

    counted = negative

    def modes(self, count: int) -> tuple[np.ndarray, np.ndarray, bool]:
        """Return the (c,) least eigenvalues apart from idle motions, unit shapes (c, d, m), and True."""
        values, vectors = self.eigen
        shapes = [self._spread(vector) for vector in vectors.T[:count]]
        return values[:count], np.array(shapes).reshape(len(shapes), *self.state.X.shape), True
