"""The paper's rank conditions, eq. (5), (6), states of self-stress and mechanisms."""

from typing import Any

import numpy as np

from cgff_cli.analysis.nulls import Rank, rank, zeros
from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.elements import EPS
from cgff_cli.mechanics.equilibrium import equilibrium_matrix
from cgff_cli.mechanics.norms import largest
from cgff_cli.mechanics.signs import is_positive
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.stopping import VANISHED

LEAST_TOLERANCE = 1e-9

SPANNED = 1e-9
"""Relative size below which a shape has no extent in a direction."""

PLAINLY = 1e-6
"""Least eigenvalue of Y^T Y, Y a shape of size 1 about its centroid, at which it plainly is not flat."""


def rank_tolerance(relative: float) -> float:
    """Return the relative size below which a singular value is zero.

    The shape is known no better than the forces balance (relative), so ranks cannot be either.
    """
    return max(LEAST_TOLERANCE, 10.0 * relative)


class Ranks:
    """U and D at a state and what of them is zero, dense or, of large scenes, sparse.

    The columns of U are unit vectors, at either end, so that its singular values compare with 1; those of D
    compare with the largest force density, or with what rounding makes of one. A cable that is shorter than
    its rest length by no more than rounding counts as taut.
    """

    def __init__(self, state: State, tolerance: float):
        self.state, self.tolerance = state, tolerance
        m, rounding = state.mechanics, state.rounding
        self.taut = state.stretch >= m.least - VANISHED * rounding
        blurred = float((m.k * state.taut * rounding / state.l).max())
        self.threshold = max(tolerance * largest(state.q), VANISHED * blurred)
        self.U = unit_equilibrium_matrix(state)
        rho_t = _rho_t(state, state.q)
        self.D = rho_t @ _rho_t(state).T
        self.nullity_D, self.is_semidefinite = zeros(self.D, self.threshold)

    def conditions(self) -> dict[str, Any]:
        """Return nullities of D and U and what follows; null where too many motions are too soft to tell.

        n_D = n - rank D must be >= d + 1, eq. (5), and n_U = b - rank U >= 1, eq. (6), in a free prestressed
        structure. States of self-stress and mechanisms count taut elements and free directions only, and so
        does rank_gap, the least singular value that counts over the greatest that does not.
        """
        m, count = self.state.mechanics, int(self.taut.sum())
        U = self.U if m.all_free else self.U[m.structure.free.T.reshape(-1)]
        all_taut, b = count == len(self.taut), len(self.taut)
        taut_rank = rank(U if all_taut else U[:, self.taut], self.tolerance)
        whole = taut_rank
        if not all_taut or not (m.all_free or taut_rank.number == b):  # rows added lower no singular value
            whole = rank(self.U, self.tolerance, seems_full=True)
        rigid, n_D, n_U = self.state.rigid.basis.shape[1], self.nullity_D, _less(b, whole)
        kept, left = taut_rank.kept, max(taut_rank.left, EPS)
        return {
            "nullity_D": n_D,
            "nullity_U": n_U,
            "condition_D": None if n_D is None else n_D >= len(self.state.X) + 1,
            "condition_U": None if n_U is None else n_U >= 1,
            "self_stress_states": _less(count, taut_rank),
            "mechanisms": _less(U.shape[0] - rigid, taut_rank),
            "rank_unsure": taut_rank.is_muddled,
            "rank_gap": float(kept / left) if kept == kept and left == left else None,
            "rigid_motions": rigid,
            "rank_tolerance": self.tolerance,
        }

    def is_super_stable(self) -> bool | None:
        """Return whether stress alone makes a stable shape stable, at any stiffness (Connelly 1982).

        D is positive semidefinite and has no null vectors but the affine motions: n_D is d + 1, or one more
        than the dimension of the affine span of a flat structure. With supports, D acts on the free
        directions and the affine motions are those that the supports allow; loads may resist some of them.
        """
        m = self.state.mechanics
        axes = m.structure.free.T if m.mask is not None else m.structure.free.T[:1]  # or else all are alike
        zero, semidefinite = zip(*(self._zeros_of(free) for free in axes), strict=True)
        if False in semidefinite:
            return False
        if None in zero:
            return None
        count = sum(zero)
        return count < int(axes.sum()) and (count == 0 or count <= _affine_motions(self.state, axes))

    def _zeros_of(self, free: np.ndarray) -> tuple[int | None, bool | None]:
        """Return how much of D on some nodes, (n,) bool, is zero, and whether none is negative."""
        whole = self.nullity_D, self.is_semidefinite
        return whole if free.all() else zeros(self.D[free][:, free], self.threshold)


def _less(count: int, rank: Rank) -> int | None:
    return None if rank.number is None or rank.is_muddled else count - rank.number


def unit_equilibrium_matrix(state: State) -> Any:
    """Return U of unit vectors, (d n, b), eq. (3): U t are nodal forces; sparse columns in large scenes."""
    u = state.V / state.l
    if state.mechanics.is_small:
        return equilibrium_matrix(_rho_t(state), u)
    from scipy.sparse import vstack

    return vstack([_rho_t(state, own) for own in u]).tocsc()


def _rho_t(state: State, weight: np.ndarray | float = 1.0) -> Any:
    """Return rho^T diag(weight), (n, b), eq. (1); weight: (b,)."""
    m, s, n = state.mechanics, state.mechanics.structure, len(state.mechanics.structure.free)
    if m.connectivity.is_small:
        return (m.connectivity.rho_t if m.moves is None else dense(s.start, s.end, n)) * weight
    from scipy.sparse import csc_array

    b = len(s.start)
    weights = np.broadcast_to(weight, b)
    signed = np.stack((weights, -weights), axis=1).reshape(-1)
    ends = np.stack((s.start, s.end), axis=1).reshape(-1)
    return csc_array((signed, ends, 2 * np.arange(b + 1)), shape=(n, b))


def _affine_motions(state: State, axes: np.ndarray) -> int:
    """Return how many affine functions of place are zero where held, summed over axes, (a, n) bool: free."""
    X = state.mechanics.everywhere(state.X).T
    Y = X - np.add.reduce(X, 0) * (1.0 / len(X))
    Y *= 1.0 / (largest(Y) or 1.0)
    if axes.all() and is_positive(Y.T @ Y, -PLAINLY):
        return (1 + Y.shape[1]) * len(axes)
    spanned = np.concatenate((np.ones((len(X), 1)), Y), axis=1)
    left, values, _ = np.linalg.svd(spanned, full_matrices=False)
    affine = left[:, values > SPANNED * values[0]]
    held = [affine[~free] for free in axes if not free.all()]
    return affine.shape[1] * len(axes) - sum(int(np.linalg.matrix_rank(h, tol=SPANNED)) for h in held)
