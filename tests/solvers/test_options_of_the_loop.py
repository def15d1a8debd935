"""Every beta rule, objective and preconditioner reaches the equilibria of the shipped scenes."""

import pytest

import cgff_cli
from tests.shapes import distance_difference
from tests.solvers.scenes import SHIPPED, shipped

RULES = ["FR", "PR+", "HS", "DY", "TT", "SP", "HZ"]


@pytest.fixture(scope="module")
def usual():
    """Return the result of a shipped scene by the default options, each solved once."""
    results: dict[str, cgff_cli.Result] = {}

    def get(name: str) -> "cgff_cli.Result":
        if name not in results:
            results[name] = cgff_cli.solve(shipped(name))
        return results[name]

    return get


def assert_same_shape(result: "cgff_cli.Result", reference: "cgff_cli.Result") -> None:
    size = reference.lengths.max()
    assert result.verdict == "converged"
    assert distance_difference(result.coordinates, reference.coordinates) < 1e-6 * size
    assert result.forces == pytest.approx(reference.forces, abs=1e-6 * abs(reference.forces).max())


@pytest.mark.parametrize("preconditioner", ["tangent", "none"])
@pytest.mark.parametrize("cg_beta", RULES)
@pytest.mark.parametrize("name", SHIPPED)
def test_every_beta_rule_with_and_without_preconditioner_finds_the_least_energy(
    usual, name, cg_beta, preconditioner
):
    result = cgff_cli.solve(shipped(name), cg_beta=cg_beta, preconditioner=preconditioner)
    assert_same_shape(result, usual(name))
    assert any(beta > 0.0 for beta in result.history["beta"]) or preconditioner == "tangent"


@pytest.mark.parametrize("cg_beta", RULES)
@pytest.mark.parametrize("name", SHIPPED)
def test_every_beta_rule_takes_the_squared_residual_to_zero(name, cg_beta):
    result = cgff_cli.solve(shipped(name), objective="residual", cg_beta=cg_beta)
    assert result.verdict == "converged"
    assert result.analysis["stable"] is True


@pytest.mark.parametrize("name", ["x-module", "prism", "bracket"])
def test_plain_conjugate_gradients_on_the_squared_residual_agree(usual, name):
    result = cgff_cli.solve(shipped(name), objective="residual", preconditioner="none", max_iterations=20_000)
    assert_same_shape(result, usual(name))


def test_the_preconditioner_saves_most_of_the_iterations():
    with_it, without = (
        cgff_cli.solve(shipped("cable-net"), preconditioner=name) for name in ("tangent", "none")
    )
    assert with_it.counts["iterations"] * 4 < without.counts["iterations"]
    assert without.counts["factorizations"] == 0 < with_it.counts["factorizations"]
