"""Geodesic spheres: counts by Euler, the truncated icosahedron as the first, the flat net as the last."""

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.new import find
from tests.families.test_closed_forms import densities


def cycle_lengths(pairs: np.ndarray) -> list[int]:
    """Return how many nodes each ring of a graph has, in which every node leads on to one other."""
    onward = dict(pairs.tolist())
    rings = []
    while onward:
        node, count = next(iter(onward)), 0
        while node in onward:
            node, count = onward.pop(node), count + 1
        rings.append(count)
    return rings


@pytest.mark.parametrize("frequency", [1, 2, 3, 5])
def test_a_geodesic_sphere_has_twelve_pentagons_and_obeys_euler(frequency):
    square = frequency**2
    scene = cgff_cli.new("geodesic", frequency=frequency)
    cuts, edges, struts = (group.pairs for group in scene.groups)
    assert (len(cuts), len(edges), len(struts)) == (60 * square, 30 * square, 30 * square)
    rings = cycle_lengths(cuts)
    assert (rings.count(5), rings.count(6), len(rings)) == (12, 10 * square - 10, 10 * square + 2)
    faces = len(rings) + 20 * square
    assert len(scene.node_names) - len(cuts) - len(edges) + faces == 2
    assert (np.bincount(edges.ravel()) == 1).all()
    assert (np.bincount(struts.ravel()) == 1).all()
    assert np.linalg.norm(scene.coordinates, axis=1).min() > 0.97


@pytest.mark.parametrize("ratio", [0.3, 1.0, 5.0])
def test_the_sphere_of_frequency_one_is_the_truncated_icosahedron(ratio):
    sphere, solid = (
        find(name).equilibrium(ratio=ratio, **given)
        for name, given in (("geodesic", {"frequency": 1}), ("polyhedron", {"kind": "icosahedron"}))
    )
    for one, other in zip(sphere.members, solid.members, strict=True):
        assert one.q[0] == pytest.approx(other.q[0], rel=1e-12)
        assert sphere.lengths(one)[0] == pytest.approx(solid.lengths(other)[0], rel=1e-12)
    apart = [
        np.sort(np.linalg.norm(each.coordinates - each.coordinates[0], axis=1)) for each in (sphere, solid)
    ]
    assert apart[0] == pytest.approx(apart[1], abs=1e-12)


@pytest.mark.parametrize("ratio", [0.5, 1.0, 2.0])
def test_the_push_of_the_struts_nears_that_of_a_flat_net(ratio):
    # In a flat net a node is z from its vertex, along an edge of length 1. Cuts, edges and struts hold
    # 6 |z|^2 + 3 r |1 - 2 z|^2 + 3 q |1 - 2 z w|^2 a vertex, w a sixth of a turn; of least value 0.
    flat = -ratio / (1.0 + 2.0 * ratio)
    off = [densities("geodesic", frequency=f, ratio=ratio)["struts"] - flat for f in (4, 8)]
    assert abs(off[0]) < 0.02
    assert off[0] / off[1] == pytest.approx(4.0, abs=0.1)


@pytest.mark.parametrize("frequency", [1, 2, 3])
def test_a_geodesic_sphere_is_super_stable_on_a_single_self_stress(frequency):
    scene = cgff_cli.new("geodesic", frequency=frequency, noise=0.1, seed=frequency)
    analysis = cgff_cli.solve(scene, analysis="always").analysis
    assert analysis["super_stable"]
    assert (analysis["self_stress_states"], analysis["mechanisms"]) == (1, 60 * frequency**2 - 5)


def test_a_turn_of_the_icosahedron_maps_a_sphere_onto_itself():
    nodes = cgff_cli.new("geodesic", frequency=3).coordinates
    fifth = 2.0 * np.pi / 5.0
    turned = nodes @ np.array(
        [(np.cos(fifth), np.sin(fifth), 0), (-np.sin(fifth), np.cos(fifth), 0), (0, 0, 1)]
    )
    nearest = np.linalg.norm(nodes[:, None] - turned[None], axis=2).argmin(axis=1)
    assert nodes == pytest.approx(turned[nearest], abs=1e-12)
