"""The fields of an analysis, and one sentence for each that is null."""

from typing import Any

MOST = 3000
"""Free directions up to which ranks are computed without being asked for (tests/studies/analysis_cost.py)."""

OF_SHAPES = (
    "nullity_D",
    "nullity_U",
    "condition_D",
    "condition_U",
    "self_stress_states",
    "mechanisms",
    "rigid_motions",
    "rank_tolerance",
    "rank_gap",
)
OF_EQUILIBRIA = (
    "stable",
    "stability",
    "smallest_stiffness",
    "tangent_eigenvalues",
    "negative_eigenvalues",
    "super_stable",
    "prestress_stable",
)
OF_LOADS = ("critical_load_factor", "first_slack_factor", "first_slack_cables")
ASKED_FOR = (*OF_LOADS, "modes")
TOLD = (*OF_SHAPES, *OF_EQUILIBRIA, *ASKED_FOR)

OFF = "not computed: analysis is off (analysis: never)"
INTERRUPTED = "not computed: the analysis was interrupted"
NOT_BALANCED = "no equilibrium was reached, so stability is not told"
TOO_LARGE = f"not computed: more than {MOST} free directions; ask with --analysis always"
TOO_SOFT = "not told: too many motions are too soft to tell from mechanisms in a structure of this size"
BLURRED = "not told: forces out of balance blur the sign of the stiffness; a smaller tolerance may tell"
ALL_IDLE = "nothing can move but, at no cost, the whole"
LEFT_TO_ANALYSE = "not computed by a solve: cgff analyse tells it"
NO_GAP = "no singular value is left out, or none is kept, so that there is no gap between the two"
RANK_UNSURE = "not told: singular values stand so near the rank tolerance that it alone would decide"


def reasons(found: dict[str, Any], converged: bool, has_ranks: bool) -> dict[str, str]:
    """Return why fields of a solve's analysis are null; found: what is not."""
    reason = dict.fromkeys(TOLD, LEFT_TO_ANALYSE)
    if not has_ranks:
        reason |= dict.fromkeys((*OF_SHAPES, "super_stable"), TOO_LARGE)
    else:
        unsure = RANK_UNSURE if found["rank_unsure"] else TOO_SOFT
        reason |= dict.fromkeys((*OF_SHAPES, "super_stable"), unsure) | {"rank_gap": NO_GAP}
    if not converged:
        reason |= dict.fromkeys(OF_EQUILIBRIA, NOT_BALANCED)
    elif found["stable"] is None:
        reason |= dict.fromkeys(OF_EQUILIBRIA, BLURRED)
    else:
        softest = ALL_IDLE if has_ranks else TOO_LARGE
        reason |= {"smallest_stiffness": softest, "tangent_eigenvalues": softest}
    return {name: why for name, why in reason.items() if found.get(name) is None}
