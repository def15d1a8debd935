"""Adaptive force densities, after Zhang and Ohsaki (2006).

Start with the prototype, q = +1 in cables and -1 in struts, and by turns

    D = rho^T diag(q) rho = sum_k v_k f_k f_k^T      eq. (4), its spectral decomposition
    T = sum_k max(v_k, 0) f_k f_k^T, k > d           v_k ascending, that of the constant vector set apart:
                                                     eigenvalues set to zero, so that T lacks d + 1 in rank
    q = argmin |rho^T diag(q) rho - T|               least squares, one q in each class of members

until nothing is left to be set to zero. Then few nodes, d + 1 of them, are placed, and D X = 0 places all
others. With A = T - D, r_e a row of rho, and S from classes to members, the normal equations are

    S^T G S dp = S^T a,   G_ef = (r_e . r_f)^2,   a_e = r_e^T A r_e,   q <- q + S dp

Public is the abstract: eigenvalues and spectral decomposition by turns until the rank is deficient, then an
independent set of nodal coordinates. The formulas above are ours; so are the signs ("least" with sign, for a
super-stable form), the scale of q, kept, and which nodes: each the farthest from the span of those before.
They go to the corners of a simplex, as any other places are an affine map away.
"""

from collections.abc import Iterator

import numpy as np

from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.equilibrium import force_density_matrix
from cgff_cli.rivals.forms import (
    NULL,
    Decomposition,
    Form,
    ended,
    formed,
    prototype,
    spectrum,
    spread,
    unit_coordinates,
)
from cgff_cli.rivals.task import End, Task, Trace
from cgff_cli.structure import Structure

MOST_TURNS = 2000
"""The rounds converge linearly, each by a factor that hangs on the structure."""


def afdm(task: Task, trace: Trace) -> End:
    """Return a form of the task's connectivity and signs; raises CgffError where there is none."""
    return ended(*formed(task, trace, _rounds))


def _rounds(structure: Structure, classes: np.ndarray) -> Iterator[Form]:
    """Yield what every round leads to; classes: (b,) int, whose members share one force density."""
    n, d = structure.coordinates.shape
    rho_t = dense(structure.start, structure.end, n)
    members = spread(classes)
    inverse = np.linalg.pinv(members.T @ (rho_t.T @ rho_t) ** 2 @ members, hermitian=True)
    q = prototype(structure)
    for _ in range(MOST_TURNS):
        found = spectrum(force_density_matrix(rho_t, q))
        X, left = unit_coordinates(found, d)
        yield Form(placed(X), q, left)
        if left <= NULL:
            return
        q = q + members @ (inverse @ (members.T @ shortfall(found, d, rho_t)))
        size = np.linalg.norm(q) / np.sqrt(len(q))
        if size <= NULL:  # nothing but zero lacks that rank
            return
        q /= size


def shortfall(found: Decomposition, d: int, rho_t: np.ndarray) -> np.ndarray:
    """Return a, (b,): the eigenvalues set to zero, as every member sees them."""
    count = max(found.lowest(d), int((found.values < 0.0).sum()))
    return np.asarray(-found.values[:count] @ (found.vectors[:, :count].T @ rho_t) ** 2)


def placed(X: np.ndarray) -> np.ndarray:
    """Return the affine map of X (n, m) that has m + 1 of its nodes at the corners of a simplex."""
    N = np.column_stack([np.ones(len(X)), X])
    left, chosen = N.copy(), []
    for _ in range(N.shape[1]):
        chosen.append(int(np.argmax((left**2).sum(axis=1))))
        along = left[chosen[-1]] / np.linalg.norm(left[chosen[-1]])
        left -= np.outer(left @ along, along)
    return np.asarray(N @ np.linalg.inv(N[chosen])[:, 1:])
