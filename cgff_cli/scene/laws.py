"""The two elastic laws, the other way round: which rest length gives a force at a length."""

import numpy as np


def rest_lengths_for(law: str, l: np.ndarray, t: np.ndarray, EA: np.ndarray) -> np.ndarray:
    """Return (b,) l0 at which lengths l give forces t; NaN where none does, or none above 0.

    l0 = l - t / EA (paper, eq. (2)) or EA l / (EA + t) (hooke).
    """
    l0 = l - t / EA if law == "paper" else EA * l / np.where(EA + t > 0.0, EA + t, np.nan)
    return np.where(l0 > 0.0, l0, np.nan)


def limit_of(law: str, l: float, EA: float) -> str:
    """Return in words which forces have a rest length above 0 at a length."""
    return f"less than EA l = {EA * l:.6g}" if law == "paper" else f"more than -EA = {-EA:.6g}"
