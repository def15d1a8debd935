"""The shifted tangent as a dense matrix: small structures, numpy alone.

K has no stiffness along rigid motions that nothing resists: they get one of their own, R R^T. R may be old:
at a balanced shape K r = 0 and <g, r> = 0 for its own rigid motions r, so that R only chooses which of them a
step leaves out. It is renewed after short steps and where M is refused.
"""

from functools import partial

import numpy as np

from cgff_cli.mechanics import tangent
from cgff_cli.mechanics.rigid import RigidMotions, all_motions
from cgff_cli.mechanics.signs import is_positive
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.mechanics.tangent import Parts
from cgff_cli.solvers.preconditioners.base import LONG_STEP, Solve, Tangent


class DenseTangent(Tangent):
    """M over all directions of the nodes that move; held ones keep only 1 on the diagonal."""

    def __init__(self, mechanics: Mechanics, squared: bool):
        super().__init__(mechanics, squared)
        S = np.concatenate((mechanics.scale_stiffness,) * len(mechanics.start))
        self.S = S * S if squared else S
        self.stiffness = float(np.add.reduce(mechanics.k)) / len(mechanics.k)
        self.R: np.ndarray | None = None
        self.is_afloat = self.renew = mechanics.F is None and (
            mechanics.all_free or self._allowed(mechanics.start).size > 0
        )

    def system(self, parts: Parts, shift: float, *, trusted: bool = False) -> Solve | None:
        """Return M^-1 as a function, or None where M has no Cholesky factor."""
        M = tangent.stiffness_matrix(self.mechanics.connectivity, parts, self.mechanics.mask)
        if self.renew:
            R = all_motions(parts.X) if self.mechanics.all_free else self._allowed(parts.X)
            self.R, self.renew = R.dot(self.stiffness * R.T), False
        if self.R is not None:
            M += self.R
        if self.squared:
            M = M @ M
        M.reshape(-1)[:: len(M) + 1] += shift * self.S
        self.factorizations += 1
        if not (trusted or is_positive(M)):
            self.renew = self.is_afloat
            return None
        return partial(_solved, M)

    def refresh(self, state: State, q: np.ndarray | None = None) -> None:
        """Form M; at the start, where forces mean little, without negative force densities."""
        is_first = self.solve is None and not self.squared
        super().refresh(state, np.maximum(state.q, 0.0) if is_first else q)

    def adapt(self, alpha: float, shrinkage: float) -> None:
        """Adapt mu; a short step asks for rigid motions of the new shape."""
        super().adapt(alpha, shrinkage)
        self.renew = self.is_afloat and alpha < LONG_STEP

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
    """Return M^-1 g, (d, m); the least squares' where M, taken on trust or by a hair, is singular."""
    try:
        return np.linalg.solve(M, g.reshape(-1)).reshape(g.shape)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(M, g.reshape(-1), rcond=None)[0]).reshape(g.shape)
