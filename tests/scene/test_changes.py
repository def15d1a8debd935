"""A scene in a load case, or with other loads, coordinates or rest lengths, is the same scene otherwise."""

import numpy as np
import pytest

import cgff_cli

SCENE = cgff_cli.loads("""\
law: hooke
nodes: {left: [0, 0], mid: [2, -0.5], right: [4, 0]}
elements:
  rope: {kind: cable, EA: 100, pretension: 3, weight: [0.5, 0.25], pairs: [[left, mid], [mid, right]]}
  tie: {kind: cable, EA: 100, rest_length: 4, pairs: [[left, right]]}
supports: {left: xy, right: xy}
loads: {mid: [0.5, -1]}
load_cases:
  snow: {mid: [0, -2], right: [0, -1]}
  wind: {mid: [3, 0]}
combinations:
  uls: {dead: 1.35, snow: 1.5, wind: 0.9}
  uplift: {wind: -1}
""")


def test_a_case_is_added_to_the_loads():
    assert SCENE.in_case("snow").loads == {1: (0.5, -3.0), 2: (0.0, -1.0)}
    assert SCENE.in_case("snow").weights.tolist() == SCENE.weights.tolist()


def test_dead_is_loads_and_weight_alone():
    dead = SCENE.in_case("dead")
    assert (dead.loads, dead.weights.tolist(), dead.case) == (SCENE.loads, [0.5, 0.25, 0.0], "dead")


def test_a_combination_is_the_sum_by_hand():
    uls = SCENE.in_case("uls")
    assert uls.loads[1] == pytest.approx((1.35 * 0.5 + 0.9 * 3.0, -1.35 * 1.0 - 1.5 * 2.0), rel=1e-15)
    assert uls.loads[2] == pytest.approx((0.0, -1.5), rel=1e-15)
    assert uls.weights == pytest.approx(1.35 * SCENE.weights, rel=1e-15)


def test_without_a_factor_of_dead_a_combination_has_neither_weight_nor_loads():
    uplift = SCENE.in_case("uplift")
    assert {row: load for row, load in uplift.loads.items() if any(load)} == {1: (-3.0, 0.0)}
    assert not uplift.weights.any()


def test_the_scene_itself_stays_in_no_case():
    SCENE.in_case("uls")
    assert (SCENE.case, SCENE.loads, SCENE.weights.tolist()) == ("", {1: (0.5, -1.0)}, [0.5, 0.25, 0.0])
    assert SCENE.in_case("uls").whole is SCENE
    assert SCENE.cases == ("snow", "wind", "uls", "uplift")


@pytest.mark.parametrize(
    ("name", "told"),
    [
        ("snwo", "no load case is named 'snwo'; did you mean 'snow'?"),
        ("quake", "no load case is named 'quake'; allowed: snow, wind, uls, uplift"),
    ],
)
def test_a_case_that_is_none_is_refused(name, told):
    with pytest.raises(cgff_cli.OptionError) as caught:
        SCENE.in_case(name)
    assert str(caught.value) == told


def test_a_scene_without_cases_says_so():
    with pytest.raises(cgff_cli.OptionError) as caught:
        cgff_cli.new("prism").in_case("wind")
    assert str(caught.value) == "no load case is named 'wind': the scene has no load cases"


def test_other_loads_are_in_place_of_its_own():
    assert SCENE.with_loads({"right": [1, 2]}).loads == {2: (1.0, 2.0)}
    assert SCENE.with_loads({}).loads == {}


def test_other_coordinates_leave_the_rest_lengths_of_pretensions_as_they_are():
    X = SCENE.coordinates + 0.25
    for moved in (
        SCENE.with_coordinates(X),
        SCENE.with_coordinates(dict(zip(SCENE.node_names, X, strict=True))),
    ):
        assert moved.coordinates.tolist() == X.tolist()
        assert moved.groups[0].rest_length.tolist() == SCENE.groups[0].rest_length.tolist()
        again = cgff_cli.loads(cgff_cli.to_yaml(moved))
        assert again.groups[0].rest_length.tolist() == SCENE.groups[0].rest_length.tolist()


def test_other_rest_lengths_are_those_of_a_scene_without_pretension():
    changed = SCENE.with_rest_lengths(np.array([1.0, 2.0, 3.0]))
    again = cgff_cli.loads(cgff_cli.to_yaml(changed))
    for own in (changed, again):
        assert [group.rest_length.tolist() for group in own.groups] == [[1.0, 2.0], [3.0]]
        assert own.groups[0].pretension is None
        assert own.weights.tolist() == SCENE.weights.tolist()


def test_without_any_rest_length_a_scene_is_a_geometry():
    assert SCENE.with_rest_lengths([np.nan] * 3).is_geometry
    with pytest.raises(cgff_cli.OptionError, match=r"^rest_lengths must be finite numbers > 0, got nan$"):
        SCENE.with_rest_lengths([1.0, np.nan, 1.0])


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda s: s.with_loads({"mdi": [0, 1]}), "no node is named 'mdi'; did you mean 'mid'?"),
        (lambda s: s.with_loads({"mid": [0, 0, 1]}), "mid: must be 2 finite numbers, got [0, 0, 1]"),
        (lambda s: s.with_loads({"mid": [0, np.nan]}), "mid: must be 2 finite numbers, got [0, nan]"),
        (lambda s: s.with_coordinates({"top": [0, 1]}), "no node is named 'top'"),
        (
            lambda s: s.with_coordinates(np.zeros((3, 3))),
            "coordinates must be finite numbers of the shape (3, 2)",
        ),
        (
            lambda s: s.with_coordinates([[0, 0]] * 2),
            "coordinates must be finite numbers of the shape (3, 2)",
        ),
        (
            lambda s: s.with_coordinates([[0, "x"]] * 3),
            "coordinates must be finite numbers of the shape (3, 2)",
        ),
        (lambda s: s.with_loads({"mid": ["a", 1]}), "mid: must be 2 finite numbers, got ['a', 1]"),
        (
            lambda s: s.with_rest_lengths([1.0, 2.0]),
            "rest_lengths must have the shape (3,), got (2,)",
        ),
        (lambda s: s.with_rest_lengths([1.0, 2.0, "x"]), "rest_lengths must be an array of numbers"),
        (lambda s: s.with_rest_lengths([1.0, 2.0, -1.0]), "rest_lengths must be finite numbers > 0, got"),
        (lambda s: s.with_rest_lengths([1.0, 2.0, 0.0]), "rest_lengths must be finite numbers > 0, got"),
        (lambda s: s.with_weights([1.0, np.nan, 0.0]), "weights must be finite numbers >= 0, got nan"),
        (lambda s: s.with_axial_stiffness([1.0, 0.0, 1.0]), "EA must be finite numbers > 0, got 0"),
    ],
)
def test_what_no_scene_may_have_is_refused(change, told):
    with pytest.raises(cgff_cli.OptionError) as caught:
        change(SCENE)
    assert str(caught.value).startswith(told)
