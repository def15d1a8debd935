"""CGFF: from a structure's start to the shape where its forces balance, by the energy or by eq. (10).

Where this departs from the paper's Table I: objective, preconditioner, line search, stopping test, restarts.
`iterates` (solvers.descent) yields every X_k; what watches, times, records or continues a run consumes them.
"""

import numpy as np

from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.descent import iterates
from cgff_cli.solvers.rescues import onward
from cgff_cli.solvers.run import Run
from cgff_cli.solvers.saddles import separated
from cgff_cli.solvers.solution import History, Observer, Solution
from cgff_cli.solvers.stopping import Verdict
from cgff_cli.structure import Structure


def form_find(structure: Structure, options: SolveOptions, observer: Observer | None = None) -> Solution:
    """Return the equilibrium found from the structure's start shape, or the best that was reached."""
    run, warning = run_of(structure, options)
    history = History(run.mechanics, run.objective, observer)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        try:
            for iterate in iterates(run, onward):
                history.add(iterate)
        except KeyboardInterrupt:
            run.verdict = Verdict.INTERRUPTED
    if not len(history):  # interrupted on the way to a better start
        history.add(run.iterate())
    return Solution(
        run.state,
        run.verdict or Verdict.INTERRUPTED,
        options.tolerance,
        run.evaluations,
        run.preconditioner.factorizations,
        history,
        () if warning is None else (warning,),
    )


def run_of(structure: Structure, options: SolveOptions) -> tuple[Run, str | None]:
    """Return a run at the structure's start, and a warning where that had to be moved."""
    mechanics = Mechanics(structure)
    start, warning = separated(mechanics, options.seed)
    return Run(mechanics, options, start), warning
