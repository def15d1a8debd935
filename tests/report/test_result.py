"""What a result tells beside shape and forces: strain, motion, and the scene as it was solved."""

import numpy as np
import pytest

from cgff_cli import loads, solve
from cgff_cli.result import Result

SPRINGS = """\
law: paper
nodes: {a: [0, 0], b: [3, 4]}
supports: {a: xy, b: xy}
elements:
  spring: {kind: cable, EA: 1.0, rest_length: 0, pairs: [[a, b]]}
  rope: {kind: cable, EA: 1.0, rest_length: [4.0, 6.0], pairs: [[a, b], [b, a]]}
"""


def test_strain_is_relative_to_the_rest_length_and_zero_where_slack_and_null_without_one():
    result = solve(loads(SPRINGS))
    assert [element["strain"] for element in result.elements] == [None, 0.25, 0.0]
    assert np.array_equal(result.strains, [np.nan, 0.25, 0.0], equal_nan=True)
    assert result.max_strain == 0.25


def test_the_largest_strain_may_be_a_push():
    result = solve(
        loads(
            SPRINGS.replace("[4.0, 6.0]", "[4.0, 10.0]").replace("rope: {kind: cable", "rope: {kind: strut")
        )
    )
    assert result.strains.tolist()[1:] == [0.25, -0.5]
    assert result.max_strain == 0.5


def test_without_any_rest_length_there_is_no_strain():
    springs = "\n".join(SPRINGS.splitlines()[:-1])
    assert solve(loads(springs)).max_strain is None


def test_motion_is_from_the_start_over_the_size_of_the_structure():
    drop = "law: paper\nnodes: {a: [0, 0], b: [0, -3]}\nsupports: {a: xy, b: x}\nloads: {b: [0, -1]}\n"
    rope = "elements: {rope: {kind: cable, EA: 1.0, rest_length: %s, pairs: [[a, b]]}}\n"
    assert solve(loads(drop + rope % 4.0)).max_displacement == pytest.approx(2.0 / 4.0)
    assert solve(loads(drop + rope % 2.5)).max_displacement == pytest.approx(0.5 / 3.0)


def test_motion_of_what_is_held_everywhere_is_none():
    assert solve(loads(SPRINGS)).max_displacement == 0.0


def test_supports_and_loads_are_told_by_node(triangle: Result):
    assert triangle.supports == {"a": "xy", "é": "x"}
    assert triangle.loads == {'b, "c"': [0.25, 0.125]}


def test_groups_sum_up_their_elements():
    result = solve(loads(SPRINGS))
    assert result.groups == {
        "spring": {"count": 1, "length": [5, 5], "force": [5, 5], "force_density": [1, 1], "slack": 0},
        "rope": {"count": 2, "length": [5, 5], "force": [0, 1], "force_density": [0, 0.2], "slack": 1},
    }


@pytest.mark.parametrize("name", ["coordinates", "lengths", "forces", "force_densities", "slack", "strains"])
def test_arrays_are_made_once_however_many_blocks_of_a_table_ask(triangle: Result, name: str):
    assert getattr(triangle, name) is getattr(triangle, name)
