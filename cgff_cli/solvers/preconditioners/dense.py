"""The shifted tangent as a dense matrix: small structures, numpy alone.

K has no stiffness along rigid motions that nothing resists: they get one of their own, R R^T. R may be old:
at a balanced shape K r = 0 and <g, r> = 0 for its own rigid motions r, so that R only chooses which of them a
step leaves out. It is renewed after short steps and where M is refused.
"""

import numpy as np

from cgff_cli.mechanics import tangent
from cgff_cli.mechanics.rigid import RigidMotions, rigid_stiffness
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.mechanics.tangent import Parts
from cgff_cli.solvers.preconditioners.base import LONG_STEP, Solve, Tangent


class DenseTangent(Tangent):
    """M over all directions of the nodes that move; held ones keep only 1 on the diagonal."""

    def __init__(self, mechanics: Mechanics, squared: bool):
        super().__init__(mechanics, squared)
        S = np.concatenate((mechanics.scale_stiffness,) * len(mechanics.start))
        self.S = S * S if squared else S
        self.stiffness = float(mechanics.k.mean())
        self.R: np.ndarray | None = None
        self.is_afloat = self.renew = mechanics.F is None and (
            mechanics.all_free or self._allowed(mechanics.start).size > 0
        )

    def system(self, parts: Parts, shift: float, *, trusted: bool = False) -> Solve | None:
        """Return M^-1 as a function, or None where M has no Cholesky factor."""
        M = tangent.dense(self.mechanics.connectivity, parts.V, parts.w, parts.q)
        if self.mechanics.mask is not None:
            tangent.hold(M, self.mechanics.mask)
        if self.renew:
            R = rigid_stiffness(parts.X) if self.mechanics.all_free else self._held(parts.X)
            self.R, self.renew = self.stiffness * R, False
        if self.R is not None:
            M += self.R
        if self.squared:
            M = M @ M
        diagonal = M.reshape(-1)[:: len(M) + 1]
        diagonal += shift * self.S
        self.factorizations += 1
        if not (trusted or _is_positive(M)):
            self.renew = self.is_afloat
            return None
        return lambda g: _solved(M, g.reshape(-1)).reshape(g.shape)

    def refresh(self, state: State) -> None:
        """Form M; at the start, where forces mean little, without negative force densities."""
        if self.solve is None and not self.squared:
            self.solve = self.at(state, np.maximum(state.q, 0.0))
            if self.solve is not None:
                return
        super().refresh(state)

    def adapt(self, alpha: float, shrinkage: float) -> None:
        """Adapt mu; a short step asks for rigid motions of the new shape."""
        super().adapt(alpha, shrinkage)
        self.renew = self.is_afloat and alpha < LONG_STEP

    def _held(self, X: np.ndarray) -> np.ndarray:
        """Return R R^T of the rigid motions that supports allow."""
        R = self._allowed(X)
        return R @ R.T

    def _allowed(self, X: np.ndarray) -> np.ndarray:
        """Return the rigid motions that supports allow, (d m, r), zero in held directions."""
        mechanics = self.mechanics
        free = mechanics.structure.free.T
        motions = RigidMotions(mechanics.everywhere(X), free).basis
        R = np.zeros((free.size, motions.shape[1]))
        R[free.reshape(-1)] = motions
        R = R.reshape(*free.shape, -1)
        return (R if mechanics.moves is None else R[:, mechanics.moves]).reshape(X.size, -1)


def _solved(M: np.ndarray, g: np.ndarray) -> np.ndarray:
    """Return M^-1 g; the least squares' where M, taken on trust or by a hair's breadth, is singular."""
    try:
        return np.linalg.solve(M, g)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(M, g, rcond=None)[0])


def _is_positive(M: np.ndarray) -> bool:
    """Return whether M has a Cholesky factor."""
    try:
        np.linalg.cholesky(M)
    except np.linalg.LinAlgError:
        return False
    return True
