"""`--require`: what an equilibrium must have, and the words for what it lacks."""

from collections.abc import Callable, Iterable
from functools import partial
from typing import TYPE_CHECKING, NamedTuple

from cgff_cli.errors import OptionError
from cgff_cli.hints import did_you_mean

if TYPE_CHECKING:
    import numpy as np

    from cgff_cli.result import Result

MOST_DIRECTIONS = 30_000
"""Free directions up to which ranks are computed because a requirement needs them: about a second."""

_NAMED = 3


class Requirement(NamedTuple):
    """One thing required: its words, the field of the analysis it needs, and what says how it is unmet."""

    words: str
    needs: str
    unmet: "Callable[[Result], str]"


def requirements(words: str) -> tuple[Requirement, ...]:
    """Return the requirements of words with commas between them, such as stable,max-strain=0.02."""
    return tuple(_requirement(word.strip()) for word in words.split(","))


def _requirement(word: str) -> Requirement:
    name, given, text = word.partition("=")
    if name == "max-strain":
        return Requirement(word, "", partial(_beyond, _limit(text)))
    if name not in PLAIN:
        hint = did_you_mean(name, (*PLAIN, "max-strain")) or ";"
        raise OptionError(f"unknown requirement {name!r}{hint} allowed: {ALLOWED}")
    if given:
        raise OptionError(f"{name} takes no value, got {word!r}")
    return Requirement(word, *PLAIN[name])


def _limit(text: str) -> float:
    try:
        limit = float(text)
    except ValueError:
        limit = -1.0
    if not 0.0 <= limit < float("inf"):
        raise OptionError(f"max-strain must be a number >= 0, as in max-strain=0.02, got {text!r}")
    return limit


def judged_for(result: "Result", required: Iterable[Requirement]) -> "Result":
    """Return a result whose analysis answers the requirements, where it may and takes seconds."""
    lacking = [name for _, name, _ in required if name and result.analysis[name] is None]
    small = int(result.structure.free.sum()) <= MOST_DIRECTIONS
    if not (lacking and small and result.converged and result.options["analysis"] == "auto"):
        return result
    from cgff_cli.pipeline import analysed_in_full

    return analysed_in_full(result)


def unmet(result: "Result", required: Iterable[Requirement]) -> list[str]:
    """Return one sentence for each requirement that an equilibrium does not meet."""
    said = [(own.words, own.unmet(result)) for own in required]
    return [f"{words} is required, but {what}" for words, what in said if what]


def _lacking(field: str, noun: str, why: "Callable[[Result], str]", result: "Result") -> str:
    """Return what is said of a field of the analysis that is not true: why, or why that is not known."""
    if result.analysis[field] is not None:
        return "" if result.analysis[field] else why(result)
    if result.options["analysis"] == "never":
        return f"{noun} was not computed, as analysis never asks"
    reason = (result.analysis.get("reason") or {}).get(field)
    return f"{noun} is not known: {reason or 'analysis always or a smaller tolerance may tell'}"


def _why_unstable(result: "Result") -> str:
    softest = result.analysis["smallest_stiffness"]
    return f"the equilibrium is {result.analysis['stability']}" + (
        "" if softest is None else f": its softest motion has a stiffness of {softest:.3g}"
    )


def _why_not_super_stable(result: "Result") -> str:
    if not result.analysis["prestressed"]:
        return "no element carries force"
    return _not_stable(result) or "it is stable by the stiffness of its elements, not by its stress alone"


_not_stable = partial(_lacking, "stable", "stability", _why_unstable)
_not_super_stable = partial(_lacking, "super_stable", "super-stability", _why_not_super_stable)


def _slack(result: "Result") -> str:
    rows = result.slack.nonzero()[0]
    return _said_of(result, rows, "slack")


def _beyond(limit: float, result: "Result") -> str:
    if result.max_strain is None:
        return "no element has a rest length to be strained from"
    strains = abs(result.strains)
    rows = (strains > limit).nonzero()[0]
    rows = rows[(-strains[rows]).round(9).argsort(kind="stable")]  # equal but for rounding: in scene order
    return _said_of(result, rows, f"strained by up to {result.max_strain:.6g}")


def _said_of(result: "Result", rows: "np.ndarray", what: str) -> str:
    """Return what is said of some elements, the first of them by group and nodes; nothing of none."""
    from cgff_cli.analysis.equilibrium import labels
    from cgff_cli.scene.findings import quoted

    if not len(rows):
        return ""
    named = [quoted(label) for label in labels(result.source, rows[:_NAMED])]
    named += ["..."] * (len(rows) > _NAMED)
    return f"{len(rows)} {'element is' if len(rows) == 1 else 'elements are'} {what}: {', '.join(named)}"


PLAIN: "dict[str, tuple[str, Callable[[Result], str]]]" = {
    "stable": ("stable", _not_stable),
    "no-slack": ("", _slack),
    "super-stable": ("super_stable", _not_super_stable),
}
"""Requirements without a number: the field of the analysis they need, and what says how they are unmet."""

ALLOWED = f"{','.join(PLAIN)},max-strain=X"
