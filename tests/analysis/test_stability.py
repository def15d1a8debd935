"""Stable, unstable, neutral, super-stable: by structures where the answer is known."""

from dataclasses import replace

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.read import from_dict
from tests.analysis.scenes import CORNERS, crossed, unstressed
from tests.bodies import scene, tangent_by_complex_steps
from tests.closed_forms.references import expanded_octahedron, hanging_chain, hypar_net, prism
from tests.shapes import STRUCTURES
from tests.solvers.scenes import pendulum, shipped, truss

TRIANGLE = [(0, 1), (1, 2), (2, 0)]


def analysis(scene: "cgff_cli.Scene", **options: object) -> dict:
    result = cgff_cli.solve(scene, **options)
    assert result.converged
    return result.analysis


@pytest.mark.parametrize(
    ("start", "height", "kind"),
    [(0.5, 0.44**0.5, "stable"), (0.1, 0.0, "unstable"), (-0.5, -(0.44**0.5), "stable")],
)
def test_the_three_equilibria_of_a_von_mises_truss(start, height, kind):
    result = cgff_cli.solve(truss(start), objective="residual")
    assert result.nodes["n2"] == pytest.approx([0.0, height], abs=1e-9)
    assert (result.analysis["stability"], result.analysis["stable"]) == (kind, kind == "stable")


def test_the_softest_stiffness_of_a_level_truss_is_that_of_its_two_struts():
    # Across: 2 q = 2 k (l - l0) / l; along: 2 k.
    found = analysis(truss(0.1), objective="residual")
    assert found["smallest_stiffness"] == pytest.approx(2.0 * 100.0 * (1.0 - 1.2), rel=1e-9)


@pytest.mark.parametrize(("y", "kind"), [(1.0, "unstable"), (-1.0, "stable")])
def test_a_pendulum_is_stable_hanging_and_unstable_upright(y, kind):
    found = analysis(pendulum(y), objective="residual")
    assert found["stability"] == kind
    # Its own rotation is a rigid motion, and the load resists or drives it: weight over length.
    assert found["rigid_motions"] == 1
    assert found["smallest_stiffness"] == pytest.approx(-y / (1.0 - 0.01 * y), rel=1e-6)


@pytest.mark.parametrize(("y", "kind"), [(1.0, "unstable"), (-1.0, "stable")])
def test_a_stiffness_a_hundred_million_times_softer_than_another_still_has_its_sign(y, kind):
    light = replace(pendulum(y), loads={1: (0.0, -1e-6)})
    found = analysis(light, objective="residual")
    assert found["stability"] == kind
    assert found["smallest_stiffness"] == pytest.approx(-y * 1e-6, rel=1e-6)


def test_a_node_on_a_slack_cable_is_neutral():
    found = analysis(scene([(0.0, 0.0), (0.5, 0.0)], [(0, 1, "cable", 1.0, 1.0)], {0: "xy"}))
    assert (found["stability"], found["stable"], found["super_stable"]) == ("neutral", False, False)


def test_an_unstressed_square_is_neutral_and_a_triangle_stable():
    square = unstressed(CORNERS, [(0, 1), (1, 2), (2, 3), (3, 0)])
    assert analysis(square)["stability"] == "neutral"
    assert analysis(unstressed(CORNERS[:3], TRIANGLE))["stability"] == "stable"


def test_two_parts_that_nothing_joins_are_neutral():
    points = [*CORNERS[:3], (5.0, 0.0), (6.0, 0.0), (5.0, 1.0)]
    two = unstressed(points, [*TRIANGLE, (3, 4), (4, 5), (5, 3)])
    assert analysis(two)["stability"] == "neutral"


def test_where_only_rigid_motions_are_left_nothing_can_be_unstable():
    found = analysis(unstressed(CORNERS[:2], [(0, 1)], {0: "xy", 1: "xy"}))
    assert (found["stability"], found["smallest_stiffness"]) == ("stable", None)


