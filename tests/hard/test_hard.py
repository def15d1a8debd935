"""The hard scenes end as they must: outcome, shape, and nothing called balanced or stable that is not.

The scenes are data in the YAML files beside this one. The slowest are left to
`python tests/studies/hard_suite.py`, which runs and lists all of them.
"""

import json
import math
from functools import cache

import numpy as np
import pytest

from cgff_cli.structure import Structure
from tests.bodies import forces_by_loop, tangent_by_complex_steps
from tests.hard.cases import (
    EPS,
    MOST_ITERATIONS,
    Case,
    agrees,
    built,
    cases,
    imbalance,
    is_balanced,
    references,
    solved,
)

NO_DERIVATIVES = {"spring-of-no-rest-length-on-its-support"}
"""Cases with an element of no length, where the energy has a kink."""

QUICK = [case for case in cases().values() if not case.slow]
SOLVED = [case for case in QUICK if case.expect["outcome"] != "refused"]
BALANCED = [case for case in SOLVED if case.expect["outcome"].startswith(("balanced", "floor"))]
SMOOTH_AND_SMALL = [
    case for case in BALANCED if case.scene.suite != "large" and case.id not in NO_DERIVATIVES
]
"""Those whose second derivatives can be taken one by one."""


@cache
def outcome_of(name: str):
    return solved(cases()[name])


def each(chosen: list[Case], *, wrong_ones_fail: bool = False):
    def param(case: Case):
        marks = [pytest.mark.xfail(strict=True, reason=case.wrong)] if case.wrong and wrong_ones_fail else []
        return pytest.param(case, id=case.id, marks=marks)

    return pytest.mark.parametrize("case", list(map(param, chosen)))


@each(QUICK, wrong_ones_fail=True)
def test_it_ends_as_it_must(case):
    outcome = outcome_of(case.id)
    assert agrees(outcome.word, case.expect["outcome"]), f"{outcome.word}: {outcome.message}"
    over = {key: (outcome.errors[key], outcome.allowed[key]) for key in outcome.errors}
    assert outcome.share <= 1.0, over
    if outcome.result is None:
        return
    assert not outcome.result.converged or outcome.result.counts["iterations"] <= MOST_ITERATIONS
    if "slack" in case.expect:
        assert outcome.result.analysis["slack_count"] == case.expect["slack"]
    if "warns" in case.expect:
        assert any(case.expect["warns"] in said for said in outcome.result.warnings)
    twin = case.same_iterations_as
    if twin:
        assert outcome.result.counts["iterations"] == outcome_of(twin).result.counts["iterations"]


@each(BALANCED)
def test_nothing_is_called_balanced_that_is_not(case):
    result = outcome_of(case.id).result
    assert result.converged
    assert is_balanced(case, result), imbalance(result)


@each(SMOOTH_AND_SMALL)
def test_nothing_is_called_stable_whose_second_derivatives_say_otherwise(case):
    result = outcome_of(case.id).result
    s, X = result.structure, result.solution.shape
    values = np.linalg.eigvalsh(_symmetric(tangent_by_complex_steps(s, X))) if s.free.any() else np.ones(1)
    blur = (
        1e-12 * max(np.abs(values).max(), float(s.stiffness.max()))
        + 10.0 * _left(s, X) / result.lengths.min()
    )
    if result.analysis["stability"] == "unstable":
        assert values[0] < 0.0
    else:
        assert result.analysis["stability"] in ("stable", "neutral")
        assert values[0] >= -blur


@each(SOLVED)
def test_every_number_of_the_result_is_finite(case):
    result = outcome_of(case.id).result
    json.dumps(result.to_dict(), allow_nan=False)
    assert all(map(math.isfinite, result.coordinates.ravel().tolist()))


def test_there_are_as_many_as_asked_and_every_one_says_where_its_answer_comes_from():
    assert len(cases()) >= 60
    for case in cases().values():
        assert case.source
        assert case.covers
        assert case.id in references() or case.reference == "none"


def test_a_wrong_answer_would_be_seen():
    from dataclasses import replace

    from tests.hard.cases import measured

    right = outcome_of("prism").result
    state = right.solution.state
    moved = state.mechanics.at(state.X + 1e-7 * np.arange(18).reshape(6, 3).T)
    wrong = replace(right, solution=replace(right.solution, state=moved))
    errors, allowed = measured(wrong, references()["prism"], {})
    assert errors["lengths"] > allowed["lengths"]
    assert errors["shape"] > allowed["shape"]
    assert not is_balanced(cases()["prism"], wrong)


def test_the_two_of_a_pair_have_the_same_lengths_and_other_shapes():
    for one, other in (("kite-open", "kite-folded"), ("bipyramid-open", "bipyramid-folded")):
        first, second = outcome_of(one).result, outcome_of(other).result
        assert first.lengths == pytest.approx(second.lengths, rel=1e-9)
        assert abs(_span(first) - _span(second)) > 0.5


def test_scenes_are_read_from_their_data_alike_each_time():
    case = cases()["prism-random-start-1"]
    assert (built(case.scene).coordinates == built(case.scene).coordinates).all()


def _span(result) -> float:
    X = result.coordinates
    return float(np.linalg.norm(X[-1] - X[-2]))


def _left(s: Structure, X: np.ndarray) -> float:
    """Return the norm of what the loop leaves out of balance, no less than its rounding."""
    left = np.linalg.norm(forces_by_loop(s, X)[s.free])
    return float(left) + 16.0 * EPS * float(s.stiffness.max()) * float(np.abs(X).max())


def _symmetric(K: np.ndarray) -> np.ndarray:
    return 0.5 * (K + K.T)
