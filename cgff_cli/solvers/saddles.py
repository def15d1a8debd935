"""Starts that coincide, and balance that is no minimum: ways off points where no direction is better."""

import numpy as np

from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.solvers.descent import Detour
from cgff_cli.solvers.line_search import MOST_TRIALS, TENFOLD
from cgff_cli.solvers.objectives import Line
from cgff_cli.solvers.run import Run

COINCIDENT = 1e-9
"""A strut shorter than this share of the structure's size has no direction to push in (1e-8 did as well:
tests/studies/hard_suite.py)."""

NUDGE = 1e-4
"""Size of the seeded perturbation that gives it one, and of the first step away from a saddle (1e-5 to 1e-3
did as well: tests/studies/hard_suite.py)."""


def separated(mechanics: Mechanics, seed: int) -> tuple[State, str | None]:
    """Return a start state in which no strut has zero length, and a warning if any had.

    A strut with coincident ends pushes in no direction: its free nodes are moved by a tiny perturbation
    drawn from `seed`.
    """
    structure, start = mechanics.structure, mechanics.at(mechanics.start)
    if float(start.l.min()) >= COINCIDENT:
        return start, None
    short = (start.l < COINCIDENT) & ~structure.tension_only & (mechanics.l0 > 0.0)
    if not short.any():
        return start, None
    nodes = np.unique(np.concatenate((structure.start[short], structure.end[short])))
    moved = np.zeros_like(structure.coordinates)
    moved[nodes] = NUDGE * np.random.default_rng(seed).uniform(-1.0, 1.0, (len(nodes), len(start.X)))
    moved[~structure.free] = 0.0
    count = int(short.sum())
    shift = moved.T if mechanics.moves is None else moved.T[:, mechanics.moves]
    return mechanics.at(start.X + shift), (
        f"{count} strut{'s' if count > 1 else ''} of zero length at the start: "
        f"moved the nodes by a perturbation of {NUDGE:g} of the size, seed {seed}"
    )


def escape(run: Run) -> Detour:
    """Leave an unstable equilibrium along its most negative stiffness, in one step, if a run is at one."""
    yield from ()
    if not (run.verdict and run.verdict.converged and run.minimises_energy) or run.escapes >= MOST_TRIALS:
        return False
    d = run.preconditioner.steepest_fall(run.state)
    if d is None:
        return False
    alpha = _farthest_fall(run.objective.line(run.state, d))
    if alpha == 0.0:
        return False
    run.escapes += 1
    run.jump(run.state.X + alpha * d, alpha)
    return True


def _farthest_fall(line: Line) -> float:
    """Return the step along a direction of negative curvature, of either sign, that falls most; 0 if none.

    First steps go down to COINCIDENT: a stiff element beside an unstable equilibrium hides longer falls.
    """
    first, step = NUDGE, 0.0
    while step == 0.0 and first > COINCIDENT:
        step = _fall_from(line, first)
        first /= TENFOLD
    return step


def _fall_from(line: Line, first: float) -> float:
    """Return the step that falls most, doubling from `first` while the objective keeps falling."""
    best, best_change = 0.0, 0.0
    for sign in (1.0, -1.0):
        a, last = sign * first, 0.0
        while (trial := line(a)).change < last and abs(a) < 1.0 / NUDGE:
            if trial.change < best_change:
                best, best_change = a, trial.change
            last = trial.change
            a *= 2.0
    return best
