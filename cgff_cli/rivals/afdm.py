"""Adaptive force densities (the kind of Zhang and Ohsaki 2006): D itself gets the rank it should have.

D = rho^T diag(q) rho, eq. (4), is linear in q: vec D = B q. In turn

    D = Phi Lambda Phi^T;  its d + 1 least eigenvalues, with sign, become zero     (the nearest such D >= 0)
    q: least squares of B q against the D so made, scaled to the prototype's size

until they vanish, eq. (5). The null vectors then give every node from d + 1 nodes in general position:
those that a pivoted elimination picks, at their places in the scene's start. The answer is known up to an
affine map. Of the paper the idea is public, which eigenvalues are set and the scaling are ours; members
share force densities by classes, as in `fdm`.
"""

from collections.abc import Iterator

import numpy as np

from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.equilibrium import equilibrium_matrix
from cgff_cli.rivals.fdm import NULL, Form, fault_of, form_found, prototype_of, spread_of
from cgff_cli.rivals.task import End, Task, Trace
from cgff_cli.structure import Structure

MOST_PROJECTIONS = 2000
"""Rounds after which it gives up: they converge linearly."""


def afdm(task: Task, trace: Trace) -> End:
    """Return a form of the task's connectivity and signs; raises CgffError where there is none."""
    return form_found(task, trace, _rounds)


def _rounds(structure: Structure, classes: np.ndarray) -> Iterator[Form]:
    """Yield the form after every round; the last one's fault is empty if it is one."""
    n, d = structure.coordinates.shape
    rho_t = dense(structure.start, structure.end, n)
    prototype, spread = prototype_of(structure), spread_of(classes)
    # vec D of one class each: the least squares below are those of B spread.
    B = np.einsum("ie,je,ec->ijc", rho_t, rho_t, spread).reshape(n * n, -1)
    solve, p = np.linalg.pinv(B), spread.T @ prototype
    size = np.linalg.norm(p)
    for number in range(1, MOST_PROJECTIONS + 1):
        values, vectors = np.linalg.eigh((B @ p).reshape(n, n))
        # A constant vector is always null: it is one of the d + 1 whether among the least or not.
        steady = np.full(n, 1.0 / np.sqrt(n))
        others = np.argsort(np.where(np.abs(vectors.T @ steady) > 0.99, np.inf, values), kind="stable")
        gone = others[:d]
        left = float(np.abs(values[gone]).max() / np.abs(values).max())
        q, X = spread @ p, _placed(np.column_stack([steady, vectors[:, gone]]), structure.coordinates)
        if left <= NULL:
            V = X.T @ rho_t
            yield Form(X, q, fault_of(V, q * prototype, equilibrium_matrix(rho_t, V) @ spread))
            return
        yield Form(X, q, f"{left:.0e} of the rank of D left after {number} rounds")
        values[gone] = 0.0
        p = solve @ ((vectors * values) @ vectors.T).reshape(-1)
        p *= size / np.linalg.norm(p)


def _placed(null: np.ndarray, start: np.ndarray) -> np.ndarray:
    """Return (n, d) coordinates in the span of null vectors (n, d + 1), d + 1 nodes where they start."""
    G, chosen = null.copy(), []
    for _ in range(G.shape[1]):
        row = int(np.abs(G).max(axis=1).argmax())
        column = int(np.abs(G[row]).argmax())
        chosen.append(row)
        G -= np.outer(G[:, column] / G[row, column], G[row])
    return np.asarray(null @ np.linalg.solve(null[chosen], start[chosen]))
