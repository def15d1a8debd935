"""Linear force density method (Schek 1974) with supports, from CGFF's force densities.

    D_ff x_f = F - D_fc x_c,    D = rho^T diag(q) rho, eq. (4), f free and c held, axis by axis

With the q of an equilibrium it must give back that equilibrium's coordinates.
"""

import numpy as np

from cgff_cli.errors import CgffError
from cgff_cli.mechanics.connectivity import DENSE_ENTRIES, dense
from cgff_cli.mechanics.equilibrium import force_density_matrix
from cgff_cli.mechanics.pattern import GraphPattern
from cgff_cli.rivals.task import End, Task, Trace, centred
from cgff_cli.structure import Structure

SINGULAR = 1e-12
"""A singular value of D_ff below this share of the largest force density leaves nodes without a place."""


def schek(task: Task, trace: Trace) -> End:
    """Solve for the free coordinates in one linear step per axis; raises CgffError where none is unique."""
    structure, q = centred(task.structure), task.best.force_densities
    if structure.free.all():
        raise CgffError("no supports: the force density method needs held nodes")
    trace.start()
    D = _force_density_matrix(structure, q)
    X = structure.coordinates.copy()
    for axis in range(X.shape[1]):
        f = np.flatnonzero(structure.free[:, axis])
        c = np.flatnonzero(~structure.free[:, axis])
        if len(f) and not len(c):
            raise CgffError(f"no node is held along {'xyz'[axis]}")
        D_ff, forces = D[f][:, f], structure.loads[f, axis] - D[f][:, c] @ X[c, axis]
        X[f, axis] = _solved(D_ff, forces, SINGULAR * float(np.abs(q).max()))
    trace.add(1, 1, X)
    return End(X, "form_found", "by one linear solve per axis", q)


def _force_density_matrix(structure: Structure, q: np.ndarray):  # type: ignore[no-untyped-def]
    """Return D, (n, n), dense for a small structure and sparse for a large one."""
    n = len(structure.coordinates)
    if n * len(q) <= DENSE_ENTRIES:
        return force_density_matrix(dense(structure.start, structure.end, n), q)
    pattern = GraphPattern(structure.start, structure.end, np.arange(n))
    return pattern.matrix(pattern.fill(q, q, -q)).tocsr()


def _solved(D, forces: np.ndarray, least: float) -> np.ndarray:  # type: ignore[no-untyped-def]
    """Return D^-1 forces; raises CgffError where D has singular values down to the least allowed."""
    if isinstance(D, np.ndarray):
        if D.size and np.linalg.svd(D, compute_uv=False)[-1] > least:
            return np.linalg.solve(D, forces)
        if not D.size:
            return forces
    else:
        from scipy.sparse.linalg import splu

        try:
            return np.asarray(splu(D.tocsc()).solve(forces))
        except RuntimeError:  # exactly singular
            pass
    raise CgffError("the force densities hold some node nowhere: D_ff is singular")
