"""CGFF itself, on the energy or on eq. (10), and the paper's Table I: the same solvers as `solve` has."""

from cgff_cli.rivals.task import End, Task
from cgff_cli.solvers import cgff
from cgff_cli.solvers import table1 as paper
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Verdict


def energy(task: Task) -> End:
    """Run CGFF on the energy."""
    options = task.options.merged({"objective": "energy"})
    return _ended(cgff.form_find(task.structure, options, watcher=task.trace.add))


def residual(task: Task) -> End:
    """Run CGFF on eq. (10), half the squared residual."""
    options = task.options.merged({"objective": "residual"})
    return _ended(cgff.form_find(task.structure, options, watcher=task.trace.add))


def table1(task: Task) -> End:
    """Run the paper's Table I to the letter."""
    return _ended(paper.form_find(task.structure, task.options, watcher=task.trace.add))


def _ended(solution: Solution) -> End:
    if solution.verdict is Verdict.INTERRUPTED:
        raise KeyboardInterrupt
    return End(solution.state.X, solution.verdict.value, solution.message)
