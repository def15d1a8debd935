"""Tables II to IV: how near the answers come, and how far the printed columns are from equilibrium."""

from typing import Any

import numpy as np

from cgff_cli.mechanics.equilibrium import force_density_matrix
from tests.paper.conics import conic_misses
from tests.paper.printed import TABLES
from tests.shapes import best_self_stress, distance_difference, node_difference, twist
from tests.studies.claims.cases import NAMES, answer_of

ZERO = 1e-9
"""Singular values below this share of the largest count as zero."""


def measure() -> dict[str, Any]:
    """Return one object per structure."""
    return {name: one_table(name) for name in NAMES}


def one_table(name: str) -> dict[str, Any]:
    """Return nearness to the printed columns, their residuals, and the ranks at our answer."""
    table, answer = TABLES[name], answer_of(name)
    X = answer.coordinates
    D = force_density_matrix(answer.mechanics.connectivity.rho_t, answer.force_densities)
    found: dict[str, Any] = {
        "largest_coordinate_difference": node_difference(X, table.cgff),
        "largest_distance_difference": distance_difference(X, table.cgff),
        "printed_cgff_residual": best_self_stress(table.cgff, table.pairs)[1],
        "printed_fdm_residual": best_self_stress(table.fdm, table.pairs)[1],
        "printed_columns_distance_difference": distance_difference(table.cgff, table.fdm),
        "our_residual": best_self_stress(X, table.pairs)[1],
        "dimension": X.shape[1],
        "rank_D": rank(D),
        "nullity_D": len(D) - rank(D),
    }
    if name == "hexagon":
        found["conic_out_of_reach"] = {"cgff": farthest_miss(table.cgff), "fdm": farthest_miss(table.fdm)}
    if name == "prism":
        columns = {"cgff": table.cgff, "fdm": table.fdm, "ours": X}
        found["twist"] = {column: twist(points, table.struts) for column, points in columns.items()}
    return found


def rank(matrix: np.ndarray) -> int:
    """Return how many singular values are not zero."""
    values = np.linalg.svd(matrix, compute_uv=False)
    return int((values > ZERO * values[0]).sum())


def farthest_miss(X: np.ndarray) -> float:
    """Return the distance within which no points, coordinate by coordinate, lie on a conic."""
    low, high = 0.0, 1e-2
    for _ in range(20):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if conic_misses(X, middle) else (low, middle)
    return low


def show(found: dict[str, Any]) -> None:
    """Print a line per structure."""
    print(f"{'table':7}{'nodes off':>10}{'distances':>10}{'|U q|/|t| printed':>19}{'FDM':>9}{'ours':>9}")
    for name, one in found.items():
        print(
            f"{NAMES[name]:7}{one['largest_coordinate_difference']:10.1e}"
            f"{one['largest_distance_difference']:10.1e}{one['printed_cgff_residual']:19.1e}"
            f"{one['printed_fdm_residual']:9.1e}{one['our_residual']:9.1e}"
            f"   rank D {one['rank_D']}, nullity {one['nullity_D']}, d + 1 = {one['dimension'] + 1}"
        )
    misses, twists = found["hexagon"]["conic_out_of_reach"], found["prism"]["twist"]
    print(f"III: no conic within {misses['cgff']:.3e} of the CGFF column, {misses['fdm']:.3e} of FDM")
    print("IV: twist " + ", ".join(f"{column} {angle:.2f}" for column, angle in twists.items()))
