"""Monte Carlo form-finding: random nodal moves under falling temperature (the kind of Li and others 2010).

    s ~ N(0, size^2) along a node's free axes,    taken where    rise of the energy <= T x,   x ~ Exp(1)

x is -log of a uniform number: this is the test exp(-rise / T) >= u of annealing (Kirkpatrick, Gelatt and
Vecchi 1983). Nodes that share no element move at once, which is as if in turn. A rise is summed from
differences of lengths, l' - l = s . (2 V + s) / (l' + l), which do not cancel near the answer.

Of Li, Feng, Cao and Gao's paper abstract and introduction are public: a stochastic procedure, from any start
and without matrices. The test, the first temperature (T in each free coordinate is the start's elastic
energy), how it falls, and each node's own size by the one-fifth rule (Rechenberg 1973) are ours.
"""

from typing import NamedTuple

import numpy as np

from cgff_cli.mechanics import elements
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.rivals.task import End, Task, Trace, Unknowns

COOLING = 0.99
"""Temperature after a sweep over the one before."""

FIRST_SIZE = 0.1
"""First size of the moves, in units of the frame."""

LONGER, SHORTER = 1.5, 1.5**-0.25
"""What a move that is taken, and one that is not, do to its node's size: even where one in five is taken."""

MEASURED = 10
"""Sweeps from one look at the residual to the next: a look takes as long as a sweep."""


class _Batch(NamedTuple):
    """Nodes that share no element, (c,) rows, and their elements: each has one of them as its near end.

    near : (m,) place of the near end in the batch        far          : (m,) nodes
    free : (d, c) 1 where a node is free, or 0            k, l0, least : (m,) as in Mechanics
    """

    nodes: np.ndarray
    free: np.ndarray
    near: np.ndarray
    far: np.ndarray
    k: np.ndarray
    l0: np.ndarray
    least: np.ndarray


def monte_carlo(task: Task, trace: Trace) -> End:
    """Move nodes at random, ever colder; the trace ends the run. A sweep is one iteration and evaluation."""
    unknowns = Unknowns(task, trace)
    mechanics = unknowns.mechanics
    rng = np.random.default_rng(task.options.seed)
    state = mechanics.at(mechanics.start)
    T = float(elements.energy(state.t, state.e)) / len(mechanics.dofs)
    X = mechanics.all.copy()
    loads = (task.structure.loads * (1.0 / mechanics.frame.force)).T
    sizes = np.full(X.shape[1], FIRST_SIZE)
    batches = _batches(mechanics)
    sweeps = 0
    while True:
        if sweeps % MEASURED == 0:
            trace.add(sweeps, sweeps, X.T * mechanics.frame.length)
        moves, heat = sizes * rng.standard_normal(X.shape), T * rng.standard_exponential(X.shape[1])
        for batch in batches:
            nodes = batch.nodes
            s = moves[:, nodes] * batch.free
            taken = _rises(batch, X, s) - (loads[:, nodes] * s).sum(axis=0) <= heat[nodes]
            X[:, nodes] += s * taken
            sizes[nodes] *= np.where(taken, LONGER, SHORTER)
        sweeps, T = sweeps + 1, COOLING * T


def _batches(mechanics: Mechanics) -> list[_Batch]:
    """Return the nodes that can move, every one in the first batch that has no neighbour of it."""
    structure = mechanics.structure
    ends = np.concatenate((structure.start, structure.end))
    others = np.concatenate((structure.end, structure.start))
    order = np.argsort(ends, kind="stable")
    n = len(structure.free)
    neighbours = np.split(others[order], np.cumsum(np.bincount(ends, minlength=n))[:-1])
    colour = np.full(n, -1)
    for node in np.flatnonzero(structure.free.any(axis=1)):
        met = set(colour[neighbours[node]].tolist())
        colour[node] = next(c for c in range(n) if c not in met)
    return [_batch(mechanics, np.flatnonzero(colour == c)) for c in range(int(colour.max()) + 1)]


def _batch(mechanics: Mechanics, nodes: np.ndarray) -> _Batch:
    start, end = mechanics.structure.start, mechanics.structure.end
    from_start, from_end = (np.flatnonzero(np.isin(side, nodes)) for side in (start, end))
    near = np.searchsorted(nodes, np.concatenate((start[from_start], end[from_end])))
    far = np.concatenate((end[from_start], start[from_end]))
    rows = np.concatenate((from_start, from_end))
    free = mechanics.structure.free[nodes].T.astype(float)
    return _Batch(nodes, free, near, far, mechanics.k[rows], mechanics.l0[rows], mechanics.least[rows])


def _rises(batch: _Batch, X: np.ndarray, s: np.ndarray) -> np.ndarray:
    """Return (c,) by how much each of the moves s (d, c) raises the elastic energy at X (d, n)."""
    S = s[:, batch.near]
    V = X[:, batch.nodes[batch.near]] - X[:, batch.far]
    old, new = elements.lengths(V), elements.lengths(V + S)
    e = elements.extensions(old - batch.l0, batch.least)
    moved = elements.extensions(new - batch.l0, batch.least)
    longer = (S * (2.0 * V + S)).sum(axis=0) / (new + old)
    taut = elements.taut(np.minimum(old, new) - batch.l0, batch.least)
    work = 0.5 * np.where(taut, longer, moved - e) * elements.forces(batch.k, e + moved)
    return np.bincount(batch.near, work, len(batch.nodes))
