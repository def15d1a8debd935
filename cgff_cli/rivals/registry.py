"""All methods that `compare` knows, by their names in its output; CGFF's own first."""

from typing import NamedTuple

from cgff_cli.rivals import own
from cgff_cli.rivals.dynamic_relaxation import dynamic_relaxation
from cgff_cli.rivals.fdm import fdm
from cgff_cli.rivals.schek import schek
from cgff_cli.rivals.scipy_solvers import fsolve, fsolve_fd, lbfgs, lm
from cgff_cli.rivals.task import Rival


class Entry(NamedTuple):
    """A method: its function, what it is, and how its answer is laid over CGFF's.

    judges_itself : stops by its own tests; others are stopped by CGFF's
    is_affine     : its answer is known up to an affine map, otherwise up to a rigid motion
    """

    run: Rival
    text: str
    judges_itself: bool = False
    is_affine: bool = False


REGISTRY = {
    "cgff": Entry(own.cgff, "CGFF on the energy", judges_itself=True),
    "cgff-residual": Entry(own.cgff_residual, "CGFF on eq. (10)", judges_itself=True),
    "table1": Entry(own.table1, "the paper's Table I to the letter", judges_itself=True),
    "fdm": Entry(
        fdm, "form-finding from connectivity and signs (Estrada)", judges_itself=True, is_affine=True
    ),
    "schek": Entry(schek, "linear force density method with CGFF's force densities", judges_itself=True),
    "fsolve": Entry(fsolve, "scipy's fsolve with the exact Jacobian"),
    "fsolve-fd": Entry(fsolve_fd, "scipy's fsolve without a Jacobian, by finite differences"),
    "lm": Entry(lm, "scipy's Levenberg-Marquardt with the exact Jacobian"),
    "lbfgs": Entry(lbfgs, "scipy's L-BFGS-B on the energy"),
    "dr": Entry(dynamic_relaxation, "dynamic relaxation with kinetic damping"),
}
"""Method name -> its Entry."""
