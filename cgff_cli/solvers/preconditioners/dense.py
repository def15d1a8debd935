"""The shifted tangent as a dense matrix: small structures, numpy alone.

M = K + mu S for the energy, K^2 + mu S^2 for eq. (10); S holds each node's total stiffness. Where K + mu S
is indefinite, far from a stable equilibrium, the negative force densities of compressed elements are left
out of it: what remains is positive semidefinite element by element. Raising mu past the most negative
stiffness instead took one iteration in ten and one evaluation in four more on the prism from random starts.

Rigid motions that nothing resists get a stiffness of their own: K has none there but rounding and the
residual, of either sign, which would amplify rounding into drift or make a good tangent look indefinite.
"""

import numpy as np

from cgff_cli.mechanics.rigid import all_motions, rigid_motions
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.solvers.curvature import steepest_fall
from cgff_cli.solvers.preconditioners.base import Shift


class DenseTangent(Shift):
    """M = K + mu S or K^2 + mu S^2 over the free directions."""

    predicts_full_steps = True

    def __init__(self, mechanics: Mechanics, squared: bool):
        super().__init__()
        self.dofs = None if mechanics.all_free else mechanics.dofs
        self.free = mechanics.structure.free
        self.squared = squared
        self.factorizations = 0
        S = np.repeat(mechanics.scale_stiffness, self.free.shape[1])
        self.S = (S if self.dofs is None else S[self.dofs]) ** (2 if squared else 1)
        self.mean_stiffness = float(mechanics.nodal_stiffness.mean())
        held = self.dofs is not None and not rigid_motions(mechanics.structure.coordinates, self.free).size
        self.is_afloat = not (mechanics.has_loads or held)

    def refresh(self, state: State) -> None:
        """Form K and make M positive definite."""
        K = state.dense_tangent()
        R = self._idle_motions(state.X)
        if R is not None:
            K += self.mean_stiffness * (R @ R.T)
        self.M = K @ K if self.squared else K
        if self._is_indefinite():
            self.M = state.dense_tangent(np.maximum(state.q, 0.0))
            while self._is_indefinite():
                self.mu *= 10.0

    def apply(self, g: np.ndarray) -> np.ndarray:
        """Return M^-1 g, (n, d)."""
        if self.dofs is None:
            return self._solved(g.reshape(-1)).reshape(g.shape)
        z = np.zeros(g.size)
        z[self.dofs] = self._solved(g.reshape(-1)[self.dofs])
        return z.reshape(g.shape)

    def _solved(self, b: np.ndarray) -> np.ndarray:
        """Return M^-1 b, with more shift where M is singular to rounding though Cholesky accepted it."""
        while True:
            try:
                return np.linalg.solve(self.M, b)
            except np.linalg.LinAlgError:
                self.mu *= 10.0
                self._is_indefinite()

    def steepest_fall(self, state: State) -> np.ndarray | None:
        """Return a unit direction of negative stiffness, or None."""
        return steepest_fall(state)

    def _idle_motions(self, X: np.ndarray) -> np.ndarray | None:
        """Return the rigid motions as columns if there are any and nothing can resist them."""
        if not self.is_afloat:
            return None
        return all_motions(X) if self.dofs is None else rigid_motions(X, self.free)

    def _is_indefinite(self) -> bool:
        """Add mu S to M and return whether a Cholesky factor is still refused."""
        diagonal = self.M.reshape(-1)[:: len(self.M) + 1]
        diagonal += self.mu * self.S
        self.factorizations += 1
        try:
            np.linalg.cholesky(self.M)
        except np.linalg.LinAlgError:
            return True
        return False
