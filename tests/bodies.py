"""Small structures for unit tests, and their energy and forces by loops without the package's matrices."""

from collections.abc import Mapping, Sequence

import mpmath
import numpy as np

from cgff_cli.scene.scene import AXES, Group, Scene
from cgff_cli.structure import Structure, from_scene

Bar = tuple[int, int, str, float, float]
"""Begin row, end row, kind, EA, rest length."""


def scene(
    X: object,
    bars: Sequence[Bar],
    supports: Mapping[int, str] | None = None,
    loads: Mapping[int, Sequence[float]] | None = None,
    law: str = "paper",
) -> Scene:
    """Return a scene with one group per bar, named e0, e1, ...; nodes are n0, n1, ..."""
    X = np.array(X, dtype=float)
    groups = tuple(
        Group(f"e{row}", kind, np.array([[i, j]]), np.array([float(EA)]), np.array([float(rest)]))
        for row, (i, j, kind, EA, rest) in enumerate(bars)
    )
    names = tuple(f"n{row}" for row in range(len(X)))
    held = dict(sorted((supports or {}).items()))
    pulled = {row: tuple(map(float, load)) for row, load in (loads or {}).items()}
    return Scene("body", law, names, X, groups, held, pulled)


def body(*args: object, **kwargs: object) -> Structure:
    """Return the arrays of `scene(...)`."""
    return from_scene(scene(*args, **kwargs))


def random_body(
    seed: int,
    d: int = 3,
    *,
    nodes: int = 6,
    bars: int = 12,
    held: bool = True,
    loaded: bool = True,
    kinds: Sequence[str] = ("cable", "strut"),
    law: str = "paper",
) -> Structure:
    """Return a random structure; stretches are 4 % to 25 % of a length, of either sign.

    Held structures have one node fixed, and one direction of another; loads act on free nodes.
    """
    rng = np.random.default_rng(seed)
    X = rng.uniform(-1.0, 1.0, (nodes, d))
    every = [(i, j) for i in range(nodes) for j in range(i + 1, nodes)]
    chain = [(i, i + 1) for i in range(nodes - 1)]
    others = [pair for pair in every if pair not in chain]
    picked = chain + [others[i] for i in rng.choice(len(others), bars - len(chain), replace=False)]
    made = []
    for i, j in picked:
        stretch = rng.choice([-1.0, 1.0]) * rng.uniform(0.04, 0.25)
        rest = np.linalg.norm(X[i] - X[j]) * (1.0 + stretch)
        ends = (i, j) if rng.random() < 0.5 else (j, i)
        made.append((*ends, str(rng.choice(kinds)), rng.uniform(1.0, 10.0), rest))
    supports = {0: AXES[:d], 1: "y"} if held else {}
    loads = {row: rng.normal(size=d) for row in range(2, nodes)} if loaded else {}
    return body(X, made, supports, loads, law)


def energy_by_loop(structure: Structure, X: object, sqrt: object = mpmath.sqrt) -> object:
    """Return sum k e^2 / 2 - loads . X, element by element, in the arithmetic of X and sqrt."""
    total = 0 * X[0][0]
    for e in range(len(structure.start)):
        i, j = int(structure.start[e]), int(structure.end[e])
        l = sqrt(sum((X[i][a] - X[j][a]) ** 2 for a in range(len(X[i]))))
        stretch = l - float(structure.rest_lengths[e])
        if structure.tension_only[e] and stretch.real < 0:
            continue
        total += float(structure.stiffness[e]) * stretch**2 / 2
    for row, load in enumerate(structure.loads.tolist()):
        for axis, component in enumerate(load):
            total -= component * X[row][axis]
    return total


def forces_by_loop(structure: Structure, X: np.ndarray, sqrt: object = np.sqrt) -> np.ndarray:
    """Return (n, d) load plus pull of every element, supports' reactions included; X may be complex."""
    total = np.array(structure.loads, dtype=X.dtype)
    for e in range(len(structure.start)):
        i, j = int(structure.start[e]), int(structure.end[e])
        V = X[j] - X[i]
        l = sqrt((V * V).sum())
        stretch = l - structure.rest_lengths[e]
        if structure.tension_only[e] and stretch.real < 0:
            continue
        pull = structure.stiffness[e] * stretch * V / l
        total[i] += pull
        total[j] -= pull
    return total


def tangent_by_complex_steps(structure: Structure, X: np.ndarray) -> np.ndarray:
    """Return K over the free directions, exact to rounding: the imaginary part of a step i h over h."""
    dofs = np.flatnonzero(structure.free)
    columns = []
    for dof in dofs:
        step = np.zeros(X.size, dtype=complex)
        step[dof] = 1e-200j
        moved = forces_by_loop(structure, X + step.reshape(X.shape))
        columns.append(-moved.reshape(-1)[dofs].imag / 1e-200)
    return np.array(columns).T


def exact(X: np.ndarray) -> list[list[mpmath.mpf]]:
    """Return coordinates as mpmath numbers, without rounding."""
    return [[mpmath.mpf(float(x)) for x in row] for row in X]
