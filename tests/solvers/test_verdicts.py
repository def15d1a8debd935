"""Every way a run can end can be reached, is named truly, and says so in a sentence."""

from dataclasses import replace
from decimal import Decimal, localcontext

import numpy as np
import pytest

import cgff_cli
from cgff_cli.solvers.solution import Solution
from cgff_cli.solvers.stopping import Verdict
from tests.bodies import forces_by_loop
from tests.shapes import distance_difference
from tests.solvers.scenes import kink, level_cable, shipped, truss

REACHED = {
    "converged": lambda: cgff_cli.solve(shipped("prism")),
    "rounding_floor": lambda: cgff_cli.solve(shipped("prism"), tolerance=1e-16),
    "stationary_not_equilibrium": lambda: cgff_cli.solve(level_cable(), objective="residual"),
    "step_vanished": lambda: cgff_cli.solve(shipped("prism"), method="table1"),
    "max_iterations": lambda: cgff_cli.solve(shipped("prism"), max_iterations=3),
    "diverged": lambda: cgff_cli.solve(shipped("prism"), method="table1", alpha=1e308),
    "interrupted": lambda: cgff_cli.solve(shipped("prism"), observer=interrupt_at(3)),
}
SENTENCES = {
    "converged": "equilibrium: out-of-balance force {} of the largest force, within the tolerance 1e-10",
    "rounding_floor": "equilibrium to rounding: out-of-balance force {} of the largest force, which is "
    "rounding error; the tolerance 1e-16 is below what double precision can tell here",
    "stationary_not_equilibrium": "no equilibrium: the objective is stationary, "
    "but out-of-balance force {} of the largest force remains",
    "step_vanished": "no equilibrium: steps vanished, "
    "but out-of-balance force {} of the largest force remains",
    "max_iterations": "no equilibrium yet: iteration limit reached "
    "with out-of-balance force {} of the largest force",
    "diverged": "no equilibrium: the shape grew without bound",
    "interrupted": "no equilibrium yet: stopped on request with out-of-balance force {} of the largest force",
}


def interrupt_at(iteration: int):
    """Return an observer that does what Ctrl-C does when it sees that row."""

    def observer(row: dict) -> None:
        if row["iteration"] == iteration:
            raise KeyboardInterrupt

    return observer


def exact_energy(solution: Solution) -> Decimal:
    """Return the energy at a solution's coordinates, in 60 digits, element by element."""
    structure, X = solution.mechanics.structure, solution.coordinates
    columns = (
        structure.start,
        structure.end,
        structure.stiffness,
        structure.rest_lengths,
        structure.tension_only,
    )
    with localcontext(prec=60):
        X = [[Decimal(x) for x in point] for point in X.tolist()]
        loads = [[Decimal(f) for f in force] for force in structure.loads.tolist()]
        energy = -sum(
            f * x for force, point in zip(loads, X, strict=True) for f, x in zip(force, point, strict=True)
        )
        for a, b, k, rest, pulls_only in zip(*(column.tolist() for column in columns), strict=True):
            e = sum((x - y) ** 2 for x, y in zip(X[a], X[b], strict=True)).sqrt() - Decimal(rest)
            energy += Decimal(0) if pulls_only and e < 0 else Decimal(k) * e * e / 2
        return energy


def test_every_verdict_is_tested_here():
    assert set(REACHED) == set(SENTENCES) == {str(verdict) for verdict in Verdict}


@pytest.mark.parametrize("verdict", list(REACHED))
def test_a_verdict_is_reached_and_says_its_sentence(verdict):
    result = REACHED[verdict]()
    assert result.verdict == verdict
    assert result.converged == (verdict in ("converged", "rounding_floor"))
    assert result.message == SENTENCES[verdict].format(f"{result.residual['relative']:.1e}")


@pytest.mark.parametrize("verdict", list(REACHED))
def test_the_residual_is_that_of_the_shape_handed_back(verdict):
    result = REACHED[verdict]()
    unbalanced = forces_by_loop(result.structure, result.coordinates)
    largest = np.abs(unbalanced[result.structure.free]).max()
    assert result.residual["max"] == pytest.approx(largest, abs=result.residual["rounding_floor"])
    assert (largest < 1e-9) == result.converged
    assert np.isfinite(result.coordinates).all()


@pytest.mark.parametrize("verdict", list(REACHED))
def test_stability_is_said_of_an_equilibrium_only(verdict):
    result = REACHED[verdict]()
    assert (result.analysis["stable"] is None) == (not result.converged)


