"""What a case's `expect` says of the outcome, and whether a result of `solve` is that."""

from collections.abc import Mapping
from typing import Any

from cgff_cli.result import Result
from cgff_cli.solvers.stopping import Verdict

REFUSED = "refused"
"""Outcome of a scene that is no scene."""

BALANCED = ("converged", "floor")
"""First words of an outcome in balance, to the tolerance or to rounding; `balanced` stands for either."""

STABILITIES = ("stable", "unstable", "neutral", "unjudged")

OUTCOMES = (
    REFUSED,
    *(verdict.value for verdict in Verdict if not verdict.converged),
    *(f"{word}-{kind}" for word in ("balanced", *BALANCED) for kind in STABILITIES),
)
"""Every word that an expected outcome can be."""


def outcome(result: Result) -> str:
    """Return how a result ended, in one word such as converged-stable or max_iterations."""
    if not result.converged:
        return result.verdict
    word = "floor" if result.verdict == Verdict.ROUNDING_FLOOR else "converged"
    return f"{word}-{result.analysis['stability'] or 'unjudged'}"


def agrees(word: str, expected: str) -> bool:
    """Return whether an outcome is the one expected."""
    return word in {expected.replace("balanced", kind, 1) for kind in BALANCED}


def as_expected(result: Result, expect: Mapping[str, Any]) -> bool | None:
    """Return whether outcome, number of slack cables and warnings are those expected; None of nothing."""
    if "outcome" not in expect:
        return None
    slack = result.analysis["slack_count"]
    warned = "warns" not in expect or any(expect["warns"] in said for said in result.warnings)
    return agrees(outcome(result), expect["outcome"]) and expect.get("slack", slack) == slack and warned
