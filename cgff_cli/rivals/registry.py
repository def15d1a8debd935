"""All methods that `compare` knows, by their names in its output; here stand those of CGFF itself."""

from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from cgff_cli.rivals.afdm import afdm
from cgff_cli.rivals.dsvd import dsvd
from cgff_cli.rivals.dynamic_relaxation import dynamic_relaxation
from cgff_cli.rivals.fdm import fdm
from cgff_cli.rivals.monte_carlo import monte_carlo
from cgff_cli.rivals.schek import schek
from cgff_cli.rivals.scipy_solvers import fsolve, lbfgs, lm
from cgff_cli.rivals.task import End, Rival, Task, Trace
from cgff_cli.rivals.znn import znn
from cgff_cli.solvers.cgff import run_of
from cgff_cli.solvers.descent import iterates
from cgff_cli.solvers.rescues import onward
from cgff_cli.solvers.run import Iterate
from cgff_cli.solvers.table1 import TableOne


class Entry(NamedTuple):
    """A method: its function, how it ends, and how its answer is laid over CGFF's.

    judges_itself : stops by its own tests; others are stopped by CGFF's
    is_affine     : its answer is known up to an affine map, otherwise up to a rigid motion
    """

    run: Rival
    judges_itself: bool = False
    is_affine: bool = False


def cgff(task: Task, trace: Trace, objective: str = "energy") -> End:
    """Run CGFF on the energy, or on eq. (10), half the squared residual."""
    run, _ = run_of(task.structure, task.options.merged({"objective": objective}))
    X = _traced(trace, iterates(run, onward))
    return End(X, str(run.verdict))


def table1(task: Task, trace: Trace) -> End:
    """Run the paper's Table I to the letter."""
    run = TableOne(task.structure, task.options)
    X = _traced(trace, run.iterates(), task.structure.coordinates.mean(axis=0))
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        return End(X, run.judged().value)


def _traced(trace: Trace, path: Iterator[Iterate], origin: np.ndarray | float = 0.0) -> np.ndarray:
    """Show every iterate to the trace; return the last shape about the centroid of the start."""
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        for iterate in path:
            X = iterate.state.mechanics.shape(iterate.state.X) - origin
            trace.add(iterate.number, iterate.evaluations, X)
    return X


REGISTRY = {
    "cgff": Entry(cgff, judges_itself=True),
    "cgff-residual": Entry(partial(cgff, objective="residual"), judges_itself=True),
    "table1": Entry(table1, judges_itself=True),
    "fdm": Entry(fdm, judges_itself=True, is_affine=True),
    "afdm": Entry(afdm, judges_itself=True, is_affine=True),
    "dsvd": Entry(dsvd, judges_itself=True, is_affine=True),
    "schek": Entry(schek, judges_itself=True),
    "fsolve": Entry(fsolve),
    "fsolve-fd": Entry(partial(fsolve, with_jacobian=False)),
    "lm": Entry(lm),
    "lbfgs": Entry(lbfgs),
    "dr": Entry(dynamic_relaxation),
    "znn": Entry(znn),
    "mc": Entry(monte_carlo),
}
"""Method name -> its Entry."""
