"""scipy's own solvers on the same residual, mostly with its exact Jacobian; imported when one is called.

A free body can turn and drift without force, which leaves the Jacobian singular at every equilibrium.
fsolve (MINPACK's hybr) asks for a regular one and may stall; Levenberg and Marquardt's damping does not
mind; L-BFGS-B only ever sees the energy and its gradient. Nothing is held to help them.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from cgff_cli.errors import CgffError
from cgff_cli.mechanics.pattern import TangentPattern
from cgff_cli.mechanics.state import State
from cgff_cli.rivals.task import End, Task, Unknowns

MOST_DENSE = 2000
"""Unknowns up to which a dense Jacobian, and its QR factors in every step, are worth having."""

TIGHT = 1e-15
"""Their own tolerances: too tight to hold before the test of the residual that ends every rival."""


def fsolve(task: Task) -> End:
    """Run scipy.optimize.fsolve; an iteration is an evaluation of the residual, one trial step each."""
    system = System(task)
    return _fsolve(system, system.jacobian)


def fsolve_fd(task: Task) -> End:
    """Run it without a Jacobian, by finite differences; their evaluations count as iterations too."""
    return _fsolve(System(task), None)


def _fsolve(system: "System", jacobian: Callable[[np.ndarray], np.ndarray] | None) -> End:
    from scipy.optimize import fsolve as minpack

    if len(system.start) > MOST_DENSE:
        raise CgffError(f"its dense Jacobian is not made for more than {MOST_DENSE} unknowns")
    x, _, _, message = minpack(
        system.residual,
        system.start,
        fprime=jacobian,
        xtol=TIGHT,
        maxfev=1_000_000,
        full_output=True,
    )
    return system.ended(x, message)


def lm(task: Task) -> End:
    """Run Levenberg and Marquardt's method: MINPACK's, or least_squares on a sparse Jacobian if large.

    An iteration is an evaluation of the Jacobian.
    """
    from scipy.optimize import least_squares, root

    system = System(task)
    system.counts_jacobians = True
    if len(system.start) <= MOST_DENSE:
        found: Any = root(
            system.residual,
            system.start,
            method="lm",
            jac=system.jacobian,
            options={"xtol": TIGHT, "ftol": TIGHT, "gtol": 0.0, "maxiter": 1_000_000},
        )
    else:
        found = least_squares(
            system.residual,
            system.start,
            jac=system.sparse_jacobian,
            method="trf",
            tr_solver="lsmr",
            xtol=TIGHT,
            ftol=TIGHT,
            gtol=TIGHT,
            max_nfev=1_000_000,
        )
    return system.ended(found.x, str(found.message))


def lbfgs(task: Task) -> End:
    """Run L-BFGS-B on the energy and its gradient."""
    from scipy.optimize import minimize

    system = System(task)
    found: Any = minimize(
        system.energy_and_gradient,
        system.start,
        jac=True,
        method="L-BFGS-B",
        callback=system.count,
        options={"maxcor": 20, "maxiter": 1_000_000, "maxfun": 1_000_000, "ftol": 0.0, "gtol": 0.0},
    )
    return system.ended(found.x, str(found.message))


class System(Unknowns):
    """The functions that scipy calls, which count and note every shape that is tried."""

    def __init__(self, task: Task):
        task.trace.start()
        super().__init__(task)
        self.iterations = 0
        self.evaluations = 0
        self.counts_jacobians = False
        self.last: tuple[bytes, State] | None = None

    def residual(self, x: np.ndarray) -> np.ndarray:
        """Return minus the out-of-balance forces, (m,)."""
        state = self._at(x)
        if not self.counts_jacobians:
            self.iterations = self.evaluations
        self.evaluations += 1
        self.add(self.iterations, self.evaluations, state)
        return self.gradient(state)

    def jacobian(self, x: np.ndarray) -> np.ndarray:
        """Return K, (m, m)."""
        self._count_jacobian()
        dofs = self.mechanics.dofs
        K = self._at(x).dense_tangent() if self.mechanics.is_small else self._sparse(x).toarray()
        return K if self.mechanics.mask is None or not self.mechanics.is_small else K[np.ix_(dofs, dofs)]

    def sparse_jacobian(self, x: np.ndarray) -> Any:
        """Return K as a sparse matrix; the rows of held directions are cut out."""

        self._count_jacobian()
        return self._sparse(x)

    def _sparse(self, x: np.ndarray) -> Any:
        """Return K over the free coordinates, in their order."""
        from scipy.sparse import csc_array

        state, mechanics = self._at(x), self.mechanics
        pattern = TangentPattern(mechanics)
        extra = np.zeros((pattern.graph.size, pattern.d, pattern.d))
        data = pattern.fill(*state.parts()[1:], extra, 1.0)
        K = csc_array((data, pattern.indices, pattern.indptr), shape=(pattern.size, pattern.size))
        by_node = np.arange(pattern.size).reshape(-1, pattern.d).T.reshape(-1)[mechanics.dofs]
        return K.tocsr()[by_node][:, by_node]

    def energy_and_gradient(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """Return the potential energy and its gradient (m,)."""
        state = self._at(x)
        self.evaluations += 1
        self.add(self.iterations, self.evaluations, state)
        return state.energy, self.gradient(state)

    def count(self, intermediate_result: Any) -> None:
        """Count an iteration."""
        self.iterations += 1

    def ended(self, x: np.ndarray, message: str) -> End:
        """Return where scipy came to, with its own words."""
        return End(self.shape(self.state(np.asarray(x))), message=" ".join(message.split()))

    def _count_jacobian(self) -> None:
        if self.counts_jacobians:
            self.iterations += 1

    def _at(self, x: np.ndarray) -> State:
        """Return the state at x, kept in case the Jacobian is asked for there."""
        key = x.tobytes()
        if self.last is None or self.last[0] != key:
            self.last = key, self.state(x)
        return self.last[1]
