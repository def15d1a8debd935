"""Rest lengths that a shape is given with, where rounding hides whether others hold it."""

from dataclasses import replace
from typing import Any

import numpy as np

from cgff_cli.analysis.prestress import SIGNED, Answer
from cgff_cli.analysis.ranks import LEAST_TOLERANCE
from cgff_cli.as_given import unmoved
from cgff_cli.mechanics.norms import largest
from cgff_cli.options import DEFAULTS
from cgff_cli.refusals import UNSURE
from cgff_cli.scene.scene import Scene


def or_its_own(scene: Scene, asked: dict[str, Any], answer: Answer) -> Answer:
    """Return an answer, or where it is unsure the scene's own rest lengths, if no more is asked than a shape.

    They must hold it: forces balance as a solve would have it by default, and all have their signs.
    """
    is_plain = not any(asked[name] for name in ("by_group", "by_symmetry", "force"))
    if answer.why not in UNSURE or scene.is_geometry or not is_plain or asked["tolerance"] > LEAST_TOLERANCE:
        return answer
    found = unmoved(scene, DEFAULTS.tolerance)
    structure, t = found.mechanics.structure, found.forces
    signed = np.where(structure.tension_only, t, -t)
    if not found.verdict.converged or signed.min() <= SIGNED * largest(t):
        return answer
    return replace(
        answer,
        why="",
        forces=t,
        force_densities=found.force_densities,
        rest_lengths=structure.rest_lengths,
        coordinates=structure.coordinates,
        left_over=found.relative,
        is_given=True,
    )
