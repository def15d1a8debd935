"""What is known of the families from elsewhere: twists, ratios, counts, and relations between them."""

from math import cos, pi, sin, sqrt

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.families.rings import stage_stress
from cgff_cli.scene.new import find
from tests.shapes import element_lengths, twist

KINDS = ["tetrahedron", "cube", "octahedron", "dodecahedron", "icosahedron"]


def densities(name: str, **given: object) -> dict[str, float]:
    """Return group -> force density of its first member, over that of the first group."""
    members = find(name).equilibrium(**given).members
    return {own.name: own.q[0] / members[0].q[0] for own in members}


@pytest.mark.parametrize("sides", range(3, 13))
def test_a_prism_solved_from_noise_twists_by_a_right_angle_less_half_a_side(sides):
    X = cgff_cli.solve(cgff_cli.new("prism", sides=sides, noise=0.1, seed=sides)).coordinates
    assert twist(X, [(i, sides + i) for i in range(sides)]) == pytest.approx(90.0 - 180.0 / sides, abs=1e-6)


def test_a_prism_may_be_asked_for_by_its_strut():
    scene = cgff_cli.new("prism", sides=6, radius=2.0, strut=9.0)
    assert element_lengths(scene.coordinates, scene.groups[2].pairs) == pytest.approx([9.0] * 6)


@pytest.mark.parametrize("struts", [3, 5, 7, 11])
def test_a_star_prism_is_super_stable_and_pulls_as_the_prism_of_its_struts_does(struts):
    result = cgff_cli.solve(cgff_cli.new("star-prism", struts=struts, noise=0.1, seed=struts))
    ends = [(i, struts + i) for i in range(struts)]
    assert twist(result.coordinates, ends) == pytest.approx(90.0 / struts, abs=1e-6)
    assert result.analysis["super_stable"]
    assert result.analysis["mechanisms"] == 2 * struts + 1
    q = densities("star-prism", struts=struts)
    assert q == pytest.approx({"radials": 1.0, "verticals": q["verticals"], "struts": -q["verticals"]})
    assert q["verticals"] == pytest.approx(0.5 / cos(pi / (2.0 * struts)))


def test_the_star_prism_of_three_struts_has_the_nodes_of_the_prism():
    star, prism = cgff_cli.new("star-prism", struts=3), cgff_cli.new("prism")
    assert star.coordinates[:6] == pytest.approx(prism.coordinates)


@pytest.mark.parametrize("sides", range(3, 10))
def test_a_stage_with_the_twist_of_a_prism_is_a_prism(sides):
    ring, vertical, strut, diagonal = stage_stress(sides, pi / 2.0 - pi / sides)
    assert ring / vertical == pytest.approx(0.5 / sin(pi / sides))
    assert strut / vertical == pytest.approx(-1.0)
    assert diagonal == pytest.approx(0.0, abs=1e-15)


def test_a_tower_of_a_thousand_stages_has_three_nodes_a_level_and_twelve_elements_a_stage():
    scene = cgff_cli.new("tower", stages=1000)
    assert (len(scene.node_names), scene.element_count) == (3003, 12003)
    pairs = np.concatenate([group.pairs for group in scene.groups])
    assert len({frozenset(pair) for pair in pairs.tolist()}) == 12003


def test_the_expanded_octahedron_pushes_one_and_a_half_times_as_hard_as_it_pulls():
    assert densities("octahedron")["struts"] == pytest.approx(-1.5)
    cables, _ = find("octahedron").equilibrium(strut=4.0).members
    assert len(cables.pairs) == 24
    assert find("octahedron").equilibrium(strut=4.0).lengths(cables) == pytest.approx([sqrt(6.0)] * 24)


def truncated_tetrahedron(r: float) -> float:
    """Return the force density of the struts, of cuts 1 and edges r, from the determinant by hand.

    In the axes of its three half-turns the matrix of polyhedron.py is a = 2 + 2 q, b = 2 + 2 r + 2 q,
    c = 2 + 2 r on the diagonal and -1 beside it; abc = a + b + c + 2 is a quadratic in q, and of its two
    roots the one nearer zero leaves no direction in which the struts push harder than the cables pull.
    """
    second, first, zeroth = 2.0 * (1.0 + r), 2.0 * r**2 + 6.0 * r + 3.0, r * (2.0 * r + 3.0)
    return (-first + sqrt(first**2 - 4.0 * second * zeroth)) / (2.0 * second)


@pytest.mark.parametrize("ratio", [0.2, 1.0, 4.0])
def test_the_truncated_tetrahedron_has_a_root_of_its_determinant(ratio):
    assert densities("polyhedron", kind="tetrahedron", ratio=ratio)["struts"] == pytest.approx(
        truncated_tetrahedron(ratio), rel=1e-12
    )


def test_the_truncated_tetrahedron_with_equal_cables():
    q = densities("polyhedron", kind="tetrahedron")["struts"]
    assert q == pytest.approx((sqrt(41.0) - 11.0) / 8.0, rel=1e-12)


@pytest.mark.parametrize(("kind", "nodes"), [*zip(KINDS, [12, 24, 24, 60, 60], strict=True)])
def test_a_truncated_polyhedron_has_three_cables_and_a_strut_at_every_node(kind, nodes):
    scene = cgff_cli.new("polyhedron", kind=kind)
    cables = np.concatenate([group.pairs for group in scene.groups if group.kind == "cable"])
    struts = np.concatenate([group.pairs for group in scene.groups if group.kind == "strut"])
    assert np.bincount(cables.ravel()).tolist() == [3] * nodes
    assert np.bincount(struts.ravel()).tolist() == [1] * nodes
    assert np.linalg.norm(scene.coordinates, axis=1) == pytest.approx([1.0] * nodes)


@pytest.mark.parametrize("kind", KINDS)
def test_truncated_polyhedra_are_super_stable(kind):
    assert cgff_cli.solve(cgff_cli.new("polyhedron", kind=kind)).analysis["super_stable"]


def test_a_bent_snake_ends_at_the_angle_asked_for():
    X = find("snake").equilibrium(modules=6, bend=120.0).coordinates
    first, last = X[1] - X[0], X[-1] - X[-2]
    cosine = first @ last / np.linalg.norm(first) / np.linalg.norm(last)
    assert np.degrees(np.arccos(cosine)) == pytest.approx(120.0)


def test_a_net_leaves_out_its_corners_and_the_cables_along_its_rim():
    scene = cgff_cli.new("net", side=6)
    assert len(scene.node_names) == 36 - 4
    assert scene.element_count == 2 * 4 * 5
    assert len(scene.supports) == 16
    pairs = np.concatenate([group.pairs for group in scene.groups]).tolist()
    assert not any(a in scene.supports and b in scene.supports for a, b in pairs)


def test_snow_is_the_load_on_the_area_of_each_inner_node():
    scene = cgff_cli.new("net", side=5, span=8.0, snow=0.5)
    assert set(scene.loads.values()) == {(0.0, 0.0, -2.0)}
    assert len(scene.loads) == 9


def test_a_chain_has_the_same_horizontal_force_in_every_link():
    result = cgff_cli.solve(cgff_cli.new("catenary", links=8, span=10.0, sag=2.0, weight=7.0))
    horizontal = result.force_densities * np.diff(result.coordinates[:, 0])
    thrust = 7.0 / 7.0 * 8.0**2 / (8.0 * 2.0) * 10.0 / 8.0
    assert horizontal == pytest.approx([thrust] * 8, rel=1e-7)
