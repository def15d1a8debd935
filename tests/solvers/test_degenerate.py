"""Minima that are no clean bowl: elements that shrink to a point, far below the size they started from."""

from dataclasses import replace

import numpy as np
import pytest

import cgff_cli
from tests.bodies import forces_by_loop, scene

PAIRS = [(i, j) for i in range(5) for j in range(i)]


def short_bars() -> cgff_cli.Scene:
    """Two elements of rest length 0.001, and a strut of 1 that they shorten to 0.002."""
    bars = [(1, 0, "cable", 10.0, 0.001), (0, 2, "strut", 10.0, 0.001), (1, 2, "strut", 1.0, 1.0)]
    return scene([(2.0, -2.0), (-2.0, -1.0), (-2.0, 2.0)], bars, law="hooke")


@pytest.mark.parametrize("seed", range(40))
def test_a_shape_that_shrinks_to_a_thousandth_is_balanced_to_the_tolerance(seed):
    start = np.random.default_rng(seed).uniform(-3.0, 3.0, (3, 2))
    result = cgff_cli.solve(replace(short_bars(), coordinates=start))
    assert result.verdict == "converged"
    unbalanced = forces_by_loop(result.structure, result.coordinates)
    assert np.abs(unbalanced).max() <= 1.01e-10 * np.abs(result.forces).max()


@pytest.mark.parametrize("tolerance", [1e-6, 1e-10, 1e-14, 1e-300])
@pytest.mark.parametrize("supports", [{}, {0: "xyz"}, {0: "xy", 1: "z"}], ids=["free", "pinned", "in part"])
@pytest.mark.parametrize(
    ("kind", "rest"), [("cable", 0.0), ("cable", 1e-12), ("strut", 0.0), ("strut", 1e-9)]
)
def test_elements_that_want_to_vanish_end_in_balance(kind, rest, supports, tolerance):
    points = np.random.default_rng(3).uniform(-1.0, 1.0, (5, 3))
    structure = scene(points, [(i, j, kind, 1.0, rest) for i, j in PAIRS], supports)
    result = cgff_cli.solve(structure, tolerance=tolerance)
    assert result.converged
    assert result.counts["iterations"] < 60


@pytest.mark.parametrize("supports", [{0: "xyz", 2: "x"}, {0: "xyz", 2: "xy"}])
def test_a_node_that_nothing_joins_may_be_held_in_part(supports):
    structure = scene([(0, 0, 0), (1.5, 0, 0), (5, 5, 5)], [(0, 1, "strut", 1.0, 1.0)], supports)
    result = cgff_cli.solve(structure)
    assert result.verdict == "converged"
    assert result.nodes["n2"] == [5.0, 5.0, 5.0]
    assert result.analysis["stability"] == "neutral"


def test_the_rounding_floor_is_that_of_the_present_size():
    # A start of 1e-9 grows to 1: at the start's own size rounding would be a thousand million times smaller.
    points = 1e-9 * np.random.default_rng(0).uniform(-1.0, 1.0, (4, 3))
    bars = [(i, j, "strut", 1.0, 1e-9) for i, j in PAIRS if i < 4]
    grown = scene(points, bars, loads={0: (1.0, 0.0, 0.0), 1: (-1.0, 0.0, 0.0)})
    result = cgff_cli.solve(grown, tolerance=1e-300)
    assert result.verdict in ("converged", "rounding_floor")


@pytest.mark.parametrize(("kind", "rest"), [("cable", 0.0), ("strut", 0.0), ("cable", 0.5)])
def test_energy_of_a_shape_shrunk_to_a_point_is_the_work_of_loads_on_it(kind, rest):
    bars = [(0, 1, "cable", 1.0, 0.0), (0, 1, kind, 1.0, rest)]
    result = cgff_cli.solve(scene([(0.4, 0.3), (-0.4, -0.7)], bars, {0: "xy"}, {0: (-0.25, 0.05)}))
    assert result.lengths.max() < 1e-100
    assert result.energy == pytest.approx(0.25 * 0.4 - 0.05 * 0.3, rel=1e-14)


def test_energy_of_nothing_but_shrunk_elements_is_zero():
    result = cgff_cli.solve(scene([(0.4, 0.3), (-0.4, -0.7)], [(0, 1, "cable", 1.0, 0.0)], {0: "xy"}))
    assert result.energy == 0.0


def test_a_residual_a_few_roundings_high_that_quick_steps_no_longer_halve_is_rounding():
    """Loads of 1e-11 on stiffness of 1000: hundreds of iterations went on within what rounding leaves."""
    points = [(0.5, -0.7, 0.7), (-0.4, 0.2, -0.4), (0.2, -0.4, 0.1), (0.2, 0.3, 0.5)]
    points += [(-0.7, -0.3, -0.4), (-0.8, -0.7, 0.0)]
    cables = [(0, 1, 100.0, 0.001), (1, 2, 1000.0, 0.001), (2, 3, 10.0, 0.0), (3, 4, 0.1, 0.001)]
    bars = [(i, j, "cable", EA, rest) for i, j, EA, rest in cables] + [
        (4, 5, "strut", 1000.0, 1.535316346783084)
    ]
    loads = {2: (-3e-11, -9e-12, 2e-11), 4: (2e-16, 2e-16, 8e-17)}
    result = cgff_cli.solve(scene(points, bars, {1: "xyz"}, loads), tolerance=5e-9)
    assert result.verdict == "rounding_floor"
    assert result.counts["iterations"] < 200  # three detours, which look for a way on, included


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_a_straight_pair_of_struts_buckles_though_no_step_is_left_where_it_is_straight(seed):
    rest = 0.6 * (1.0 + 0.1 * np.random.default_rng(seed).uniform(size=2))
    struts = [(0, 1, "strut", 10.0, rest[0]), (1, 2, "strut", 10.0, rest[1])]
    straight = scene([(0.0, 0.0), (0.5, 0.0), (1.0, 0.0)], struts, {0: "xy", 2: "xy"})
    result = cgff_cli.solve(straight, tolerance=1e-16)
    assert result.converged
    assert result.analysis["stability"] == "stable"
    assert result.energy < 1e-12
