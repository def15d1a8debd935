"""Members that connectivity and signs alone cannot tell apart, which so share one force density."""

import numpy as np


def member_classes(start: np.ndarray, end: np.ndarray, signs: np.ndarray, node_count: int) -> np.ndarray:
    """Return (b,) int, a class per member, by colour refinement of node pairs.

    A pair of nodes is coloured by its member's sign; then again by the colours of the two pairs over every
    third node, until no colour splits (Weisfeiler and Leman's refinement). Members that a symmetry of the
    signed graph exchanges keep one colour. O(n^3) a round; the graph is not directed.
    """
    colours = np.zeros((node_count, node_count), dtype=np.int64)
    colours[start, end] = colours[end, start] = np.where(signs > 0.0, 2, 3)
    np.fill_diagonal(colours, 1)
    count = len(np.unique(colours))
    while True:
        colours = _refined(colours)
        found = int(colours.max()) + 1
        if found == count:
            kinds = np.stack((colours[start, end], signs > 0.0))  # a cable and a strut may lie side by side
            return np.unique(kinds, axis=1, return_inverse=True)[1].reshape(-1)
        count = found


def _refined(colours: np.ndarray) -> np.ndarray:
    """Return the colours after one round, numbered from 0."""
    n = len(colours)
    base = int(colours.max()) + 1
    table = np.empty((n * n, n + 1), dtype=np.int64)
    for row in range(n):
        over = colours[row][:, None] * base + colours  # (k, j): the colours of row-k and k-j
        table[row * n : (row + 1) * n, 1:] = np.sort(np.minimum(over, _turned(colours, row, base)), axis=0).T
    table[:, 0] = colours.reshape(-1)
    return np.unique(table, axis=0, return_inverse=True)[1].reshape(n, n)


def _turned(colours: np.ndarray, row: int, base: int) -> np.ndarray:
    """Return the same pairs as seen from the other end, so that a pair and its reverse look alike."""
    return colours * base + colours[row][:, None]
