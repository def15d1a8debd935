"""CGFF itself, on the energy or on eq. (10), and the paper's Table I: the same solvers as `solve` has."""

from collections.abc import Iterator

import numpy as np

from cgff_cli.rivals.task import End, Task
from cgff_cli.rivals.trace import Trace
from cgff_cli.solvers.cgff import run_of
from cgff_cli.solvers.descent import iterates
from cgff_cli.solvers.rescues import onward
from cgff_cli.solvers.run import Iterate
from cgff_cli.solvers.table1 import TableOne


def cgff(task: Task, trace: Trace, objective: str = "energy") -> End:
    """Run CGFF on the energy."""
    run, _ = run_of(task.structure, task.options.merged({"objective": objective}))
    X = _traced(trace, iterates(run, onward))
    return End(X, str(run.verdict))


def cgff_residual(task: Task, trace: Trace) -> End:
    """Run CGFF on eq. (10), half the squared residual."""
    return cgff(task, trace, "residual")


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
