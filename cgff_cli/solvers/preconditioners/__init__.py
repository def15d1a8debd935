"""M^-1 in z = M^-1 g, chosen from the scene: its size, its supports, its elements; never from a clock."""

from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.preconditioners.base import Preconditioner, Tangent
from cgff_cli.solvers.preconditioners.dense import DenseTangent


def choose(mechanics: Mechanics, options: SolveOptions) -> Preconditioner:
    """Return the preconditioner that the scene and the options ask for.

    auto: the dense tangent for small scenes, node frames for large anchored cable nets, else the sparse
    tangent, which also takes over where frames make no headway.
    """
    squared = options.objective == "residual"
    if options.preconditioner == "none" or not mechanics.start.size:
        return Preconditioner()
    wants_frames = options.preconditioner == "frames" or (
        options.preconditioner == "auto" and not mechanics.is_small
    )
    if wants_frames and not squared and _is_anchored_net(mechanics):
        from cgff_cli.solvers.preconditioners.frames import NodeFrames

        return NodeFrames(mechanics, options.factor)
    return tangent(mechanics, squared, options.factor)


def tangent(mechanics: Mechanics, squared: bool, factor: str) -> Tangent:
    """Return the shifted tangent, dense if the scene is small."""
    if mechanics.is_small:
        return DenseTangent(mechanics, squared)
    from cgff_cli.solvers.preconditioners.sparse import SparseTangent

    return SparseTangent(mechanics, squared, factor)


def _is_anchored_net(mechanics: Mechanics) -> bool:
    """Return whether all elements are cables, nodes held or free, and every part held somewhere."""
    structure = mechanics.structure
    if mechanics.moves is None or mechanics.mask is not None or not structure.tension_only.all():
        return False
    return structure.is_tied()