@pytest.mark.parametrize("offset", [0.0, 1e6])
@pytest.mark.parametrize("name", ["prism", "cable-net", "bracket", "mast"])
def test_the_energy_is_right_to_its_own_floor(name: str, offset: float):
    scene = shipped(name)
    moved = replace(scene, coordinates=scene.coordinates + offset)
    solution = cgff_cli.solve(moved, tolerance=1e-15).solution
    assert abs(Decimal(solution.energy) - exact_energy(solution)) <= solution.energy_floor
    work = np.abs(solution.mechanics.structure.loads * solution.coordinates).sum()
    assert 0.0 < solution.energy_floor <= 1e-14 * (solution.lengths @ np.abs(solution.forces) + work)


@pytest.mark.parametrize("objective", ["energy", "residual"])
def test_at_the_rounding_floor_the_residual_is_no_larger_than_the_floor(objective):
    result = cgff_cli.solve(shipped("prism"), tolerance=1e-16, objective=objective)
    assert result.verdict == "rounding_floor"
    assert 1e-16 < result.residual["relative"] < 1e-12
    assert result.residual["max"] <= result.residual["rounding_floor"]


def test_an_interrupted_run_hands_back_the_shape_it_had_come_to():
    result = cgff_cli.solve(shipped("prism"), observer=interrupt_at(3))
    limited = cgff_cli.solve(shipped("prism"), max_iterations=3)
    assert np.array_equal(result.coordinates, limited.coordinates)
    assert result.history == limited.history


@pytest.mark.parametrize("method", ["cgff", "table1"])
def test_a_run_interrupted_after_two_rows_has_two_rows(method):
    result = cgff_cli.solve(shipped("hexagon"), method=method, observer=interrupt_at(1))
    assert result.verdict == "interrupted"
    assert result.history["iteration"] == [0, 1]


@pytest.mark.parametrize("preconditioner", ["tangent", "none"])
def test_where_k_eta_vanishes_the_squared_residual_is_stuck_and_the_energy_is_not(preconditioner):
    stuck = cgff_cli.solve(level_cable(), objective="residual", preconditioner=preconditioner)
    free = cgff_cli.solve(level_cable(), preconditioner=preconditioner)
    assert (stuck.verdict, stuck.counts["iterations"]) == ("stationary_not_equilibrium", 0)
    assert free.verdict == "converged"
    assert free.analysis["stable"] is True


@pytest.mark.parametrize("preconditioner", ["tangent", "none"])
@pytest.mark.parametrize("start", [0.05, -0.02, 0.0])
def test_at_a_kink_of_the_squared_residual_steps_vanish_and_under_the_energy_they_do_not(
    start, preconditioner
):
    stuck = cgff_cli.solve(kink(start), objective="residual", preconditioner=preconditioner)
    assert stuck.verdict == "step_vanished"
    assert stuck.nodes["n3"] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert stuck.residual["max"] == pytest.approx(5.0, rel=1e-9)
    assert cgff_cli.solve(kink(start), preconditioner=preconditioner).verdict == "converged"


def test_a_start_that_balances_is_converged_at_once():
    result = cgff_cli.solve(shipped("prism"))
    again = cgff_cli.solve(moved_to(result))
    assert (again.verdict, again.counts["iterations"]) == ("converged", 0)
    assert distance_difference(again.coordinates, result.coordinates) < 1e-12


def moved_to(result: "cgff_cli.Result") -> "cgff_cli.Scene":
    """Return the result's scene with its answer as the start."""
    return replace(result.source, coordinates=result.coordinates)


@pytest.mark.parametrize("limit", [0, 1, 4])
def test_the_iteration_limit_is_kept_to_the_row(limit):
    result = cgff_cli.solve(shipped("prism"), max_iterations=limit)
    assert (result.verdict, result.counts["iterations"]) == ("max_iterations", limit)


def test_without_any_force_the_residual_is_compared_with_k_l():
    result = cgff_cli.solve(truss(0.5))
    assert result.message.startswith("equilibrium: out-of-balance force ")
    assert "of the largest k l, as every force vanishes" in result.message
    assert result.residual["reference_force"] == pytest.approx(100.0 * 1.2)
    assert result.analysis["prestressed"] is False


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-12])
def test_a_converged_run_is_within_its_tolerance_by_a_loop_over_the_elements(tolerance):
    result = cgff_cli.solve(shipped("octahedron"), tolerance=tolerance)
    unbalanced = np.abs(forces_by_loop(result.structure, result.coordinates)).max()
    assert unbalanced <= tolerance * np.abs(result.forces).max() + result.residual["rounding_floor"]
    assert result.residual["relative"] <= tolerance
