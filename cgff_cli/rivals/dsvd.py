"""Double singular value decomposition (the kind of Tran and Lee 2011): all states of self-stress, then one.

As `fdm`, but for the step from coordinates to force densities:

    U = W Sigma T^T;  T_s: the s states of self-stress, the right vectors of the near null space
    [T_s  -E] (beta; x) = 0, by a second decomposition; E: a column of ones for each class of members
    q = T_s beta, the state in which members of a class are alike, nearest the prototype of signs

The second decomposition is that of Yuan, Chen and Dong for domes; here its near null space is taken as well,
since neither is exact before the last round. Of Tran and Lee's paper only excerpts are public; which vectors
count as near null is ours. The answer is known up to an affine map.
"""

from collections.abc import Iterator

import numpy as np

from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.equilibrium import equilibrium_matrix, force_density_matrix
from cgff_cli.rivals.fdm import (
    MOST_ROUNDS,
    NEAR,
    NULL,
    Form,
    fault_of,
    form_found,
    nearest_state,
    prototype_of,
    spread_of,
    unit_coordinates,
)
from cgff_cli.rivals.task import End, Task, Trace
from cgff_cli.structure import Structure


def dsvd(task: Task, trace: Trace) -> End:
    """Return a form of the task's connectivity and signs; raises CgffError where there is none."""
    return form_found(task, trace, _rounds)


def _rounds(structure: Structure, classes: np.ndarray) -> Iterator[Form]:
    """Yield the form after every round; the last one's fault is empty if it is one."""
    n, d = structure.coordinates.shape
    rho_t = dense(structure.start, structure.end, n)
    q = prototype = prototype_of(structure)
    spread = spread_of(classes)
    for _ in range(MOST_ROUNDS):
        X, left = unit_coordinates(force_density_matrix(rho_t, q), d)
        V = X.T @ rho_t
        U = equilibrium_matrix(rho_t, V)
        if left <= NULL:
            yield Form(X, q, fault_of(V, q * prototype, U @ spread))
            return
        yield Form(X, q, f"{left:.0e} of the rank of D left after {MOST_ROUNDS} rounds")
        states = _states(U)
        both = np.hstack([states, -spread])
        # Of what is null in both, the prototype's shares in states and in classes pick one.
        own = nearest_state(both, np.concatenate([states.T @ prototype, spread.T @ prototype]))
        q = states @ own[: states.shape[1]]
        q *= np.sqrt(len(q)) / np.linalg.norm(q)


def _states(U: np.ndarray) -> np.ndarray:
    """Return the states of self-stress, (b, s): right vectors of the near null space, at least one."""
    _, singular, rows = np.linalg.svd(U)
    sizes = np.zeros(len(rows))
    sizes[: len(singular)] = singular
    near = sizes <= max(NEAR * float(sizes.min()), NULL * float(sizes.max()))
    return np.asarray(rows[near].T)
