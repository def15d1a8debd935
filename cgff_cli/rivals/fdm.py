"""Form-finding from connectivity and signs alone (Estrada, Bungartz and Mohrdieck 2006).

Start with q = +1 in cables and -1 in struts, the prototype, and repeat

    D = rho^T diag(q) rho                        eq. (4); coordinates: the eigenvectors of its d + 1
                                                 least eigenvalues, but for the constant one
    U q = 0                                      eq. (3) of those coordinates; q: of its near null space,
                                                 by SVD, the vector nearest the prototype

until the d + 1 least eigenvalues of D vanish, eq. (5), and U has a null vector, eq. (6). "Least" with sign,
so that D ends positive semidefinite: a super-stable form.
"""

from collections.abc import Iterator

import numpy as np

from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.equilibrium import force_density_matrix
from cgff_cli.rivals.forms import (
    NULL,
    Form,
    ended,
    formed,
    prototype,
    spectrum,
    spread,
    states_of,
    unit_coordinates,
)
from cgff_cli.rivals.task import End, Task, Trace
from cgff_cli.structure import Structure

NEAR = 2.0
"""Singular vectors count as near null up to this multiple of the least singular value."""

BLIND = 1e-6
"""A singular vector whose share of the prototype is below this has no part in it."""

MOST_ROUNDS = 200


def fdm(task: Task, trace: Trace) -> End:
    """Return a form of the task's connectivity and signs; raises CgffError where there is none."""
    return ended(*formed(task, trace, by_null_space))


def by_null_space(structure: Structure, classes: np.ndarray) -> Iterator[Form]:
    """Yield what every round leads to; classes: (b,) int, whose members share one force density."""
    n, d = structure.coordinates.shape
    rho_t = dense(structure.start, structure.end, n)
    q = signs = prototype(structure)
    members = spread(classes)
    for _ in range(MOST_ROUNDS):
        X, left = unit_coordinates(spectrum(force_density_matrix(rho_t, q)), d)
        yield Form(X, q, left)
        if left <= NULL:
            return
        q = members @ near_null(states_of(structure, X) @ members, members.T @ signs)
        q *= np.sqrt(len(q)) / np.linalg.norm(q)


def near_null(stresses: np.ndarray, wanted: np.ndarray) -> np.ndarray:
    """Return the vector of the near null space of a matrix that is nearest what is wanted, (c,)."""
    _, singular, rows = np.linalg.svd(stresses)
    sizes = np.zeros(len(rows))
    sizes[: len(singular)] = singular
    share = rows @ wanted
    seen = np.abs(share) > BLIND * np.linalg.norm(wanted)
    near = seen & (sizes <= max(NEAR * float(sizes[seen].min()), NULL * float(sizes.max())))
    return np.asarray(rows[near].T @ share[near])
