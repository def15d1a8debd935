"""Every family's answer is an equilibrium, is stable, and is found again from a start off it."""

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.families import FAMILIES
from cgff_cli.scene.new import find
from tests.families.cases import CASES, IDS
from tests.shapes import distance_difference, out_of_balance

NOISE = [(0.05, 1), (0.2, 2)]


def answer(name: str, given: dict) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return coordinates, lengths and forces as the family has them on paper."""
    target = find(name).equilibrium(**given)
    lengths = np.concatenate([target.lengths(own) for own in target.members])
    forces = np.concatenate([target.forces(own) for own in target.members])
    return target.coordinates, lengths, forces


def test_every_family_is_tested():
    assert {name for name, _ in CASES} == set(FAMILIES)


@pytest.mark.parametrize(("name", "given"), CASES, ids=IDS)
def test_the_answer_balances_node_by_node(name, given):
    target = find(name).equilibrium(**given)
    pairs = np.concatenate([own.pairs for own in target.members]).tolist()
    unbalanced = out_of_balance(target.coordinates, pairs, np.concatenate([own.q for own in target.members]))
    for row, load in target.loads.items():
        unbalanced[row] += load
    for row in target.supports:
        unbalanced[row] = 0.0
    force = max(np.abs(target.forces(own)).max() for own in target.members)
    assert np.abs(unbalanced).max() <= 1e-12 * force


@pytest.mark.parametrize("law", ["paper", "hooke"])
@pytest.mark.parametrize(("name", "given"), CASES, ids=IDS)
def test_a_start_at_the_answer_is_a_stable_equilibrium(name, given, law):
    there = {"start": "saddle"} if name == "net" else {"start": "shape"} if name == "catenary" else {}
    result = cgff_cli.solve(cgff_cli.new(name, law=law, **given, **there), analysis="always")
    assert result.history["residual_max"][0] < 1e-9 * result.residual["reference_force"]
    assert result.analysis["stable"]
    assert result.analysis["slack_count"] == 0


@pytest.mark.parametrize(("noise", "seed"), NOISE)
@pytest.mark.parametrize(("name", "given"), CASES, ids=IDS)
def test_the_answer_is_found_from_a_start_off_it(name, given, noise, seed):
    X, lengths, forces = answer(name, given)
    result = cgff_cli.solve(cgff_cli.new(name, **given, noise=noise, seed=seed), tolerance=1e-12)
    assert result.converged
    size, force = lengths.max(), np.abs(forces).max() or 1.0
    assert result.lengths == pytest.approx(lengths, abs=1e-9 * size)
    assert result.forces == pytest.approx(forces, abs=1e-8 * force)
    assert distance_difference(result.coordinates, X) < 1e-6 * size


@pytest.mark.parametrize("name", [name for name in FAMILIES if "prestress" in find(name).own])
def test_prestress_is_the_tension_of_the_tightest_cable(name):
    result = cgff_cli.solve(cgff_cli.new(name, prestress=3.0, EA=500.0))
    cables = result.structure.tension_only
    assert result.forces[cables].max() == pytest.approx(3.0, rel=1e-6)
    assert result.forces[cables].min() > 0.0
    assert (result.forces[~cables] < 0.0).all()


def test_snow_and_jitter_move_a_net_off_its_closed_form():
    plain = cgff_cli.solve(cgff_cli.new("net"))
    snowy = cgff_cli.solve(cgff_cli.new("net", snow=1.0, jitter=0.01, seed=3))
    assert snowy.converged
    assert snowy.coordinates[:, 2].mean() < plain.coordinates[:, 2].mean() - 1e-3
