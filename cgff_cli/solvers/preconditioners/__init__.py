"""M^-1 in z = M^-1 g, chosen from the scene: its size, its supports, its elements; never from a clock."""

import numpy as np

from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.preconditioners.base import Identity, Preconditioner
from cgff_cli.solvers.preconditioners.dense import DenseTangent


def choose(mechanics: Mechanics, options: SolveOptions) -> Preconditioner:
    """Return the preconditioner that the scene and the options ask for.

    auto: the dense tangent for small scenes, node frames for large anchored cable nets, else the sparse
    tangent, which also takes over where frames make no headway.
    """
    squared = options.objective == "residual"
    small = mechanics.connectivity.is_small
    wants_frames = options.preconditioner == "frames" or (options.preconditioner == "auto" and not small)
    if options.preconditioner == "none" or not len(mechanics.dofs):
        return Identity()
    if wants_frames and not squared and _is_anchored_net(mechanics):
        from cgff_cli.solvers.preconditioners.frames import NodeFrames

        return NodeFrames(mechanics, options.factor)
    if small:
        return DenseTangent(mechanics, squared)
    from cgff_cli.solvers.preconditioners.sparse import SparseTangent

    return SparseTangent(mechanics, squared, options.factor)


def _is_anchored_net(mechanics: Mechanics) -> bool:
    """Return whether all elements are cables, nodes held or free, and every part held somewhere."""
    structure = mechanics.structure
    pinned = np.logical_not(structure.free.any(axis=1))
    if not structure.tension_only.all() or np.any(pinned == structure.free.all(axis=1)):
        return False
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    n = len(pinned)
    joined = coo_array((np.ones(len(structure.start)), (structure.start, structure.end)), shape=(n, n))
    parts, label = connected_components(joined, directed=False)
    return bool(np.bincount(label[pinned], minlength=parts).all())
