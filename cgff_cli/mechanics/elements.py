"""One element at a time: lengths, forces, force densities, energy. Every function takes whole columns.

Arrays run axis by axis: element vectors are (d, ..., b), all that is one number an element (..., b). What
stands in the middle are the items of a batch, if there are any.

With k = EA (law `paper`, eq. 2) or k = EA / l0 (law `hooke`) both laws read t = k e, where the extension e
is l - l0. A cable shorter than its rest length is slack: its extension never counts below `least` = 0; a
strut has `least` = -inf. Another elastic law would change `extensions`, `forces` and `taut` only.
"""

import numpy as np

EPS = float(np.finfo(float).eps)

TINY = 1e-100
"""The length of an element of none: finite where something is divided by it, and without effect."""

_TINY_SQUARED = TINY * TINY


def least_extensions(tension_only: np.ndarray) -> np.ndarray:
    """Return the (b,) extensions below which an element goes slack: 0 for cables, -inf for struts."""
    return np.where(tension_only, 0.0, -np.inf)


def lengths(V: np.ndarray) -> np.ndarray:
    """Return the (..., b) lengths of (d, ..., b) element vectors, eq. (7); TINY where there is none."""
    return np.sqrt(np.add.reduce(V * V, initial=_TINY_SQUARED))


def extensions(stretch: np.ndarray, least: np.ndarray) -> np.ndarray:
    """Return the elastic extensions e: the stretch l - l0, but no less than `least`."""
    return np.maximum(stretch, least)


def forces(stiffness: np.ndarray, e: np.ndarray) -> np.ndarray:
    """Return the element forces t = k e, eq. (2); tension > 0, slack 0."""
    return stiffness * e


def taut(stretch: np.ndarray, least: np.ndarray) -> np.ndarray:
    """Return bool: not slack; a cable at exactly its rest length is taken as taut."""
    return stretch >= least


def force_densities(t: np.ndarray, l: np.ndarray) -> np.ndarray:
    """Return the force densities q = t / l."""
    return t / l


def energy(t: np.ndarray, e: np.ndarray) -> np.ndarray:
    """Return the elastic energy, the sum of k e^2 / 2 over the last axis."""
    return np.add.reduce(t * e, -1) * 0.5