@pytest.mark.parametrize("name", ["prism", "octahedron", "hexagon", "x-module", "bracket", "cable-net"])
def test_the_softest_stiffness_is_the_least_eigenvalue_apart_from_rigid_motions(name):
    result = cgff_cli.solve(shipped(name), tolerance=1e-12)
    values = np.linalg.eigvalsh(tangent_by_complex_steps(result.structure, result.coordinates))
    left = np.sort(values)[result.analysis["rigid_motions"] :]
    assert result.analysis["smallest_stiffness"] == pytest.approx(left[0], rel=1e-5)
    assert result.analysis["stable"] is True


@pytest.mark.parametrize(
    "mapping",
    [
        *(pytest.param(prism(n).scene("paper"), id=f"prism {n}") for n in range(3, 13)),
        pytest.param(expanded_octahedron().scene("hooke"), id="octahedron"),
        pytest.param(hanging_chain().scene("paper"), id="hanging chain"),
        pytest.param(hypar_net(4).scene("hooke"), id="net"),
    ],
)
def test_these_are_super_stable(mapping):
    found = analysis(from_dict(mapping))
    assert (found["stable"], found["super_stable"]) == (True, True)


@pytest.mark.parametrize("name", ["prism", "octahedron", "hexagon", "x-module"])
def test_the_shipped_tensegrities_are_super_stable_as_they_say(name):
    assert "super-stable" in (STRUCTURES / f"{name}.yaml").read_text(encoding="utf-8")
    assert analysis(shipped(name))["super_stable"] is True


def test_a_square_is_super_stable_with_cables_around_and_only_stable_with_struts_around():
    assert analysis(crossed("cable", "strut"))["super_stable"] is True
    inside_out = analysis(crossed("strut", "cable"))
    assert (inside_out["stable"], inside_out["super_stable"]) == (True, False)
    assert inside_out["nullity_D"] == 3


@pytest.mark.parametrize(
    "rigid",
    [unstressed(CORNERS[:3], TRIANGLE), truss(0.6), shipped("bracket")],
    ids=["triangle", "truss", "bracket"],
)
def test_stable_by_stiffness_alone_is_not_super_stable(rigid):
    found = analysis(rigid)
    assert (found["stable"], found["super_stable"]) == (True, False)


def test_a_part_without_stress_keeps_the_whole_from_being_super_stable():
    # The crossed square, and a node that two struts at rest hold beside it: D knows nothing of that node.
    square, side = crossed("cable", "strut"), 2.0**0.5
    points = [*CORNERS, (1.0, -1.0)]
    props = scene(points, [(4, 0, "strut", 100.0, side), (4, 1, "strut", 100.0, side)])
    found = analysis(replace(props, groups=square.groups + props.groups))
    assert (found["stable"], found["super_stable"]) == (True, False)
    assert found["nullity_D"] == 4


def test_an_unstable_equilibrium_is_not_super_stable():
    assert analysis(truss(0.0), objective="residual")["super_stable"] is False


@pytest.mark.parametrize("factor", [2.0**-40, 1e-9, 1e9])
def test_stability_does_not_depend_on_units(factor):
    scene = shipped("prism")
    groups = [replace(group, rest_length=group.rest_length * factor) for group in scene.groups]
    found = analysis(replace(scene, coordinates=scene.coordinates * factor, groups=tuple(groups)))
    assert (found["stability"], found["super_stable"]) == ("stable", True)
    assert found["smallest_stiffness"] == pytest.approx(analysis(scene)["smallest_stiffness"], rel=1e-6)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6, 1e-8, 1e-10, 1e-12])
@pytest.mark.parametrize("start", ["prism", "octahedron", "x-module"])
def test_stability_does_not_hang_on_how_closely_a_shape_was_solved_for(start, tolerance):
    assert analysis(shipped(start), tolerance=tolerance)["stability"] == "stable"


@pytest.mark.parametrize("tolerance", [1e-5, 1e-6, 1e-7, 1e-10])
@pytest.mark.parametrize("stages", [30, 300, 1000])
def test_a_long_tower_is_stable_however_loosely_it_was_solved(stages, tolerance):
    tower = cgff_cli.new("tower", stages=stages, noise=0.05)
    assert analysis(tower, tolerance=tolerance)["stability"] == "stable"


def test_a_shape_too_far_from_balance_to_tell_is_called_nothing():
    tower = cgff_cli.new("tower", stages=1000, noise=0.1)
    found = analysis(tower, tolerance=1e-4)
    assert found["stability"] in ("stable", None)  # never neutral


