"""All methods that `compare` knows, by their names in its output; CGFF's own first."""

from typing import NamedTuple

from cgff_cli.rivals import own
from cgff_cli.rivals.dynamic_relaxation import dynamic_relaxation
from cgff_cli.rivals.fdm import fdm
from cgff_cli.rivals.schek import schek
from cgff_cli.rivals.scipy_solvers import fsolve, fsolve_fd, lbfgs, lm
from cgff_cli.rivals.task import Rival


class Entry(NamedTuple):
    """A method: its function, how it ends, and how its answer is laid over CGFF's.

    judges_itself : stops by its own tests; others are stopped by CGFF's
    is_affine     : its answer is known up to an affine map, otherwise up to a rigid motion
    """

    run: Rival
    judges_itself: bool = False
    is_affine: bool = False


REGISTRY = {
    "cgff": Entry(own.cgff, judges_itself=True),
    "cgff-residual": Entry(own.cgff_residual, judges_itself=True),
    "table1": Entry(own.table1, judges_itself=True),
    "fdm": Entry(fdm, judges_itself=True, is_affine=True),
    "schek": Entry(schek, judges_itself=True),
    "fsolve": Entry(fsolve),
    "fsolve-fd": Entry(fsolve_fd),
    "lm": Entry(lm),
    "lbfgs": Entry(lbfgs),
    "dr": Entry(dynamic_relaxation),
}
"""Method name -> its Entry."""
