"""The numbers that make one topology many structures."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np

from cgff_cli.structure import Structure


class Values(NamedTuple):
    """Numbers of m rows: coordinates and loads (m, n, d), stiffness and rest_lengths (m, b)."""

    coordinates: np.ndarray
    stiffness: np.ndarray
    rest_lengths: np.ndarray
    loads: np.ndarray

    def take(self, rows: np.ndarray) -> "Values":
        """Return the numbers of some rows."""
        return Values(*(np.ascontiguousarray(column[rows]) for column in self))

    def structure(self, one: Structure, row: int) -> Structure:
        """Return a structure with the numbers of a row."""
        return replace(one, **{name: column[row] for name, column in self._asdict().items()})
