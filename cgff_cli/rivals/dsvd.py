"""Double singular value decomposition, after Tran and Lee (2011).

First every member has a force density of its own: coordinates from D, by its eigenvalues, and q from their U,
by its singular values, as in `fdm`, until both lack the rank they must. A form with several states of
self-stress, U S = 0, S (b, s), leaves open which. Its symmetry or its designer says which members are alike:
E (b, c), their classes. A second decomposition finds the integral states,

    [S  -E] [a; f] = 0,   q = S a = E f          (a, f): the null space of [S -E], by SVD

and of these the one nearest the prototype, q = +1 in cables and -1 in struts, is taken. The shape stays.

Public are an abstract (Acta Mechanica 222, 2011: topology and types of members alone, both rank deficiencies,
then linear constraints on q that define one integral state; the name is that of Engineering with Computers
29, 2013), and [S -E], in programs after Yuan and Dong (2003). Ours are the nearest of several states, the
first stage by that of `fdm`, and S and E with orthonormal columns.
"""

import numpy as np

from cgff_cli.errors import CgffError
from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.equilibrium import force_density_matrix
from cgff_cli.rivals.fdm import by_null_space
from cgff_cli.rivals.forms import (
    Form,
    choices,
    ended,
    fault_of,
    prototype,
    spectrum,
    spread,
    states_of,
    unit_coordinates,
)
from cgff_cli.rivals.task import End, Task, Trace
from cgff_cli.structure import Structure

VANISHED_AT = 1e-9
"""Singular values of U and of [S -E], and eigenvalues of D, are zero below this share of the largest."""


def dsvd(task: Task, trace: Trace) -> End:
    """Return a form of the task's connectivity and signs; raises CgffError where there is none."""
    structure, first, faults = task.structure, None, []
    for name, classes in choices(task, trace):
        first = first or _first_stage(structure, trace)
        form = integral_state(structure, first, classes)
        fault = fault_of(structure, form, classes) if form else "no state of self-stress"
        if form and not fault:
            return ended(form, f"one force density per {name}")
        faults.append(f"{fault} with one force density per {name}")
    raise CgffError("; ".join(faults))


def _first_stage(structure: Structure, trace: Trace) -> Form:
    """Return a form with a force density for every member; raises CgffError where there is none."""
    members = np.arange(len(structure.start))
    for count, form in enumerate(by_null_space(structure, members), 1):
        trace.add(count, count, form.X)
    if form.left > VANISHED_AT:
        raise CgffError(f"{form.left:.0e} of the rank of D left after {count} rounds")
    return form


def integral_state(structure: Structure, form: Form, classes: np.ndarray) -> Form | None:
    """Return the form with one force density per class and what is left of the rank of D, or None."""
    S, E = null_space(states_of(structure, form.X)), spread(classes)
    states = E @ null_space(np.hstack([S, -E]))[S.shape[1] :]
    if not states.shape[1]:
        return None
    q = states @ (states.T @ prototype(structure))  # columns at right angles, each of length 1 / sqrt 2
    q *= np.sqrt(len(q)) / np.linalg.norm(q)
    D = force_density_matrix(dense(structure.start, structure.end, len(form.X)), q)
    left = unit_coordinates(spectrum(D), structure.coordinates.shape[1])[1]
    return Form(form.X, q, left if left > VANISHED_AT else 0.0)


def null_space(A: np.ndarray) -> np.ndarray:
    """Return an orthonormal basis of the null space of A (m, c), by SVD, in the columns of (c, s)."""
    _, singular, rows = np.linalg.svd(A)
    rank = int((singular > VANISHED_AT * singular[0]).sum())
    return np.asarray(rows[rank:].T)
