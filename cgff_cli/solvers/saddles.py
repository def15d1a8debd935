"""Starts that coincide, and balance that is no minimum: ways off points where no direction is better."""

import numpy as np

from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.solvers.objectives import Line
from cgff_cli.solvers.run import Run

COINCIDENT = 1e-9
"""A strut shorter than this share of the structure's size has no direction to push in."""

NUDGE = 1e-4
"""Size of the seeded perturbation that gives it one."""

MOST_ESCAPES = 20
"""Unstable equilibria left behind along their negative stiffness before one is reported as such."""


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


def escape(run: Run) -> bool:
    """Leave an unstable equilibrium along its most negative stiffness; False where a run is at none."""
    if not (run.verdict and run.verdict.converged and run.minimises_energy) or run.escapes >= MOST_ESCAPES:
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


FIRST_FALLS = (1e-3, 1e-4, 1e-5, 1e-6)
"""First steps to try away from an unstable equilibrium: a stiff element beside it hides longer falls."""

FARTHEST = 1e3
GROWTH = 4.0


def _farthest_fall(line: Line) -> float:
    """Return the step along a direction of negative curvature, of either sign, that falls most; 0 if none."""
    return next((step for first in FIRST_FALLS if (step := _fall_from(line, first)) != 0.0), 0.0)


def _fall_from(line: Line, first: float) -> float:
    """Return the step that falls most, growing fourfold from `first` while the objective keeps falling."""
    best, best_change = 0.0, 0.0
    for sign in (1.0, -1.0):
        a = sign * first
        last = 0.0
        while (trial := line(a)).change < last and abs(a) < FARTHEST:
            if trial.change < best_change:
                best, best_change = a, trial.change
            last = trial.change
            a *= GROWTH
    return best
