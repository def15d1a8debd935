"""The paper's rank conditions, eq. (5), (6), states of self-stress and mechanisms."""

from typing import Any

import numpy as np

from cgff_cli.mechanics.connectivity import dense
from cgff_cli.mechanics.equilibrium import equilibrium_matrix, force_density_matrix
from cgff_cli.mechanics.rigid import rigid_motions
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.stopping import VANISHED

LEAST_TOLERANCE = 1e-9


def rank_tolerance(relative: float) -> float:
    """Return the relative size below which a singular value is zero.

    The shape is known no better than the forces balance (relative), so ranks cannot be either.
    """
    return max(LEAST_TOLERANCE, 10.0 * relative)


def force_density_threshold(state: State, tolerance: float) -> float:
    """Return the force density below which one is zero: the tolerance of the largest, or rounding error."""
    blurred = state.mechanics.k * state.taut * state.rounding / state.l
    return max(tolerance * float(np.abs(state.q).max()), VANISHED * float(blurred.max()))


def rank_conditions(state: State, tolerance: float) -> dict[str, Any]:
    """Return nullities of D and U and what follows: states of self-stress, mechanisms, rigid motions.

    n_D = n - rank D must be >= d + 1, eq. (5), and n_U = b - rank U >= 1, eq. (6), in a free prestressed
    structure. States of self-stress and mechanisms count taut elements and free directions only. The columns
    of U are unit vectors, at either end, so that its singular values compare with 1; those of D compare with
    the largest force density. A cable that is shorter than its rest length by no more than rounding counts as
    taut.
    """
    mechanics, structure = state.mechanics, state.mechanics.structure
    n, d = structure.coordinates.shape
    rho_t, free = dense(structure.start, structure.end, n), structure.free.T
    U = equilibrium_matrix(rho_t, state.V / state.l)
    taut = state.stretch >= mechanics.least - VANISHED * state.rounding
    taut_rank = _rank(U[free.reshape(-1)][:, taut], tolerance)
    all_taut = mechanics.all_free and bool(taut.all())
    D = force_density_matrix(rho_t, state.q)
    nullity_D = n - _rank(D, force_density_threshold(state, tolerance))
    nullity_U = len(taut) - (taut_rank if all_taut else _rank(U, tolerance))
    rigid = rigid_motions(mechanics.everywhere(state.X), free).shape[1]
    return {
        "nullity_D": nullity_D,
        "nullity_U": nullity_U,
        "condition_D": nullity_D >= d + 1,
        "condition_U": nullity_U >= 1,
        "self_stress_states": int(taut.sum()) - taut_rank,
        "mechanisms": int(free.sum()) - taut_rank - rigid,
        "rigid_motions": rigid,
        "rank_tolerance": tolerance,
    }


def _rank(matrix: np.ndarray, threshold: float) -> int:
    """Return how many singular values exceed the threshold."""
    if matrix.size == 0:
        return 0
    return int((np.linalg.svd(matrix, compute_uv=False) > threshold).sum())
