"""What the paper prints: the coordinates of Tables II to IV, and which nodes its structures join."""

from typing import NamedTuple

import numpy as np

HALF_A_DIGIT = 0.5e-4
"""Half a unit of the fourth decimal, the last one printed."""


class Table(NamedTuple):
    """One table: (n, d) points of its two columns, and node pairs in the order of the shipped scene."""

    cgff: np.ndarray
    fdm: np.ndarray
    cables: list[tuple[int, int]]
    struts: list[tuple[int, int]]

    @property
    def pairs(self) -> list[tuple[int, int]]:
        return self.cables + self.struts


TABLE_2 = Table(
    cgff=np.array([[0.5345, -0.2941, -0.0842, 0.7737], [0.5355, 0.8044, 0.1856, -0.0635]]).T,
    fdm=np.array([[0.5366, -0.2974, -0.0821, 0.7716], [0.5499, 0.8094, 0.1959, -0.0636]]).T,
    cables=[(0, 1), (1, 2), (2, 3), (3, 0)],
    struts=[(0, 2), (1, 3)],
)

TABLE_3 = Table(
    cgff=np.array(
        [
            [-0.4916, -0.610, -0.1886, 0.3527, 0.4719, 0.0497],
            [-0.0270, 0.3463, 0.6659, 0.6111, 0.2378, -0.0812],
        ]
    ).T,
    fdm=np.array(
        [
            [-0.5189, -0.6673, -0.1955, 0.381, 0.5281, 0.0622],
            [-0.0705, 0.3670, 0.7086, 0.6582, 0.2046, -0.1288],
        ]
    ).T,
    cables=[(i, (i + 1) % 6) for i in range(6)],
    struts=[(0, 3), (1, 4), (2, 5)],
)

TRIANGLES = [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3)]
VERTICALS = [(0, 5), (1, 3), (2, 4)]

TABLE_4 = Table(
    cgff=np.array(
        [
            [1.7321, -0.866, -0.866, -1.5, 0.0, 1.5],
            [0.0, 1.5, -1.5, 0.866, -1.7321, 0.866],
            [0.0, 0.0, 0.0, 6.1485, 6.1485, 6.1485],
        ]
    ).T,
    fdm=np.array(
        [
            [1.6327, -0.855, -0.789, -1.399, -0.031, 1.437],
            [0.038, 1.3994, -1.437, 0.8558, -1.6358, 0.789],
            [0.095, 0.095, 0.095, 6.0548, 6.0548, 6.0548],
        ]
    ).T,
    cables=TRIANGLES + VERTICALS,
    struts=[(0, 3), (1, 4), (2, 5)],
)

TABLES = {"x-module": TABLE_2, "hexagon": TABLE_3, "prism": TABLE_4}
"""Name of the shipped scene -> its table."""