def line(seed: int, kind: str, nodes: int) -> "cgff_cli.Scene":
    """Elements at rest on a line in space, between two pins."""
    rng = np.random.default_rng(seed)
    along = np.concatenate(([0.0], np.sort(rng.uniform(0.0, 1.0, nodes - 2)), [1.0]))
    across = rng.normal(size=3)
    X = along[:, None] * (across / np.linalg.norm(across))
    rest = np.linalg.norm(np.diff(X, axis=0), axis=1)
    bars = [(i, i + 1, kind, 1000.0, float(rest[i])) for i in range(nodes - 1)]
    return scene(X, bars, {0: "xyz", nodes - 1: "xyz"}, law="hooke")


@pytest.mark.parametrize("kind", ["cable", "strut"])
@pytest.mark.parametrize("seed", range(10))
def test_a_straight_string_without_prestress_is_neutral(seed, kind):
    found = analysis(line(seed, kind, 7))
    assert (found["stability"], found["super_stable"]) == ("neutral", False)
    assert (found["nullity_D"], found["self_stress_states"], found["mechanisms"]) == (7, 1, 2 * 5)


@pytest.mark.parametrize("seed", range(10))
def test_a_body_of_struts_on_a_pin_is_stable_but_for_the_rotation_it_may_make(seed):
    points = np.random.default_rng(seed).normal(size=(4, 2))
    pairs = [(0, 1), (1, 2), (2, 0), (1, 3), (3, 2)]
    bars = [(i, j, "strut", 1.0, rest) for (i, j), rest in zip(pairs, (1, 1.2, 0.7, 0.9, 1), strict=True)]
    found = analysis(scene(points, bars, {0: "xy"}, law="hooke"))
    assert (found["stability"], found["mechanisms"], found["rigid_motions"]) == ("stable", 0, 1)


def test_a_load_that_points_at_the_pin_leaves_the_rotation_to_be_judged():
    # A strut on a pin pulled away from it, and pushed towards it: K along the rotation is load over length.
    for pull, kind in ((1e-6, "stable"), (-1e-6, "unstable")):
        body = scene([(0, 0), (1, 0)], [(0, 1, "strut", 1.0, 1.0)], {0: "xy"}, {1: (pull, 0.0)})
        assert analysis(body, objective="residual")["stability"] == kind
    # About the axis of the load nothing turns it: a rotation that costs nothing and is no deformation.
    body = scene(
        [(0, 0, 0), (1, 0, 0), (1, 1, 0)],
        [(0, 1, "strut", 1.0, 1.0), (1, 2, "strut", 1.0, 1.0), (0, 2, "strut", 1.0, 2.0**0.5)],
        {0: "xyz"},
        {1: (1e-3, 0.0, 0.0)},
    )
    assert analysis(body)["stability"] == "stable"


def test_what_is_not_stable_says_so_in_one_sentence_of_its_own():
    level = cgff_cli.solve(truss(0.1), objective="residual")
    assert [words for words in level.warnings if words.startswith("unstable: ")]
    slack = cgff_cli.solve(scene([(0.0, 0.0), (0.5, 0.0)], [(0, 1, "cable", 1.0, 1.0)], {0: "xy"}))
    (said,) = [words for words in slack.warnings if words.startswith("neutral: ")]
    assert "unstable" not in said


@pytest.mark.parametrize("tolerance", [1e-6, 1e-8, 1e-12])
def test_a_motion_that_only_forces_left_over_make_idle_is_not_called_stable(tolerance):
    """A bent line of three: turning it about its ends turns less than a loose tolerance leaves."""
    bars = [(0, 2, "strut", 0.1, 0.001), (1, 2, "cable", 10.0, 0.001), (0, 1, "strut", 1000.0, 1.0)]
    points = [(-0.4, 0.4, 0.0), (0.9, -1.0, 0.0), (0.3, -0.4, 0.0)]
    line = scene(points, bars, {0: "xyz", 2: "x"}, {1: (0.08, 0.1, -0.1)}, law="hooke")
    result = cgff_cli.solve(line, objective="residual", tolerance=tolerance)
    assert result.converged
    assert result.analysis["stability"] == (None if tolerance > 1e-7 else "unstable")
