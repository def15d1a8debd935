"""The paper's Table I: the iterates of a plain loop, and a verdict that does not believe its own test."""

from dataclasses import replace

import numpy as np
import pytest

import cgff_cli
from tests.bodies import Structure, forces_by_loop, scene, tangent_by_complex_steps
from tests.solvers.scenes import shipped

SCENES = ["x-module", "hexagon", "prism"]
SETTINGS = [(1.0, 0.5), (0.1, 0.5), (1e-3, 0.8), (1.0, 0.1)]


def table_1(structure: Structure, alpha: float, b: float, eps: float, limit: int):
    """Return the last shape, (f, step, alpha, beta) per iteration, evaluations: Table I as printed."""

    def value(X):
        eta = forces_by_loop(structure, X)[structure.free]
        return 0.5 * (eta @ eta)

    def gradient(X):
        eta = forces_by_loop(structure, X)[structure.free]
        g = np.zeros(X.shape)
        g[structure.free] = -tangent_by_complex_steps(structure, X) @ eta
        return g

    X = structure.coordinates
    f, g = value(X), gradient(X)
    d, rows, evaluations = -g, [(f, 0.0, 0.0, 0.0)], 1
    while np.linalg.norm(alpha * d) > eps and len(rows) <= limit:
        trial = X + alpha * d
        f_trial = value(trial)
        evaluations += 1
        if f_trial < f:
            X, f, old = trial, f_trial, g
            g = gradient(X)
            beta = (g * g).sum() / (old * old).sum()
            rows.append((f, np.linalg.norm(alpha * d), alpha, beta))
            d = -g + beta * d
            alpha = alpha / b
        else:
            alpha = alpha * b
    return X, np.array(rows), evaluations


# Rounding differs between the two and grows by an order of magnitude in five iterations or so.
@pytest.mark.parametrize(("limit", "tolerance"), [(10, 1e-11), (60, 1e-5)])
@pytest.mark.parametrize(("alpha", "step_factor"), SETTINGS)
@pytest.mark.parametrize("name", SCENES)
def test_the_iterates_and_counts_are_those_of_a_plain_loop(name, alpha, step_factor, limit, tolerance):
    options = {"alpha": alpha, "step_factor": step_factor, "max_iterations": limit}
    result = cgff_cli.solve(shipped(name), method="table1", **options)
    X, rows, evaluations = table_1(result.structure, alpha, step_factor, 1e-8, limit)
    columns = [result.history[column] for column in ("objective", "step_norm", "alpha", "beta")]
    found = np.array(columns).T
    assert result.counts["iterations"] == len(rows) - 1
    assert result.counts["evaluations"] == evaluations
    assert found == pytest.approx(rows, rel=tolerance)
    assert result.coordinates == pytest.approx(X, abs=tolerance * np.abs(X).max())


@pytest.mark.parametrize(("alpha", "step_factor"), SETTINGS)
@pytest.mark.parametrize("name", SCENES)
def test_when_its_own_test_holds_short_of_balance_steps_vanished_and_nothing_converged(
    name, alpha, step_factor
):
    result = cgff_cli.solve(
        shipped(name), method="table1", alpha=alpha, step_factor=step_factor, max_iterations=20_000
    )
    unbalanced = np.abs(forces_by_loop(result.structure, result.coordinates)).max()
    assert unbalanced > 1e-6 * np.abs(result.forces).max()
    assert result.verdict == "step_vanished"
    assert result.converged is False
    assert result.analysis["stable"] is None


def test_a_looser_test_of_its_own_ends_it_no_later():
    tight, loose = (cgff_cli.solve(shipped("prism"), method="table1", eps=eps) for eps in (1e-8, 1e-2))
    assert loose.counts["evaluations"] < tight.counts["evaluations"]


def test_a_start_in_balance_is_converged_at_once():
    result = cgff_cli.solve(shipped("prism"), tolerance=1e-12)
    start = replace(result.source, coordinates=result.coordinates)
    again = cgff_cli.solve(start, method="table1")
    assert (again.verdict, again.counts["iterations"]) == ("converged", 0)


def test_it_restarts_never_and_factorizes_nothing():
    counts = cgff_cli.solve(shipped("prism"), method="table1").counts
    assert (counts["restarts"], counts["factorizations"]) == (0, 0)


def test_a_trial_that_changes_nothing_is_not_accepted():
    # f = (x - 1)^2 / 2 from x = 1.5: a step of 2 mirrors the node to 0.5, a step of 1 balances it.
    bar = scene([(0.0, 0.0), (1.5, 0.0)], [(0, 1, "strut", 1.0, 1.0)], {0: "xy", 1: "y"})
    result = cgff_cli.solve(bar, method="table1", alpha=2.0)
    assert result.history["alpha"] == [0.0, 1.0]
    assert result.counts["evaluations"] == 3
    assert result.nodes["n1"] == [1.0, 0.0]
    assert result.verdict == "converged"


def test_a_step_that_hardly_shrinks_ends_at_a_limit_of_trials():
    result = cgff_cli.solve(shipped("prism"), method="table1", step_factor=0.999999)
    assert result.verdict == "max_iterations"
    assert result.counts["evaluations"] < 30_000


@pytest.mark.parametrize("alpha", [1e3, 1e150, 1e300])
@pytest.mark.filterwarnings("error")
def test_a_step_far_too_long_overflows_quietly(alpha):
    assert not cgff_cli.solve(shipped("prism"), method="table1", alpha=alpha).converged


def test_a_limit_that_ends_it_in_balance_says_converged():
    first = cgff_cli.solve(shipped("x-module"), method="table1", max_iterations=9)
    assert first.verdict == "max_iterations"
    reached = 1.01 * first.residual["relative"]
    again = cgff_cli.solve(shipped("x-module"), method="table1", max_iterations=9, tolerance=reached)
    assert (again.verdict, again.counts) == ("converged", first.counts)
