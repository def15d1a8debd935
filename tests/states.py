"""States in the user's own units, and their arrays node by node: (n, d), all nodes."""

import numpy as np

from cgff_cli.mechanics.frame import UNSCALED
from cgff_cli.mechanics.state import Mechanics, State
from cgff_cli.structure import Structure


def mechanics_of(structure: Structure) -> Mechanics:
    return Mechanics(structure, UNSCALED)


def state_of(structure: Structure, X: np.ndarray | None = None) -> State:
    """Return the state at (n, d) positions, those of the start by default."""
    mechanics = mechanics_of(structure)
    return mechanics.at(mechanics.start if X is None else mechanics.moving(X))


def by_node(mechanics: Mechanics, values: np.ndarray) -> np.ndarray:
    """Return (n, d) for (d, m) values at the nodes that move, zeros elsewhere."""
    full = np.zeros(mechanics.structure.coordinates.shape)
    full[slice(None) if mechanics.moves is None else mechanics.moves] = values.T
    return full


def tangent(state: State, **options: object) -> np.ndarray:
    """Return K over the free directions, node by node."""
    mechanics = state.mechanics
    d, m = state.X.shape
    free = np.ones((d, m)) if mechanics.mask is None else mechanics.mask
    order = np.arange(d * m).reshape(d, m).T.reshape(-1)[free.T.reshape(-1) > 0.0]
    return state.dense_tangent(**options)[np.ix_(order, order)]
