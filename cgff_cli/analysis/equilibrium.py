"""What kind of equilibrium a solution is."""

from typing import Any

import numpy as np

from cgff_cli.analysis.ranks import force_density_threshold, rank_conditions, rank_tolerance
from cgff_cli.analysis.stability import is_super_stable, stability
from cgff_cli.options import SolveOptions
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import VANISHED

SMALL = 300
"""Free directions up to which ranks and eigenvalues are computed without being asked for."""

MOST_NAMED = 100
"""Elements listed by name before only their number is given."""

NOT_COMPUTED = dict.fromkeys(
    (
        "nullity_D",
        "nullity_U",
        "condition_D",
        "condition_U",
        "self_stress_states",
        "mechanisms",
        "rigid_motions",
        "rank_tolerance",
        "stable",
        "stability",
        "smallest_stiffness",
        "super_stable",
    )
)


def analysed(scene: Scene, solution: Solution, options: SolveOptions) -> dict[str, Any]:
    """Return the `analysis` object of a result; null is what was not computed.

    Stability is a statement about an equilibrium: without one it is null.
    """
    state, mechanics, floor = solution.state, solution.mechanics, solution.balance.floor
    found: dict[str, Any] = dict(NOT_COMPUTED)
    prestressed = bool(np.abs(state.t).max() > VANISHED * floor)
    is_full = _is_full(solution, options)
    if is_full:
        # A shape that is no equilibrium stands for itself; one that is, for the exact one near by.
        tolerance = rank_tolerance(solution.relative if solution.verdict.converged else 0.0)
        found |= rank_conditions(state, tolerance)
    found |= stability_of(solution, options)
    if is_full and solution.verdict.converged:
        found["super_stable"] = (
            prestressed
            and found["stable"] is True
            and is_super_stable(state, force_density_threshold(state, tolerance))
        )
    slack = np.flatnonzero(state.slack)
    pulled = np.flatnonzero(~mechanics.structure.tension_only & (state.t > VANISHED * floor))
    return found | {
        "prestressed": prestressed,
        "slack_count": len(slack),
        "slack_cables": labels(scene, slack[:MOST_NAMED]),
        "struts_in_tension_count": len(pulled),
        "struts_in_tension": labels(scene, pulled[:MOST_NAMED]),
    }


def _is_full(solution: Solution, options: SolveOptions) -> bool:
    """Return whether ranks and eigenvalues are computed."""
    small = solution.mechanics.is_small and len(solution.mechanics.dofs) <= SMALL
    return options.analysis == "always" or (options.analysis == "auto" and small)


def stability_of(solution: Solution, options: SolveOptions) -> dict[str, Any]:
    """Return what is told of a solution's stability; nothing where it is not asked for, or no equilibrium."""
    if not solution.verdict.converged or options.analysis == "never":
        return {}
    if _is_full(solution, options):
        return stability(solution.state, solution.balance.floor)
    from cgff_cli.analysis.large import stability_of_large

    return stability_of_large(solution.state, options.factor, solution.balance.floor)


STABILITY_WORDS = {
    "unstable": "unstable: the forces balance, but the least disturbance makes the structure leave this "
    "shape; solve with objective energy to see where it goes",
    "neutral": "neutral: as far as double precision can tell, there is a motion that nothing resists, so "
    "that this shape is one of many; prestress, members or supports would fix it",
}


def stability_warnings(analysis: dict[str, Any]) -> tuple[str, ...]:
    """Return what a person is told of an equilibrium that is not stable."""
    return tuple(words for kind, words in STABILITY_WORDS.items() if analysis.get("stability") == kind)


def labels(scene: Scene, rows: np.ndarray) -> list[str]:
    """Return `group: begin-end` for element rows, in the scene's element order."""
    if not len(rows):
        return []
    firsts = np.cumsum([0, *(len(group.EA) for group in scene.groups)])
    named = []
    for row in rows.tolist():
        index = int(np.searchsorted(firsts, row, side="right")) - 1
        begin, end = scene.groups[index].pairs[row - firsts[index]]
        names = scene.node_names
        named.append(f"{scene.groups[index].name}: {names[begin]}-{names[end]}")
    return named
