"""What kind of equilibrium a solution is."""

from typing import Any

import numpy as np

from cgff_cli.analysis.ranks import Ranks, rank_tolerance
from cgff_cli.analysis.stability import stability
from cgff_cli.mechanics.norms import largest
from cgff_cli.mechanics.state import State
from cgff_cli.options import SolveOptions
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import VANISHED

MOST = 3000
"""Free directions up to which ranks are computed without being asked for (tests/studies/analysis_cost.py)."""

MOST_NAMED = 100
"""Elements listed by name before only their number is given."""

OF_SHAPES = (
    "nullity_D",
    "nullity_U",
    "condition_D",
    "condition_U",
    "self_stress_states",
    "mechanisms",
    "rigid_motions",
    "rank_tolerance",
)
OF_EQUILIBRIA = ("stable", "stability", "smallest_stiffness", "super_stable")

OFF = "not computed: analysis is off (analysis: never)"
INTERRUPTED = "not computed: the analysis was interrupted"
NOT_BALANCED = "no equilibrium was reached, so stability is not told"
TOO_LARGE = "not computed: more than {} free directions; ask with --analysis always"
TOO_SOFT = "not told: too many motions are too soft to tell from mechanisms in a structure of this size"
BLURRED = "not told: forces out of balance blur the sign of the stiffness; a smaller tolerance may tell"
ALL_IDLE = "nothing can move but, at no cost, the whole"


def analysed(scene: Scene, solution: Solution, options: SolveOptions) -> dict[str, Any]:
    """Return the `analysis` object of a result; null is what was not computed, for a reason it tells.

    Stability is a statement about an equilibrium: without one it is null.
    """
    if options.analysis == "never":
        return unanalysed(scene, solution, OFF)
    state, floor, converged = solution.state, solution.balance.floor, solution.verdict.converged
    most = float("inf") if options.analysis == "always" else MOST
    # A shape that is no equilibrium stands for itself; one that is, for the exact one near by.
    tolerance = rank_tolerance(solution.relative if converged else 0.0)
    found: dict[str, Any] = {}
    ranks = None
    if len(state.mechanics.dofs) <= most:
        ranks = Ranks(state, tolerance)
        found |= ranks.conditions()
    if converged:
        found |= stability_of(solution, options, most)
    if converged and found["stable"] is not None and ranks is not None:
        found["super_stable"] = found["stable"] and _carries(state, floor) and ranks.is_super_stable()
    null = [name for name in (*OF_SHAPES, *OF_EQUILIBRIA) if found.get(name) is None]
    return _told(scene, solution, found, _reasons(null, found, converged, ranks is not None) if null else {})


def stability_of(solution: Solution, options: SolveOptions, most: float = MOST) -> dict[str, Any]:
    """Return stability, stable, smallest_stiffness of an equilibrium; most: free directions, see MOST."""
    state, floor = solution.state, solution.balance.floor
    if state.mechanics.is_small:
        return stability(state, floor)
    from cgff_cli.analysis.large import stability_of_large

    return stability_of_large(state, options.factor, floor, most)


def unanalysed(scene: Scene, solution: Solution, why: str) -> dict[str, Any]:
    """Return the `analysis` object without ranks and stability, and why they are null."""
    return _told(scene, solution, {}, dict.fromkeys((*OF_SHAPES, *OF_EQUILIBRIA), why))


def _reasons(null: list[str], found: dict[str, Any], converged: bool, has_ranks: bool) -> dict[str, str]:
    """Return why fields are null."""
    left_out = TOO_LARGE.format(MOST)
    reason = dict.fromkeys((*OF_SHAPES, "super_stable"), TOO_SOFT if has_ranks else left_out)
    if not converged:
        reason |= dict.fromkeys(OF_EQUILIBRIA, NOT_BALANCED)
    elif found["stable"] is None:
        reason |= dict.fromkeys(OF_EQUILIBRIA, BLURRED)
    else:
        reason["smallest_stiffness"] = ALL_IDLE if has_ranks else left_out
    return {name: reason[name] for name in null}


def _carries(state: State, floor: float) -> bool:
    """Return whether any element carries more force than rounding."""
    return largest(state.t) > VANISHED * floor


def _told(scene: Scene, solution: Solution, found: dict[str, Any], reason: dict[str, str]) -> dict[str, Any]:
    """Return the `analysis` object: what was found, and elements by name."""
    state, floor = solution.state, solution.balance.floor
    slack = np.flatnonzero(state.slack)
    pulled = np.flatnonzero((state.t > VANISHED * floor) & ~state.mechanics.structure.tension_only)
    return {
        **{name: found.get(name) for name in (*OF_SHAPES, *OF_EQUILIBRIA)},
        "prestressed": _carries(state, floor),
        "slack_count": len(slack),
        "slack_cables": labels(scene, slack[:MOST_NAMED]),
        "struts_in_tension_count": len(pulled),
        "struts_in_tension": labels(scene, pulled[:MOST_NAMED]),
        "reason": reason,
    }


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
