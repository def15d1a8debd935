"""What kind of equilibrium a solution is."""

from typing import Any

import numpy as np

from cgff_cli.analysis.ranks import Ranks, rank_tolerance
from cgff_cli.analysis.reasons import MOST, OFF, TOLD, reasons
from cgff_cli.analysis.stability import SignsOf, stability
from cgff_cli.mechanics.norms import largest
from cgff_cli.mechanics.signs import Spectrum
from cgff_cli.mechanics.state import State
from cgff_cli.options import SolveOptions
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import VANISHED

MOST_NAMED = 100
"""Elements listed by name before only their number is given."""


def analysed(
    scene: Scene, solution: Solution, options: SolveOptions, signs: SignsOf | None = None
) -> dict[str, Any]:
    """Return the `analysis` object of a result; null is what was not computed, for a reason it tells.

    Stability is a statement about an equilibrium: without one it is null. signs: see `stability`.
    """
    if options.analysis == "never":
        return unanalysed(scene, solution, OFF)
    state, floor, converged = solution.state, solution.balance.floor, solution.verdict.converged
    most = float("inf") if options.analysis == "always" else MOST
    # A shape that is no equilibrium stands for itself; one that is, for the exact one near by.
    tolerance = rank_tolerance(solution.relative if converged else 0.0)
    found: dict[str, Any] = {"prestressed": carries(state, floor)}
    ranks = None
    if len(state.mechanics.dofs) <= most:
        ranks = Ranks(state, tolerance)
        found |= ranks.conditions()
    if converged:
        found |= stability_of(solution, options, most, signs)
        # What resists every motion resists mechanisms, which stress alone can.
        found["prestress_stable"] = found["stable"] or found.get("mechanisms") == 0 or None
    if converged and found["stable"] is not None and ranks is not None:
        found["super_stable"] = found["stable"] and found["prestressed"] and ranks.is_super_stable()
    return _told(scene, solution, found, reasons(found, converged, ranks is not None))


def stability_of(
    solution: Solution, options: SolveOptions, most: float = MOST, signs: SignsOf | None = None
) -> dict[str, Any]:
    """Return what `stability` tells of an equilibrium; most: free directions, see MOST."""
    state, floor = solution.state, solution.balance.floor
    if state.mechanics.is_small:
        return stability(state, floor, signs or Spectrum)
    from cgff_cli.analysis.large import stability_of_large

    return stability_of_large(state, options.factor, floor, most, signs)


def unanalysed(scene: Scene, solution: Solution, why: str) -> dict[str, Any]:
    """Return the `analysis` object without ranks and stability, and why they are null."""
    found = {"prestressed": carries(solution.state, solution.balance.floor)}
    return _told(scene, solution, found, dict.fromkeys(TOLD, why))


def carries(state: State, floor: float) -> bool:
    """Return whether any element carries more force than rounding."""
    return largest(state.t) > VANISHED * floor


def _told(scene: Scene, solution: Solution, found: dict[str, Any], reason: dict[str, str]) -> dict[str, Any]:
    """Return the `analysis` object: what was found, and elements by name."""
    state, floor = solution.state, solution.balance.floor
    slack = np.flatnonzero(state.slack)
    pulled = np.flatnonzero((state.t > VANISHED * floor) & ~state.mechanics.structure.tension_only)
    return {
        **{name: found.get(name) for name in TOLD},
        "parts": solution.mechanics.structure.part_count,
        "prestressed": found["prestressed"],
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
