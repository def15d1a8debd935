"""Form-finding from connectivity and signs alone (Estrada, Bungartz and Mohrdieck 2006).

Start with q = +1 in cables and -1 in struts, the prototype, and repeat

    D = rho^T diag(q) rho                        eq. (4); coordinates: the eigenvectors of its d + 1
                                                 least eigenvalues, but for the constant one
    U q = 0                                      eq. (3) of those coordinates; q: of its near null space,
                                                 by SVD, the vector nearest the prototype

until the d + 1 least eigenvalues of D vanish, eq. (5), and U has a null vector, eq. (6). "Least" with sign,
so that D ends positive semidefinite: a super-stable form. The answer is known up to an affine map.

A form that carries several states of self-stress, or none with all members alike, leaves a choice. Members
of a class share one force density: first the scene's groups, then what connectivity and signs cannot tell
apart, then every member on its own; the first of these that ends well is taken.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from cgff_cli.errors import CgffError
from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.equilibrium import equilibrium_matrix, force_density_matrix
from cgff_cli.rivals.symmetry import member_classes
from cgff_cli.rivals.task import End, Task, Trace
from cgff_cli.structure import Structure

NULL = 1e-13
"""Eigenvalues of D, and singular values of U, are zero below this share of the largest."""

NEAR = 2.0
"""Singular vectors count as near null up to this multiple of the least singular value."""

BLIND = 1e-6
"""A singular vector whose share of the prototype is below this has no part in it."""

TIED = 1e-9
"""Eigenvalues that differ by less than this share of the largest tie."""

MOST_ROUNDS = 200
MOST_NODES = 1000
MOST_NODES_FOR_CLASSES = 120


class Form(NamedTuple):
    """What one choice of classes led to; fault: why it is no form, if it is none."""

    X: np.ndarray
    q: np.ndarray
    fault: str


Rounds = Callable[[Structure, np.ndarray], Iterator[Form]]
"""Yields the form after every round, members of a class alike; the last one's fault is empty if it is one."""


def fdm(task: Task, trace: Trace) -> End:
    """Return a form of the task's connectivity and signs; raises CgffError where there is none."""
    return form_found(task, trace, _rounds)


def form_found(task: Task, trace: Trace, rounds_of: Rounds) -> End:
    """Return the first form that some rounds end well with, classes of members in turn; raises CgffError."""
    n, b = len(task.structure.coordinates), len(task.structure.start)
    if max(n, b / 3) > MOST_NODES:
        raise CgffError(f"its dense matrices are not made for more than {MOST_NODES} nodes, here {n}")
    trace.start()
    faults = []
    rounds = 0
    for name, classes in _classes(task):
        for form in rounds_of(task.structure, classes):
            rounds += 1
            trace.add(rounds, rounds, form.X)
        if not form.fault:
            return End(form.X, "form_found", f"one force density per {name}", form.q)
        faults.append(f"{form.fault} with one force density per {name}")
    raise CgffError("; ".join(faults))


def _classes(task: Task) -> Iterator[tuple[str, np.ndarray]]:
    """Yield what to call a class, and the class of every member, (b,) int."""
    structure = task.structure
    n = len(structure.coordinates)
    yield "group", task.groups
    if n <= MOST_NODES_FOR_CLASSES:
        classes = member_classes(structure.start, structure.end, prototype_of(structure), n)
        yield "class of like members", classes
    yield "member", np.arange(len(structure.start))


def prototype_of(structure: Structure) -> np.ndarray:
    """Return (b,) 1 for cables and -1 for struts."""
    return np.where(structure.tension_only, 1.0, -1.0)


def _rounds(structure: Structure, classes: np.ndarray) -> Iterator[Form]:
    """Yield the form after every round; the last one's fault is empty if it is one."""
    n, d = structure.coordinates.shape
    rho_t = dense(structure.start, structure.end, n)
    q = prototype = prototype_of(structure)
    spread = spread_of(classes)
    for _ in range(MOST_ROUNDS):
        X, left = unit_coordinates(force_density_matrix(rho_t, q), d)
        V = X.T @ rho_t
        stresses = equilibrium_matrix(rho_t, V) @ spread
        if left <= NULL:
            yield Form(X, q, fault_of(V, q * prototype, stresses))
            return
        yield Form(X, q, f"{left:.0e} of the rank of D left after {MOST_ROUNDS} rounds")
        q = spread @ nearest_state(stresses, spread.T @ prototype)
        q *= np.sqrt(len(q)) / np.linalg.norm(q)


def spread_of(classes: np.ndarray) -> np.ndarray:
    """Return (b, c) with orthonormal columns: class values -> member values."""
    spread = np.zeros((len(classes), int(classes.max()) + 1))
    spread[np.arange(len(classes)), classes] = 1.0
    return spread / np.sqrt(spread.sum(axis=0))


def unit_coordinates(D: np.ndarray, d: int) -> tuple[np.ndarray, float]:
    """Return (n, m) coordinates of unit spread and the largest of the d least eigenvalues, relative.

    The constant vector, of eigenvalue 0, is set apart: where D has negative eigenvalues it need not be
    among the d + 1 least. m is d, or more where eigenvalues tie with the last one taken: to pick among
    their vectors would break a symmetry that the structure has.
    """
    n = len(D)
    largest = float(np.abs(D).sum(axis=1).max())
    values, vectors = np.linalg.eigh(D + 2.0 * largest / n)
    count = int((values <= values[d - 1] + TIED * largest).sum())
    return vectors[:, :count] * np.sqrt(n), float(np.abs(values[:d]).max()) / largest


def nearest_state(stresses: np.ndarray, prototype: np.ndarray) -> np.ndarray:
    """Return the vector of the near null space that is nearest the prototype."""
    _, singular, rows = np.linalg.svd(stresses)
    sizes = np.zeros(len(rows))
    sizes[: len(singular)] = singular
    share = rows @ prototype
    seen = np.abs(share) > BLIND * np.linalg.norm(prototype)
    near = seen & (sizes <= max(NEAR * float(sizes[seen].min()), NULL * float(sizes.max())))
    return np.asarray(rows[near].T @ share[near])


def fault_of(V: np.ndarray, signed: np.ndarray, stresses: np.ndarray) -> str:
    """Return why a D of nullity d + 1 is no form after all, or nothing; signed: q, > 0 of the right sign."""
    lengths = np.linalg.norm(V, axis=0)
    if (signed <= 0.0).any():
        return "some member has the wrong sign"
    if lengths.min() <= 1e-6 * lengths.max():
        return "the ends of some member coincide"
    sizes = np.linalg.svd(stresses, compute_uv=False)
    if len(sizes) == stresses.shape[1] and sizes[-1] > 1e-9 * sizes[0]:
        return "no state of self-stress"
    return ""
