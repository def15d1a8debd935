"""Mechanisms as motions, and what prestress does to them.

Along a mechanism no length changes to first order, so that only the stress matrix, I (x) D, resists. The
least of its values there tells prestress-stability (Pellegrino and Calladine 1986), its eigenvectors there
are the mechanisms, told apart.
"""

import numpy as np

from cgff_cli.analysis.ranks import Ranks
from cgff_cli.mechanics import tangent
from cgff_cli.mechanics.state import State


def mechanisms_of(ranks: Ranks) -> tuple[np.ndarray, np.ndarray]:
    """Return stiffnesses (m,) by stress alone, rising, and unit shapes (m, d, moving) of a small structure.

    Both are in the frame's units; rigid motions that the supports allow are left out.
    """
    state, (d, m) = ranks.state, ranks.state.X.shape
    dofs, motions = state.mechanics.dofs, null_motions(ranks)
    turned = motions.T @ stress_matrix(state, state.q)[np.ix_(dofs, dofs)] @ motions
    values, own = np.linalg.eigh(turned)
    shapes = np.zeros((len(values), d * m))
    shapes[:, dofs] = (motions @ own).T
    return values, shapes.reshape(len(shapes), d, m)


def null_motions(ranks: Ranks) -> np.ndarray:
    """Return an orthonormal basis (f, m) of the mechanisms over the f free directions, eq. (3)."""
    free, rigid = ranks.state.mechanics.structure.free.T.reshape(-1), ranks.state.rigid.basis
    left, values, _ = np.linalg.svd(ranks.U[free][:, ranks.taut])
    rank = int((values > ranks.tolerance).sum())
    still = left[:, rank:]
    apart, sizes, _ = np.linalg.svd(still - rigid @ (rigid.T @ still), full_matrices=False)
    return apart[:, : int((sizes > 0.5).sum())]


def stress_matrix(state: State, q: np.ndarray) -> np.ndarray:
    """Return I (x) D, (d m, d m), axis by axis, of force densities q (b,), eq. (4); 1 where held."""
    nothing = np.zeros(len(q), dtype=bool)
    bare = state.parts(taut=nothing)._replace(q=q)
    return tangent.stiffness_matrix(state.mechanics.connectivity, bare, state.mechanics.mask)
