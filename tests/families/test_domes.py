"""Geiger and Levy domes: statics by hand, counts, and one state of self-stress that has their symmetry."""

from math import sqrt

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.new import find
from tests.families.test_closed_forms import densities

ONE_RING = {"sides": 4, "rings": 1, "radius": 2.0, "rise": 4.0 / 3.0, "slope": 45.0}


def test_a_geiger_dome_of_one_ring_is_balanced_by_hand():
    # Supports at (2, 0), struts from (1, 1) to (1, -1); a square ring of density 1 pulls in by 2.
    assert densities("geiger", **ONE_RING) == pytest.approx(
        {"top_ring": 1.0, "ridges_1": 2.0, "diagonals_1": 2.0, "hoop_1": 1.0, "struts_1": -1.0}
    )


def test_a_levy_dome_of_one_ring_is_balanced_by_hand():
    # In plan two ridges lead sqrt(2) outwards from 1; they run sqrt(5 - 2 sqrt(2)) and so climb as much.
    climb = sqrt(5.0 - 2.0 * sqrt(2.0))
    ridge = 1.0 / (sqrt(2.0) - 1.0)
    assert densities("levy", **ONE_RING) == pytest.approx(
        {
            "top_ring": 1.0,
            "ridges_1": ridge,
            "diagonals_1": ridge / climb,
            "hoop_1": 1.0 / climb,
            "struts_1": -2.0 * ridge / (1.0 + climb),
        }
    )


@pytest.mark.parametrize(("sides", "rings"), [(3, 1), (6, 3), (9, 2)])
def test_a_geiger_dome_has_one_self_stress_and_many_mechanisms(sides, rings):
    result = cgff_cli.solve(cgff_cli.new("geiger", sides=sides, rings=rings))
    assert len(result.lengths) == sides * (4 * rings + 1)
    assert result.analysis["self_stress_states"] == 1
    assert result.analysis["mechanisms"] == sides * (2 * rings - 1) + 1


@pytest.mark.parametrize(("sides", "rings"), [(5, 1), (9, 3), (10, 2)])
def test_a_levy_dome_has_a_self_stress_a_strut_of_a_ring_and_hardly_a_mechanism(sides, rings):
    result = cgff_cli.solve(cgff_cli.new("levy", sides=sides, rings=rings))
    even = sides % 2 == 0
    assert len(result.lengths) == sides * (6 * rings + 1)
    assert result.analysis["self_stress_states"] == sides + even
    assert result.analysis["mechanisms"] == even


@pytest.mark.parametrize("name", ["geiger", "levy"])
def test_the_state_that_prestress_finds_by_group_is_the_one_of_statics(name):
    target = find(name).equilibrium(sides=7, rings=3).members
    found = cgff_cli.prestress(cgff_cli.new(name, sides=7, rings=3), by_group=True).force_densities
    assert found / found[0] == pytest.approx(np.concatenate([own.q for own in target]) / target[0].q[0])


@pytest.mark.parametrize("name", ["geiger", "levy"])
def test_supports_carry_the_load_of_a_dome(name):
    result = cgff_cli.solve(cgff_cli.new(name, load=0.1, noise=0.1))
    assert result.converged
    assert not result.slack.any()
    assert np.sum(list(result.reactions.values()), axis=0) == pytest.approx([0.0, 0.0, 1.6], abs=1e-8)
    assert result.coordinates[:16, 2].mean() < cgff_cli.new(name).coordinates[:16, 2].mean() - 1e-3
