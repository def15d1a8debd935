"""Where a run goes on from when it is stuck, or has ended at a saddle."""

from cgff_cli.solvers.continuation import mixed, softened
from cgff_cli.solvers.descent import Detour
from cgff_cli.solvers.preconditioners import tangent
from cgff_cli.solvers.preconditioners.base import Tangent
from cgff_cli.solvers.run import Run
from cgff_cli.solvers.saddles import escape
from cgff_cli.solvers.stopping import PATIENCE


def onward(run: Run) -> Detour:
    """Go on from elsewhere; returns False where there is no such place."""
    return (yield from (_detour if run.verdict is None else escape)(run))


def _detour(run: Run) -> Detour:
    """Pass a narrow valley: with forces as unknowns of their own, or by way of softer structures.

    Frames that make no headway give way to the tangent. The energy may rise: a stretch too small to see
    costs more than all the loads can do.
    """
    run.watch.waited = 0
    if not run.minimises_energy or run.detours >= PATIENCE or not run.preconditioner.has_detours:
        return False
    run.detours += 1
    M = run.preconditioner
    if not isinstance(M, Tangent):
        M = tangent(run.mechanics, False, run.options.factor)
        M.factorizations += run.preconditioner.factorizations
        run.preconditioner = M
    is_elsewhere = (yield from mixed(run, M)) or (yield from softened(run))
    if is_elsewhere:
        M.settle()
    return is_elsewhere
