"""D-bars and T-bars: forces level by level, counts, and the thrust at which a T-bar gives way."""

from math import cos, radians, sin, tan

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.new import find


def forces(name: str, **given: object) -> dict[str, tuple[float, float]]:
    """Return group -> least and greatest force."""
    target = find(name).equilibrium(**given)
    spans = {own.name: target.forces(own) for own in target.members}
    return {group: (float(t.min()), float(t.max())) for group, t in spans.items()}


def test_each_strut_of_a_d_bar_carries_its_share_of_its_diamonds_thrust():
    a, b = radians(40.0), radians(20.0)
    known = {
        "cables_1": 6.0 * tan(a),
        "cables_2": 6.0 / (2.0 * cos(a)) * tan(b),
        "struts": -6.0 / (4.0 * cos(a) * cos(b)),
    }
    for group, (least, greatest) in forces("d-bar", iterations=2, angle=40.0, load=6.0).items():
        assert (least, greatest) == pytest.approx((known[group], known[group]))


@pytest.mark.parametrize("iterations", [1, 2, 3, 5])
def test_a_d_bar_is_determinate_after_any_iterations(iterations):
    scene = cgff_cli.new("d-bar", iterations=iterations)
    struts, cables = 4**iterations, (4**iterations - 1) // 3
    assert len(scene.node_names) == 2 + 2 * cables
    assert [group.kind for group in scene.groups].count("cable") == iterations
    assert scene.element_count == struts + cables == 2 * len(scene.node_names) - 3
    analysis = cgff_cli.solve(scene).analysis
    assert (analysis["self_stress_states"], analysis["mechanisms"]) == (0, 0)


@pytest.mark.parametrize("name", ["d-bar", "t-bar"])
def test_no_node_of_a_column_is_on_another(name):
    X = cgff_cli.new(name, iterations=4, angle=59.0).coordinates
    apart = np.linalg.norm(X[:, None] - X[None, :], axis=2) + 10.0 * np.eye(len(X))
    assert apart.min() > 0.01


def test_a_t_bar_presses_on_its_struts_by_its_load_and_the_pull_of_its_cables():
    s = 5.0 / (4.0 / cos(radians(30.0)))  # force density of the longest cable, half the column in its shadow
    found = forces("t-bar", iterations=3, length=8.0, angle=30.0, load=7.0, prestress=5.0)
    assert found["cables_1"] == pytest.approx((5.0, 5.0))
    assert found["cables_3"] == pytest.approx((s / cos(radians(10.0)),) * 2)
    assert found["struts"] == pytest.approx((-7.0 - 2.0 * s * (4.0 + 2.0 + 1.0),) * 2)
    longest = -2.0 * s * 4.0 * tan(radians(30.0))
    assert found["crosspieces"] == pytest.approx((longest, -2.0 * s * tan(radians(10.0))))


@pytest.mark.parametrize("iterations", [1, 2, 3])
def test_a_t_bar_has_a_self_stress_for_each_of_its_braces(iterations):
    result = cgff_cli.solve(cgff_cli.new("t-bar", iterations=iterations))
    braces = 2**iterations - 1
    assert len(result.lengths) == 2**iterations + 6 * braces
    assert len(result.coordinates) == 2 + 3 * braces
    assert (result.analysis["self_stress_states"], result.analysis["mechanisms"]) == (braces, 0)


@pytest.mark.parametrize("prestress", [1.0, 20.0])
def test_a_t_bar_gives_way_at_the_thrust_that_the_lean_of_its_cables_holds(prestress):
    # The hub moves aside and takes its side nodes along: cables, of tension t, hold them back with
    # 4 (sin^2 (EA + t) + cos^2 t) / l, struts give way with 2 (load / a + 2 t / l); t drops out.
    most = 2.0 * 500.0 * sin(radians(15.0)) ** 2 * cos(radians(15.0))
    given = {"iterations": 1, "angle": 15.0, "EA": 500.0, "strut_EA": 1e6, "prestress": prestress}
    held, lost = (
        cgff_cli.solve(cgff_cli.new("t-bar", load=part * most, noise=1e-6, **given)) for part in (0.99, 1.01)
    )
    assert held.analysis["stable"]
    assert held.nodes["head"] == pytest.approx([0.0, 10.0], abs=1e-6)
    assert lost.nodes["head"][1] < 0.0  # it has fallen over, and hangs
