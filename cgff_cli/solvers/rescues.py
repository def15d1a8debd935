"""What a run does beside its steps: a better start, another preconditioner, a detour, a way off a saddle."""

from collections.abc import Callable
from dataclasses import replace

from cgff_cli.mechanics.norms import norm
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.solvers import tightening
from cgff_cli.solvers.curvature import farthest_fall
from cgff_cli.solvers.moves import Move
from cgff_cli.solvers.preconditioners import choose
from cgff_cli.solvers.run import Run
from cgff_cli.solvers.softening import LOOSE, MOST_DETOURS, STAGE_LIMIT, WAIT, softened
from cgff_cli.solvers.solution import History
from cgff_cli.solvers.tightening import fit, tightened

SLIGHT = 2e-3
"""Mean strain of a net below which nothing but the tangent makes quick headway."""

BAD_START = 20
"""Iterations without headway that a net is worth which begins with less, or with lengths that do not fit."""

MAX_ESCAPES = 20
"""Unstable equilibria left behind along their negative stiffness before one is reported as such."""


def begin(run: Run, loop: Callable[[Run], object]) -> None:
    """Move to a better start where there is one: a force density solution, then by way of tighter nets.

    Where that start is loose it is no guide: how far stiff cables sag, lengths decide and not forces.
    """
    start = run.preconditioner.better_start(run.state)
    if start is run.state:
        return
    last, structure = float("inf"), run.mechanics.structure
    now = fit(start.l, structure)
    if now.is_loose and relieve(run, BAD_START):
        return
    run.state = start
    options = replace(run.options, preconditioner="frames", tolerance=tightening.LOOSE)
    options = replace(options, max_iterations=tightening.STAGE_LIMIT)
    while now.can_tighten and now.wanted < 0.5 * last:
        last = now.wanted
        tighter = Mechanics(tightened(structure, now))
        stage = Run(tighter, run.state.X, run.frame, options, History(), run.preconditioner)
        loop(stage)
        run.evaluations += stage.evaluations
        run.preconditioner.stiffen()
        found = run.mechanics.at(stage.state.X)
        if found.energy >= run.state.energy:
            break
        run.state, now = found, fit(found.l, structure)
    run.g = run.objective.gradient(run.state)
    if now.is_mesh and (not now.is_good or now.strain < SLIGHT):
        relieve(run, BAD_START)


def relieve(run: Run, waited: int) -> bool:
    """Put the tangent in the place of a preconditioner that makes no headway, and return whether it was done.

    waited: iterations since the last headway. A preconditioner that was asked for by name stays.
    """
    old = run.preconditioner
    if run.options.preconditioner != "auto" or not old.is_beaten(waited):
        return False
    run.preconditioner = choose(run.mechanics, replace(run.options, preconditioner="tangent"))
    run.preconditioner.factorizations += old.factorizations
    run.watch.waited, run.last = 0, None
    return True


def escape(run: Run) -> Move | None:
    """Leave an unstable equilibrium along its most negative stiffness; None if it is a minimum."""
    if not run.is_energy() or run.escapes >= MAX_ESCAPES:
        return None
    d = run.preconditioner.steepest_fall(run.state)
    if d is None:
        return None
    alpha = farthest_fall(run.objective.line(run.state, d))
    if alpha == 0.0:
        return None
    run.escapes += 1
    (run.state, run.g), run.last = run.at(run.state.X + alpha * d), None
    return Move(abs(alpha), alpha, 0.0, True)


def detour(run: Run, loop: Callable[[Run], object]) -> Move | None:
    """Pass a narrow valley by way of softer structures; None where there is no need.

    The energy may rise: a stretch too small to see costs more than all the loads can do.
    """
    stuck = run.watch.waited >= WAIT and run.preconditioner.predicts_full_steps
    if not stuck or not run.is_energy() or run.detours >= MOST_DETOURS:
        return None
    run.detours += 1
    run.watch.waited = 0
    X = run.state.X
    options = replace(run.options, preconditioner="tangent", tolerance=LOOSE, max_iterations=STAGE_LIMIT)
    for softer in softened(run.mechanics.structure):
        stage = Run(Mechanics(softer), X, run.frame, options, History())
        stage.detours = MOST_DETOURS
        loop(stage)
        X = stage.state.X
        run.evaluations += stage.evaluations
        run.preconditioner.factorizations += stage.preconditioner.factorizations
    if X is run.state.X:
        return None
    step = norm(X - run.state.X)
    (run.state, run.g), run.last = run.at(X), None
    run.preconditioner.stiffen()
    return Move(step, 0.0, 0.0, True)
