"""The paper's rank conditions, eq. (5), (6), states of self-stress and mechanisms."""

from typing import Any

import numpy as np

from cgff_cli.mechanics.elements import TINY
from cgff_cli.mechanics.equilibrium import equilibrium_matrix, force_density_matrix
from cgff_cli.mechanics.state import State
from cgff_cli.solvers.stopping import VANISHED

LEAST_TOLERANCE = 1e-9


def rank_tolerance(residual: float, reference: float) -> float:
    """Return the relative size below which a singular value is zero.

    The shape is known no better than the forces balance, so ranks cannot be either.
    """
    return max(LEAST_TOLERANCE, 10.0 * residual / reference) if reference > 0.0 else LEAST_TOLERANCE


def force_density_threshold(state: State, tolerance: float) -> float:
    """Return the force density below which one is zero: the tolerance of the largest, or rounding error."""
    blurred = state.active_stiffness * state.rounding / np.maximum(state.l, TINY)
    return max(tolerance * float(np.abs(state.q).max()), VANISHED * float(blurred.max()))


def rank_conditions(state: State, tolerance: float, rigid: int) -> dict[str, Any]:
    """Return nullities of D and U and what follows: states of self-stress, mechanisms, rigid motions.

    n_D = n - rank D must be >= d + 1, eq. (5), and n_U = b - rank U >= 1, eq. (6), in a free prestressed
    structure. States of self-stress and mechanisms count taut elements and free directions only; rigid is
    the number of rigid motions. The columns of U are unit vectors, at either end, so that its singular
    values compare with 1; those of D compare with the largest force density. A cable that is shorter than
    its rest length by no more than rounding counts as taut.
    """
    structure, rho = state.mechanics.structure, state.mechanics.connectivity.dense
    n, d = state.X.shape
    D = force_density_matrix(rho, state.q)
    U = equilibrium_matrix(rho, state.u)
    taut = state.stretch >= state.mechanics.least - VANISHED * state.rounding
    taut_rank = _rank(U[structure.free.reshape(-1)][:, taut], tolerance)
    all_taut = state.mechanics.all_free and bool(taut.all())
    nullity_D = n - _rank(D, force_density_threshold(state, tolerance))
    nullity_U = len(taut) - (taut_rank if all_taut else _rank(U, tolerance))
    return {
        "nullity_D": nullity_D,
        "nullity_U": nullity_U,
        "condition_D": nullity_D >= d + 1,
        "condition_U": nullity_U >= 1,
        "self_stress_states": int(taut.sum()) - taut_rank,
        "mechanisms": int(structure.free.sum()) - taut_rank - rigid,
        "rigid_motions": rigid,
        "rank_tolerance": tolerance,
    }


def _rank(matrix: np.ndarray, threshold: float) -> int:
    """Return how many singular values exceed the threshold."""
    if matrix.size == 0:
        return 0
    return int((np.linalg.svd(matrix, compute_uv=False) > threshold).sum())
