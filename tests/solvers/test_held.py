"""What a support holds ends at the very number it was given; reactions and residual belong to that shape."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import cgff_cli
from cgff_cli.scene.scene import AXES
from tests.bodies import forces_by_loop, scene

METHODS = [{}, {"objective": "residual"}, {"method": "table1", "max_iterations": 50}]

coordinate = st.one_of(
    st.floats(-10.0, 10.0), st.floats(-1e30, 1e30), st.sampled_from([0.1, -0.3, 1e30, 1e-30, 1e6 + 0.1])
)


def tripod(points: list[tuple[float, ...]], axes: list[str]) -> cgff_cli.Scene:
    """Return three held nodes and a fourth that cables and a strut tie to them."""
    bars = [(i, 3, kind, 7.0, 1.1) for i, kind in enumerate(("cable", "strut", "cable"))]
    return scene(points, bars, dict(enumerate(axes)))


@given(
    st.lists(st.tuples(coordinate, coordinate, coordinate), min_size=4, max_size=4),
    st.lists(st.sampled_from(["xyz", "x", "yz", "z"]), min_size=3, max_size=3),
    st.sampled_from(METHODS),
)
@settings(max_examples=60, deadline=None, derandomize=True)
def test_held_directions_do_not_move_by_a_bit(points, axes, method):
    structure = tripod(points, axes)
    result = cgff_cli.solve(structure, **method)
    for row, held in structure.supports.items():
        for axis in map(AXES.index, held):
            assert result.coordinates[row, axis] == structure.coordinates[row, axis]


@pytest.mark.parametrize("name", ["schek", "dr", "lbfgs", "fsolve", "lm", "cgff-residual", "table1"])
def test_no_rival_moves_them_either(name):
    points = [(0.1, 0.2, 0.3), (1.7, -0.3, 1e6 + 0.1), (-1.1, 0.7, 0.0), (0.3, 0.3, 0.7)]
    structure = tripod(points, ["xyz", "xyz", "xyz"])
    for method in cgff_cli.compare(structure, [name], repeat=1, max_iterations=50).methods:
        held = [method.nodes[f"n{row}"] for row in range(3)]
        assert held == [list(point) for point in points[:3]]


def test_reactions_are_the_forces_of_the_shape_handed_back():
    points = [(0.1, 0.2, 0.3), (1.7, -0.3, 0.4), (-1.1, 0.7, 0.0), (0.3, 0.3, 0.7)]
    result = cgff_cli.solve(tripod(points, ["xyz", "yz", "z"]))
    forces = forces_by_loop(result.structure, result.coordinates)
    held = ~result.structure.free[:3]
    reactions = np.array([result.reactions[f"n{row}"] for row in range(3)])
    assert reactions[held] == pytest.approx(-forces[:3][held], abs=1e-13)
