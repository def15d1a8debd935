"""What form-finding from connectivity and signs alone has in common: the prototype, classes, what a form is.

A form is a shape X and force densities q of the right signs with D X = 0, eq. (5), D = rho^T diag(q) rho
positive semidefinite: super-stable, known up to an affine map. EA and rest lengths have no part in it.

A form that carries several states of self-stress, or none with all members alike, leaves a choice. Members
of a class share one force density: first the scene's groups, then what connectivity and signs cannot tell
apart, then every member on its own; the first of these that ends well is taken.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np

from cgff_cli.errors import CgffError
from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.equilibrium import equilibrium_matrix
from cgff_cli.rivals.symmetry import member_classes
from cgff_cli.rivals.task import End, Task, Trace
from cgff_cli.structure import Structure

NULL = 1e-13
"""Eigenvalues of D, and singular values of U, are zero below this share of the largest."""

TIED = 1e-9
"""Eigenvalues that differ by less than this share of the largest tie."""

FORCELESS = 1e-9
"""A force density below this share of the largest is none: rounding alone would decide its sign."""

MOST_NODES = 1000
MOST_NODES_FOR_CLASSES = 120


class Form(NamedTuple):
    """Coordinates (n, m) and force densities (b,) after a round, m >= d.

    left: the largest of the eigenvalues of D that must vanish, over the largest of all.
    """

    X: np.ndarray
    q: np.ndarray
    left: float


def formed(
    task: Task, trace: Trace, rounds: Callable[[Structure, np.ndarray], Iterator[Form]]
) -> tuple[Form, str]:
    """Return the first choice of classes that led to a form, and its name; raises CgffError if none did.

    rounds : of a structure and the class of every member, (b,) int; yields what every round led to
    """
    faults = []
    count = 0
    for name, classes in choices(task, trace):
        for form in rounds(task.structure, classes):
            count += 1
            trace.add(count, count, form.X)
        fault = fault_of(task.structure, form, classes)
        if not fault:
            return form, f"one force density per {name}"
        faults.append(f"{fault} with one force density per {name}")
    raise CgffError("; ".join(faults))


def ended(form: Form, words: str) -> End:
    """Return the end of a method that found a form."""
    return End(form.X, "form_found", words, form.q)


def choices(task: Task, trace: Trace) -> Iterator[tuple[str, np.ndarray]]:
    """Yield what to call a class, and the class of every member, (b,) int; raises CgffError if too large.

    Sets the clock to zero. Raises CgffError for supports too: their forms are not known up to an affine map.
    """
    structure = task.structure
    n, b = len(structure.coordinates), len(structure.start)
    if not structure.free.all():
        raise CgffError("it knows no supports: its forms are free bodies")
    if max(n, b / 3) > MOST_NODES:
        raise CgffError(f"its dense matrices are not made for more than {MOST_NODES} nodes, here {n}")
    trace.start()
    yield "group", task.groups
    if n <= MOST_NODES_FOR_CLASSES:
        classes = member_classes(structure.start, structure.end, prototype(structure), n)
        yield "class of like members", classes
    yield "member", np.arange(b)


def prototype(structure: Structure) -> np.ndarray:
    """Return force densities (b,) to begin with: 1 in cables, -1 in struts."""
    return np.where(structure.tension_only, 1.0, -1.0)


def spread(classes: np.ndarray) -> np.ndarray:
    """Return (b, c) with orthonormal columns: class values -> member values."""
    members = np.zeros((len(classes), int(classes.max()) + 1))
    members[np.arange(len(classes)), classes] = 1.0
    return members / np.sqrt(members.sum(axis=0))


def states_of(structure: Structure, X: np.ndarray) -> np.ndarray:
    """Return U of coordinates X (n, m), eq. (3), (m n, b): its null space holds the states of self-stress."""
    rho_t = dense(structure.start, structure.end, len(X))
    return equilibrium_matrix(rho_t, X.T @ rho_t)


class Decomposition(NamedTuple):
    """Eigenvalues of D (n,), ascending, their vectors in columns, and a bound on the size of all of them.

    The constant vector, of eigenvalue 0, stands last, raised to twice the bound: where D has negative
    eigenvalues it need not be among the d + 1 least.
    """

    values: np.ndarray
    vectors: np.ndarray
    bound: float

    def lowest(self, d: int) -> int:
        """Return the count of the d least, or more where others tie with the last one taken.

        To pick among their vectors would break a symmetry that the structure has.
        """
        return int((self.values <= self.values[d - 1] + TIED * self.bound).sum())


def spectrum(D: np.ndarray) -> Decomposition:
    """Return the spectral decomposition of D (n, n), the constant vector set apart."""
    bound = float(np.abs(D).sum(axis=1).max())
    return Decomposition(*np.linalg.eigh(D + 2.0 * bound / len(D)), bound)


def unit_coordinates(found: Decomposition, d: int) -> tuple[np.ndarray, float]:
    """Return (n, m) coordinates of unit spread and the largest of the d least eigenvalues, relative."""
    values, vectors, bound = found
    return vectors[:, : found.lowest(d)] * np.sqrt(len(values)), float(np.abs(values[:d]).max()) / bound


def fault_of(structure: Structure, form: Form, classes: np.ndarray) -> str:
    """Return why what the rounds led to is no form, or nothing."""
    if form.left > NULL:
        return f"{form.left:.0e} of the rank of D left after all rounds"
    least = float((form.q * prototype(structure)).min() / np.abs(form.q).max())
    if least <= FORCELESS:
        return "some member has the wrong sign" if least < -FORCELESS else "some member carries no force"
    V = form.X[structure.end] - form.X[structure.start]
    lengths = np.linalg.norm(V, axis=1)
    if lengths.min() <= 1e-6 * lengths.max():
        return "the ends of some member coincide"
    stresses = states_of(structure, form.X) @ spread(classes)
    sizes = np.linalg.svd(stresses, compute_uv=False)
    if len(sizes) == stresses.shape[1] and sizes[-1] > 1e-9 * sizes[0]:
        return "no state of self-stress"
    return ""
