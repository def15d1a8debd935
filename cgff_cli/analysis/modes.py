"""Along which motions a structure resists least."""

from typing import NamedTuple

import numpy as np

from cgff_cli.analysis.stability import Signs, resists
from cgff_cli.mechanics.signs import Spectrum
from cgff_cli.mechanics.state import State

NEARLY = 1.0 - 1e-6
"""Share of a shape's largest component from which another is as large, but for rounding."""


class Modes(NamedTuple):
    """The softest motions: stiffnesses (m,), force per length, rising; unit shapes (m, n, d), all nodes.

    is_found: whether the first is known to be the softest. Fewer are told than asked for where no more were
    found, or exist.
    """

    stiffnesses: np.ndarray
    shapes: np.ndarray
    is_found: bool


def softest_modes(state: State, floor: float, count: int, kind: str = "auto") -> Modes:
    """Return at most `count` eigenvectors of the tangent stiffness to its least eigenvalues.

    Rigid motions that cost nothing are left out. state: balanced or not; floor: the rounding error of
    forces; kind: sparse factors to use of a large scene, as the solve option `factor`.
    """
    return modes_of(spectrum_of(state, resists(state, floor), floor, kind, count), state, count)


def spectrum_of(state: State, taut: np.ndarray, floor: float, kind: str, count: int) -> Signs:
    """Return what tells signs and `count` motions of K: dense, or by sparse factors."""
    if state.mechanics.is_small:
        return Spectrum(state, taut, floor)
    from cgff_cli.analysis.large import LargeSpectrum

    return LargeSpectrum(state, taut, floor, kind, count)


def modes_of(signs: Signs, state: State, count: int) -> Modes:
    """Return the softest motions as a spectrum tells them, in the user's units."""
    values, shapes, is_found = signs.modes(count)
    return Modes(values * state.mechanics.frame.stiffness, by_nodes(state, shapes), is_found)


def by_nodes(state: State, shapes: np.ndarray) -> np.ndarray:
    """Return (m, n, d) motions of all nodes for (m, d, moving) ones; the largest component is positive."""
    n, moves = len(state.mechanics.structure.free), state.mechanics.moves
    full = np.zeros((len(shapes), n, shapes.shape[1]))
    full[:, slice(None) if moves is None else moves] = shapes.swapaxes(1, 2)
    for shape in full:
        flat = shape.reshape(-1)
        size = np.abs(flat)
        shape *= np.sign(flat[np.argmax(size >= NEARLY * size.max())]) or 1.0
    return full + 0.0  # no zero has a sign
