"""The two elastic laws: what numbers of elements may be, and which rest length gives a force at a length."""

from collections.abc import Callable
from functools import cache

import numpy as np

from cgff_cli.scene.fields import HUGE, LEAST_SIZE
from cgff_cli.values import Rule, short

Tell = Callable[[int, str], None]
"""Takes the row of an element and what is wrong with it, {} in place of its ends."""

_POSITIVE = Rule(positive=True, smallest=LEAST_SIZE, largest=HUGE)


@cache
def rules(law: str | None, kind: str | None = None) -> dict[str, Rule]:
    """Return what numbers of elements may be; law `hooke` divides by the rest length, cables cannot push."""
    not_negative = Rule(least=0.0, smallest=LEAST_SIZE, largest=HUGE)
    force = not_negative if kind == "cable" else Rule(smallest=LEAST_SIZE, largest=HUGE)
    length = _POSITIVE if law == "hooke" else not_negative
    return {"EA": _POSITIVE, "rest_length": length, "pretension": force, "weight": not_negative}


def rest_lengths_for(law: str, l: np.ndarray, t: np.ndarray, EA: np.ndarray) -> np.ndarray:
    """Return (b,) l0 at which lengths l give forces t; NaN where none does, or none above 0.

    l0 = l - t / EA (paper, eq. (2)) or EA l / (EA + t) (hooke).
    """
    l0 = l - t / EA if law == "paper" else EA * l / np.where(EA + t > 0.0, EA + t, np.nan)
    return np.where(l0 > 0.0, l0, np.nan)


def checked_rest_lengths(
    law: str, l: np.ndarray, t: np.ndarray, EA: np.ndarray, tell: Tell, is_one: bool
) -> np.ndarray | None:
    """Return (b,) l0 at which lengths l give forces t; None where a scene may have none of these.

    is_one: one force stands for all, and is told once, with the least of all limits
    """
    l0 = rest_lengths_for(law, l, t, EA)
    wrong = np.flatnonzero(~((l0 >= LEAST_SIZE) & (l0 <= HUGE)))
    wrong = wrong[np.argsort((l * EA if law == "paper" else np.sign(l) * EA)[wrong], kind="stable")]
    for row in wrong[: 1 if is_one else None].tolist():
        span = f"up to {short(HUGE)}" if l0[row] > HUGE else "above 0"
        limit = "" if l0[row] > HUGE else _limit(law, float(l[row]), float(EA[row]))
        tell(row, f"no rest length {span} gives {{}} a force of {t[row]:g} at the start{limit}")
    return None if len(wrong) else l0


def check_pull(t: np.ndarray, is_cable: np.ndarray | bool, tell: Tell) -> bool:
    """Record pretensions (b,) with which cables would push, and return whether there is any."""
    wrong = np.flatnonzero((t < 0.0) & is_cable).tolist()
    for row in wrong:
        tell(row, f"must be >= 0 for a cable, got {t[row]:g}")
    return bool(wrong)


def _limit(law: str, l: float, EA: float) -> str:
    """Return in words which forces have a rest length above 0 at a length."""
    if l == 0.0:
        return ": it has no length"
    return (
        f": it must be less than EA l = {EA * l:.6g}"
        if law == "paper"
        else f": it must be more than -EA = {-EA:.6g}"
    )
