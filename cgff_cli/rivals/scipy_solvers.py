"""scipy's own solvers on the same residual, mostly with its exact Jacobian; imported when one is called.

A free body can turn and drift without force, which leaves the Jacobian singular at every equilibrium.
fsolve (MINPACK's hybr) asks for a regular one and may stall; Levenberg and Marquardt's damping does not
mind; L-BFGS-B only ever sees the energy and its gradient. Nothing is held to help them.
"""

from typing import Any

import numpy as np

from cgff_cli.errors import CgffError
from cgff_cli.mechanics.pattern import TangentPattern
from cgff_cli.mechanics.state import State
from cgff_cli.rivals.task import End, Task, Trace, Unknowns

MOST_DENSE = 2000
"""Unknowns up to which a dense Jacobian, and its QR factors in every step, are worth having."""

TIGHT = 1e-15
"""Their own tolerances: too tight to hold before the test of the residual that ends every rival."""

ENDLESS = 1_000_000
"""Their own limits of iterations and evaluations, which the test that ends every rival comes before."""


def fsolve(task: Task, trace: Trace, with_jacobian: bool = True) -> End:
    """Run scipy.optimize.fsolve, without a Jacobian by finite differences.

    An iteration is an evaluation of the residual: a trial step, or a difference.
    """
    from scipy.optimize import fsolve as minpack

    system = System(task, trace)
    if len(system.start) > MOST_DENSE:
        raise CgffError(f"its dense Jacobian is not made for more than {MOST_DENSE} unknowns")
    jacobian = system.jacobian if with_jacobian else None
    x, _, _, message = minpack(
        system.residual, system.start, fprime=jacobian, xtol=TIGHT, maxfev=ENDLESS, full_output=True
    )
    return system.ended(x, message)


def lm(task: Task, trace: Trace) -> End:
    """Run Levenberg and Marquardt's method: MINPACK's, or least_squares on a sparse Jacobian if large.

    An iteration is an evaluation of the Jacobian.
    """
    from scipy.optimize import least_squares, root

    system = System(task, trace, counts_jacobians=True)
    problem = system.residual, system.start
    if len(system.start) <= MOST_DENSE:
        own: Any = {"xtol": TIGHT, "ftol": TIGHT, "gtol": 0.0, "maxiter": ENDLESS}
        found: Any = root(*problem, method="lm", jac=system.jacobian, options=own)
    else:
        limits: Any = {"xtol": TIGHT, "ftol": TIGHT, "gtol": TIGHT, "max_nfev": ENDLESS}
        jacobian = system.sparse_jacobian
        found = least_squares(*problem, jac=jacobian, method="trf", tr_solver="lsmr", **limits)
    return system.ended(found.x, str(found.message))


def lbfgs(task: Task, trace: Trace) -> End:
    """Run L-BFGS-B on the energy and its gradient."""
    from scipy.optimize import minimize

    system = System(task, trace)
    found: Any = minimize(
        system.energy_and_gradient,
        system.start,
        jac=True,
        method="L-BFGS-B",
        callback=system.count,
        options={"maxcor": 20, "maxiter": ENDLESS, "maxfun": ENDLESS, "ftol": 0.0, "gtol": 0.0},
    )
    return system.ended(found.x, str(found.message))


class System(Unknowns):
    """The functions that scipy calls, which count and note every shape that is tried.

    counts_jacobians : an iteration is an evaluation of the Jacobian, not of the residual
    """

    def __init__(self, task: Task, trace: Trace, counts_jacobians: bool = False):
        super().__init__(task, trace)
        self.iterations = self.evaluations = 0
        self.counts_jacobians = counts_jacobians
        self.last: tuple[bytes, State] | None = None

    def residual(self, x: np.ndarray) -> np.ndarray:
        """Return minus the out-of-balance forces, (m,)."""
        if not self.counts_jacobians:
            self.iterations = self.evaluations
        return self.gradient(self._noted(x))

    def energy_and_gradient(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """Return the potential energy and its gradient (m,)."""
        state = self._noted(x)
        return state.energy, self.gradient(state)

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Return K, (m, m)."""
        if not self.mechanics.is_small:
            return np.asarray(self.sparse_jacobian(x).toarray())
        self.iterations += self.counts_jacobians
        dofs, K = self.mechanics.dofs, self._at(x).dense_tangent()
        return K if self.mechanics.mask is None else K[np.ix_(dofs, dofs)]

    def sparse_jacobian(self, x: np.ndarray) -> Any:
        """Return K over the free coordinates, in their order, as a sparse matrix."""
        from scipy.sparse import csc_array

        self.iterations += self.counts_jacobians
        state, mechanics = self._at(x), self.mechanics
        pattern = TangentPattern(mechanics)
        data = pattern.fill(*state.parts()[1:])
        K = csc_array((data, pattern.indices, pattern.indptr), shape=(pattern.size, pattern.size))
        by_node = np.arange(pattern.size).reshape(-1, pattern.d).T.reshape(-1)[mechanics.dofs]
        return K.tocsr()[by_node][:, by_node]

    def count(self, intermediate_result: Any) -> None:
        """Count an iteration."""
        self.iterations += 1

    def ended(self, x: np.ndarray, message: str) -> End:
        """Return where scipy came to, with its own words."""
        X = self.mechanics.shape(self.state(np.asarray(x)).X)
        return End(X, message=" ".join(message.split()))

    def _noted(self, x: np.ndarray) -> State:
        state = self._at(x)
        self.evaluations += 1
        self.add(self.iterations, self.evaluations, state)
        return state

    def _at(self, x: np.ndarray) -> State:
        """Return the state at x, kept in case the Jacobian is asked for there."""
        key = x.tobytes()
        if self.last is None or self.last[0] != key:
            self.last = key, self.state(x)
        return self.last[1]
