"""The Kresling module: two states without force, and the energy between them, from its two crease lengths."""

from dataclasses import replace
from math import acos, cos, pi, radians

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.families.rings import ring_nodes
from tests.shapes import twist

STATES = ["deployed", "folded"]


def squared_creases(sides: int, height: float, turn: float) -> np.ndarray:
    """Return squared valley and mountain between polygons of radius 1, `turn` radians against each other."""
    angles = np.array([turn, turn - 2.0 * pi / sides])
    return height**2 + 2.0 - 2.0 * np.cos(angles)


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("sides", [3, 6, 8])
def test_either_state_is_found_from_a_start_near_it(sides, state):
    given = {"sides": sides, "height": 1.3, "folded": 1.0, "state": state}
    result = cgff_cli.solve(cgff_cli.new("kresling", **given, noise=0.1, seed=2), tolerance=1e-12)
    X = result.coordinates
    wide = np.degrees(acos((1.3**2 - 1.0) / (4.0 * cos(pi / sides))))
    assert X[sides:, 2] == pytest.approx([1.3 if state == "deployed" else 1.0] * sides, abs=1e-9)
    turn = 180.0 / sides + (wide if state == "deployed" else 180.0 - wide)
    assert twist(X, [(i, sides + i) for i in range(sides)]) == pytest.approx(turn, abs=1e-7)
    assert abs(result.energy) < 1e-20
    assert result.analysis["stable"]


def test_both_states_have_the_same_rest_lengths():
    deployed, folded = (cgff_cli.new("kresling", state=state) for state in STATES)
    for one, other in zip(deployed.groups, folded.groups, strict=True):
        assert one.rest_length == pytest.approx(other.rest_length, rel=1e-14)


@pytest.mark.parametrize(("height", "turn"), [(1.2, 60.0), (0.9, 110.0), (0.85, 121.0), (0.5, 150.0)])
def test_energy_at_any_height_and_turn_is_that_of_two_creases_a_side(height, turn):
    made = cgff_cli.new("kresling", strut_EA=50.0)
    X = ring_nodes(6, 1.0, (0.0, radians(turn)), height)
    result = cgff_cli.solve(replace(made, coordinates=X), max_iterations=0)
    l = np.sqrt(squared_creases(6, height, radians(turn)))
    wide = acos((1.2**2 - 0.5**2) / (4.0 * cos(pi / 6.0)))
    l0 = np.sqrt(squared_creases(6, 1.2, pi / 6.0 + wide))
    assert result.energy == pytest.approx(6.0 * (0.5 * 50.0 / l0 * (l - l0) ** 2).sum(), rel=1e-12)


def test_from_anywhere_a_module_ends_in_its_two_states_or_in_their_images_below():
    found = cgff_cli.equilibria(cgff_cli.new("kresling"), starts=150, seed=0)
    heights = [list(own["nodes"].values())[-1][2] for own in found.equilibria]
    assert sorted(heights) == pytest.approx([-1.2, -0.5, 0.5, 1.2], abs=1e-6)
