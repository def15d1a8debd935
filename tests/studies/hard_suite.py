"""The hard scenes, one row each: outcome, error against the reference, iterations, time.

    python tests/studies/hard_suite.py [--only WORD]

Errors are relative and shown with what is allowed: 1e-9, or what the remaining force over the softest
stiffness explains if that is more. "ref" says where the answer comes from: f closed form, d 40 digits, o only
the outcome is known. "balance" is the largest out-of-balance force of a loop over the elements, relative.
"""

import argparse
import os
import sys
from pathlib import Path

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.hard.cases import MOST_ITERATIONS, agrees, cases, imbalance, is_right, references, solved


def source(case):
    """Return the letter for where the answer comes from."""
    if case.id not in references():
        return "o"
    return "f" if case.reference == "closed" else "d"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="only scenes with this word in their id")
    arguments = parser.parse_args()
    asked = [case for case in cases().values() if arguments.only in case.id]
    print(
        f"{'scene':42} {'outcome':26} {'ref':3} {'error':>8} {'allowed':>8} {'balance':>8} "
        f"{'iterations':>10} {'ms':>8}  as expected"
    )
    right = 0
    for case in asked:
        outcome = solved(case)
        result = outcome.result
        fine = is_right(case, outcome)
        right += fine
        worst = max(outcome.errors, key=lambda key: outcome.errors[key] / outcome.allowed[key], default=None)
        error, allowed = (outcome.errors[worst], outcome.allowed[worst]) if worst else (None, None)
        print(
            f"{case.id:42} {outcome.word:26} {source(case):3} {_short(error):>8} {_short(allowed):>8} "
            f"{_short(imbalance(result)[0] if result else None):>8} "
            f"{result.counts['iterations'] if result else '-':>10} "
            f"{f'{1e3 * result.seconds:.1f}' if result else '-':>8}  "
            f"{'yes' if fine else 'NO'}{_reason(case, outcome, worst)}",
            flush=True,
        )
    print(f"{right} of {len(asked)} as expected")


def _reason(case, outcome, worst):
    if not agrees(outcome.word, case.expect["outcome"]):
        return f": {case.expect['outcome']} expected"
    if worst and outcome.share > 1.0:
        return f": {worst}"
    if outcome.result and outcome.result.converged and outcome.result.counts["iterations"] > MOST_ITERATIONS:
        return ": iterations"
    return ""


def _short(value):
    return "-" if value is None else f"{value:.0e}"


if __name__ == "__main__":
    main()
