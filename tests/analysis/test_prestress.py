"""Prestress: shapes from formulas in, self-stress of the right signs and rest lengths out."""

from dataclasses import replace
from math import pi, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import null_space
from scipy.optimize import linprog, nnls

import cgff_cli
from tests.geometries import (
    dome,
    family,
    geometry,
    grid,
    moved,
    net,
    of_one_kind,
    prism,
    solid,
    stack,
    swapped,
    truss,
    wheel,
    x_module,
)
from tests.paper.printed import TABLE_3, TABLE_4

OF_MANY_STATES = {
    "octahedron": solid("octahedron"),
    "askew octahedron": moved(solid("octahedron"), 0.2, 1),
    "cuboctahedron": solid("cuboctahedron"),
    "levy": dome(6, 2, levy=True),
    "askew levy": moved(dome(6, 1, levy=True), 0.05, 1),
    "stack": stack(3, 3),
    "net": net(5, 0.4),
    "tower": family("tower"),
    "drum": family("drum"),
    "snake": family("snake"),
}
few = settings(max_examples=4, deadline=None, derandomize=True)


def pairs_of(scene):
    return np.concatenate([group.pairs for group in scene.groups])


def signs_of(scene):
    kinds = [own.kind for own in scene.groups for _ in own.EA]
    return np.where([kind == "cable" for kind in kinds], 1.0, -1.0)


def equilibrium_rows(scene):
    """Return the equations of balance in force densities, (f, b), by a loop."""
    (n, d), pairs = scene.coordinates.shape, pairs_of(scene)
    U = np.zeros((n, d, len(pairs)))
    for e, (i, j) in enumerate(pairs):
        U[i, :, e] += scene.coordinates[i] - scene.coordinates[j]
        U[j, :, e] -= scene.coordinates[i] - scene.coordinates[j]
    free = np.array([[axis not in scene.supports.get(row, "") for axis in "xyz"[:d]] for row in range(n)])
    return U[free]


def lengthening(scene, motion):
    """Return the rates (b,) at which a motion, node -> vector, lengthens elements."""
    v, pairs = np.array(list(motion.values())), pairs_of(scene)
    along = scene.coordinates[pairs[:, 0]] - scene.coordinates[pairs[:, 1]]
    return ((v[pairs[:, 0]] - v[pairs[:, 1]]) * along).sum(axis=1) / np.linalg.norm(along, axis=1)


def rows_of(scene, labels):
    names = scene.node_names
    every = [f"{own.name}: {names[a]}-{names[b]}" for own in scene.groups for a, b in own.pairs.tolist()]
    return np.array([label in set(labels) for label in every])


def assert_proven(scene, found):
    """What never carries its sign is lengthened, or shortened, so that it cannot, and nothing else is."""
    rate = signs_of(scene) * lengthening(scene, found.certificate)
    never = rows_of(scene, found.never)
    size = np.abs(rate).max()
    assert np.abs(rate[~never]).max(initial=0.0) <= 1e-9 * size
    assert rate[never].min(initial=np.inf) > 1e-6 * size
    v = np.array(list(found.certificate.values()))
    held = np.array(
        [["xyz"[a] in scene.supports.get(r, "") for a in range(v.shape[1])] for r in range(len(v))]
    )
    assert not v[held].any()


def assert_held(scene, found):
    """The forces have the right signs, balance, and `solve` stays where the scene begins."""
    assert found.feasible
    assert (signs_of(scene) * found.forces > 0.0).all()
    loads = np.zeros(scene.coordinates.shape)
    for row, load in scene.loads.items():
        loads[row] = load
    q = found.force_densities
    assert q == pytest.approx(
        found.forces / np.linalg.norm(np.diff(found.scene.coordinates[pairs_of(scene)], axis=1)[:, 0], axis=1)
    )
    result = cgff_cli.solve(found.scene)
    assert (result.counts["iterations"], result.verdict) == (0, "converged")
    assert result.forces == pytest.approx(found.forces, rel=1e-9, abs=1e-9 * np.abs(found.forces).max())


@pytest.mark.parametrize("law", ["paper", "hooke"])
def test_the_prism_of_table_4_carries_what_the_paper_says(law):
    height = sqrt(49.0 - 12.0 * sin(75.0 * pi / 180.0) ** 2)
    bottom = pi * np.array([0.0, 120.0, 240.0]) / 180.0
    flat = [
        sqrt(3.0) * np.column_stack((np.cos(a), np.sin(a))) for a in (bottom, bottom + pi * 150.0 / 180.0)
    ]
    X = np.column_stack((np.concatenate(flat), np.repeat([0.0, height], 3)))
    kinds = {"sides": ("cable", TABLE_4.cables[:6]), "verticals": ("cable", [(0, 5), (1, 3), (2, 4)])}
    scene = geometry(X, {**kinds, "struts": ("strut", TABLE_4.struts)}, law=law)
    found = cgff_cli.prestress(scene)
    assert_held(scene, found)
    ratios = found.force_densities / -found.force_densities[-1]
    assert ratios == pytest.approx(np.repeat([1.0 / sqrt(3.0), 1.0, -1.0], [6, 3, 3]), abs=1e-12)
    assert found.result.max_strain == pytest.approx(0.01, rel=1e-9)
    assert (found.self_stress_states, found.mechanisms) == (1, 1)
    assert (found.stability, found.super_stable) == ("stable", True)


def test_its_printed_coordinates_give_the_same_to_the_digits_printed():
    scene = replace(prism(3), coordinates=TABLE_4.cgff, groups=family("prism").groups)
    pairs = (TABLE_4.cables[:6], TABLE_4.cables[6:], TABLE_4.struts)
    groups = zip(scene.groups, map(np.array, pairs), strict=True)
    scene = replace(scene, groups=tuple(replace(own, pairs=rows) for own, rows in groups))
    found = cgff_cli.prestress(scene, tolerance=1e-4)
    ratios = found.force_densities / -found.force_densities[-1]
    assert ratios == pytest.approx(np.repeat([1.0 / sqrt(3.0), 1.0, -1.0], [6, 3, 3]), abs=2e-5)
    assert found.max_node_motion < 1e-4


@pytest.mark.parametrize("jump", [1, 2, 3])
@pytest.mark.parametrize("n", [5, 8, 30])
def test_a_tapered_prism_carries_its_closed_form(n, jump):
    scene = prism(n, jump=jump, top=0.6)
    q = cgff_cli.prestress(scene).force_densities
    ring = sin(pi * jump / n) * 2.0 / (2.0 - 2.0 * np.cos(2.0 * pi / n))
    wanted = np.repeat([ring * 0.6, ring / 0.6, 1.0, -1.0], n)
    assert q / q[2 * n] == pytest.approx(wanted, rel=1e-10)


def test_four_points_carry_one_state_whose_signs_only_a_convex_order_has():
    assert_held(x_module(), cgff_cli.prestress(x_module()))
    inside = x_module(((0, 0), (1, 0), (0.3, 0.3), (0, 1)))
    found = cgff_cli.prestress(inside)
    assert (found.feasible, found.self_stress_states, found.scene) == (False, 1, None)
    assert_proven(inside, found)
    assert_proven(inside, cgff_cli.prestress(inside, tolerance=0.01))


def test_six_points_off_a_conic_lack_one_member():
    scene = replace(wheel(3), coordinates=np.array(TABLE_3.cgff))
    found = cgff_cli.prestress(scene)
    assert (found.feasible, found.self_stress_states, found.mechanisms) == (False, 0, 0)
    assert "needs 1 more member for one; the least singular value is 0.0011" in found.reason
    assert found.never == found.idle
    assert len(found.never) == 9
    assert_proven(scene, found)


def test_with_a_tolerance_the_nodes_go_to_the_conic_near_by():
    scene = replace(wheel(3), coordinates=np.array(TABLE_3.cgff))
    found = cgff_cli.prestress(scene, tolerance=0.01)
    assert_held(scene, found)
    assert 1e-4 < found.max_node_motion < 1e-3
    X = found.scene.coordinates
    conic = np.column_stack((X**2, X[:, 0] * X[:, 1], X, np.ones(6)))
    assert np.linalg.svd(conic, compute_uv=False)[-1] < 1e-9


def test_a_state_that_rounding_leaves_inexact_is_neither_taken_nor_denied():
    scene = moved(wheel(3), 1e-9, 1)
    found = cgff_cli.prestress(scene)
    assert (found.feasible, found.scene) == (None, None)
    assert "a tolerance of 1e-8 moves them" in found.reason
    assert_held(scene, cgff_cli.prestress(scene, tolerance=1e-8))


def test_a_state_that_balances_as_well_as_a_solve_would_have_it_is_taken():
    scene = moved(wheel(3), 2e-10, 1)
    assert_held(scene, cgff_cli.prestress(scene))


@pytest.mark.parametrize("name", OF_MANY_STATES)
def test_of_many_states_no_other_has_a_greater_least_member(name):
    scene = OF_MANY_STATES[name]
    found = cgff_cli.prestress(scene)
    assert_held(scene, found)
    signs, U, b = signs_of(scene), equilibrium_rows(scene), scene.element_count
    upper = np.column_stack((-np.diag(signs), np.ones(b)))
    best = linprog(
        np.append(np.zeros(b), -1.0),
        upper,
        np.zeros(b),
        np.column_stack((U, np.zeros(len(U)))),
        np.zeros(len(U)),
        [(-1.0, 1.0)] * b + [(None, None)],
    )
    q = np.abs(found.force_densities)
    assert q.min() / q.max() == pytest.approx(-best.fun, rel=1e-6)
    # Of all as good, the least: the distance of a polyhedron from 0 (Lawson and Hanson 1974).
    N = null_space(U)
    W, size = signs[:, None] * N, -best.fun * (1.0 - 1e-9)
    G, h = np.concatenate((W, -W)), np.concatenate((np.full(b, size), -np.ones(b)))
    E, f = np.concatenate((G.T, h[None])), np.append(np.zeros(N.shape[1]), 1.0)
    left = E @ nnls(E, f)[0] - f
    assert np.linalg.norm(q / q.max()) == pytest.approx(np.linalg.norm(left[:-1] / left[-1]), rel=1e-5)


@pytest.mark.parametrize("name", OF_MANY_STATES)
@given(seed=st.integers(0, 2**32 - 1))
@few
def test_the_answer_hangs_on_no_order_place_or_size(name, seed):
    scene, source = OF_MANY_STATES[name], np.random.default_rng(seed)
    n, d = scene.coordinates.shape
    order = source.permutation(n)  # new row -> old row
    rows, turn = np.argsort(order), np.linalg.qr(source.normal(size=(d, d)))[0]
    shuffles = [source.permutation(len(own.EA)) for own in scene.groups]
    if scene.supports:
        turn = np.eye(d)
    other = replace(
        scene,
        coordinates=(scene.coordinates[order] @ turn.T) * 37.0 + source.uniform(-50, 50, d),
        groups=tuple(
            replace(own, pairs=rows[own.pairs][by][:, ::-1])
            for own, by in zip(scene.groups, shuffles, strict=True)
        ),
        supports={int(rows[row]): axes for row, axes in scene.supports.items()},
    )
    first, second = (cgff_cli.prestress(one).force_densities for one in (scene, other))
    firsts = np.cumsum([0, *(len(by) for by in shuffles)])
    undone = np.concatenate([by + first for by, first in zip(shuffles, firsts[:-1], strict=True)])
    assert second * 37.0 == pytest.approx(first[undone], rel=1e-7, abs=1e-8 * np.abs(first).max())


@pytest.mark.parametrize("name", ["levy", "stack", "tower", "net"])
def test_members_that_a_symmetry_exchanges_share_a_force_density_or_a_force(name):
    scene = OF_MANY_STATES[name]
    for equal, column in (("force density", "force_densities"), ("force", "forces")):
        found = cgff_cli.prestress(scene, by_symmetry=True, equal=equal)
        assert_held(scene, found)
        values = getattr(found, column)
        l = np.linalg.norm(np.diff(scene.coordinates[pairs_of(scene)], axis=1)[:, 0], axis=1)
        alike = np.column_stack((l, values)).round(9)
        assert len(np.unique(alike, axis=0)) <= 12
        assert found.group_states < found.self_stress_states
    free = cgff_cli.prestress(scene).force_densities
    if name != "net":  # whose lines each have a scale of their own
        assert len(np.unique(free.round(6))) <= len(np.unique(alike, axis=0))


def test_groups_share_one_force_density_where_they_can():
    found = cgff_cli.prestress(prism(4), by_group=True)
    for own in found.groups.values():
        low, high = own["force_density"]
        assert low == pytest.approx(high, rel=1e-14)
    assert found.group_states == 1
    oblong = x_module(((0, 0), (2, 0), (2, 1), (0, 1)))
    assert cgff_cli.prestress(oblong, by_group=True).feasible
    found = cgff_cli.prestress(
        oblong, by_group=True, equal="force"
    )  # its sides carry forces as their lengths
    assert (found.feasible, found.self_stress_states, found.group_states) == (False, 1, 0)
    assert found.reason.startswith("no self-stress has one force per group; without that there is 1 state")


@pytest.mark.parametrize(
    "scene",
    [
        swapped(prism(3)),
        of_one_kind(stack(3, 2), "cable"),
        grid(3, 0.0),
        prism(4, off=5.0),
        moved(dome(12, 3, levy=False), 0.05, 3),
        moved(dome(8, 2, levy=True), 0.05, 3),
    ],
)
def test_what_cannot_be_is_proven_by_a_motion(scene):
    found = cgff_cli.prestress(scene)
    if found.feasible:
        assert found.stability == "unstable"
        assert any(words.startswith("unstable: ") for words in found.warnings)
    else:
        assert_proven(scene, found)


def test_idle_members_are_told_from_those_of_the_wrong_sign():
    arm = x_module()
    scene = geometry(
        [*arm.coordinates.tolist(), [2.0, 0.5]],
        {own.name: (own.kind, own.pairs.tolist()) for own in arm.groups}
        | {"arm": ("cable", [(1, 4), (2, 4)])},
    )
    found = cgff_cli.prestress(scene)
    assert (found.never, found.idle) == (["arm: n1-n4", "arm: n2-n4"],) * 2
    assert "2 carry none in any state" in found.reason
    assert "2 of 2 in 'arm'" in found.reason
    assert_proven(scene, found)


def test_a_truss_bears_its_loads_one_way_only():
    scene = truss(4, 5.0)
    found = cgff_cli.prestress(scene)
    assert_held(scene, found)
    assert found.forces[-1] == pytest.approx(5.0 * sqrt(2.0))  # the tip's diagonal carries its load alone
    lifted = truss(4, -5.0)
    found = cgff_cli.prestress(lifted)
    assert "no forces of the right signs bear the loads" in found.reason
    v = np.array(list(found.certificate.values()))
    assert sum(v[row] @ load for row, load in lifted.loads.items()) < 0.0
    assert (signs_of(lifted) * lengthening(lifted, found.certificate) > -1e-9).all()


def test_loads_and_prestress_together_strain_no_cable_more_than_a_hundredth():
    scene = replace(OF_MANY_STATES["levy"], loads=dict.fromkeys(range(12), (0.0, 0.0, -0.5)))
    found = cgff_cli.prestress(scene)
    assert_held(scene, found)
    assert found.result.max_strain == pytest.approx(0.01, rel=1e-6)
    assert found.warnings == ()


def test_loads_that_need_more_strain_get_it_and_a_warning():
    found = cgff_cli.prestress(truss(4, 50.0))
    assert found.feasible
    assert found.warnings[0].startswith("the loads alone strain cables by 0.")
    scene = replace(OF_MANY_STATES["levy"], loads=dict.fromkeys(range(12), (0.0, 0.0, -50.0)))
    found = cgff_cli.prestress(scene)
    assert_held(scene, found)
    needed = float(found.warnings[0].split()[6].rstrip(","))
    assert found.result.max_strain == pytest.approx(2.0 * needed, rel=1e-2)


def test_a_force_sets_the_level():
    found = cgff_cli.prestress(prism(3), force={"struts": -7.0})
    assert found.groups["struts"]["force"] == pytest.approx([-7.0, -7.0], rel=1e-12)
    with pytest.raises(cgff_cli.OptionError, match="did you mean 'struts'"):
        cgff_cli.prestress(prism(3), force={"strut": 7.0})
    with pytest.raises(cgff_cli.OptionError, match="must be a number > 0"):
        cgff_cli.prestress(prism(3), force={"top": -7.0})


def test_where_loads_fix_the_forces_no_other_can_be_asked_for():
    for wanted, told in ((1.0, "is 20, and no self-stress makes it 1"), (50.0, "makes it 50")):
        found = cgff_cli.prestress(truss(4, 5.0), force={"uprights": wanted})
        assert not found.feasible
        assert told in found.reason


@pytest.mark.parametrize("law", ["paper", "hooke"])
def test_a_force_that_leaves_no_rest_length_is_refused(law):
    scene = replace(prism(3), law=law)
    group, first = {"paper": ("verticals", "bottom"), "hooke": ("struts", "struts")}[law]
    found = cgff_cli.prestress(scene, force={group: 1e5})
    assert (found.feasible, found.scene) == (False, None)
    assert f"no rest length above 0 gives '{first}: " in found.reason


def test_options_that_contradict_each_other_are_refused():
    for options, told in (
        ({"by_group": True, "by_symmetry": True}, "not by both"),
        ({"equal": "force"}, "needs members that share it"),
        ({"equal": "length", "by_group": True}, "equal must be one of"),
        ({"tolerance": 2.0}, "tolerance must be"),
        ({"force": {"struts": 1.0, "top": 1.0}}, "one force alone"),
    ):
        with pytest.raises(cgff_cli.OptionError, match=told):
            cgff_cli.prestress(prism(3), **options)


def test_an_element_without_length_is_a_mistake_of_the_scene():
    scene = replace(x_module(), coordinates=np.array([[0.0, 0], [0, 0], [1, 1], [0, 1]]))
    with pytest.raises(cgff_cli.SceneError, match=r"elements: 'ring: n0-n1' has no length"):
        cgff_cli.prestress(scene)


def test_a_large_shape_gives_what_its_stages_give():
    small, large = (cgff_cli.prestress(family("tower", stages=stages)) for stages in (3, 200))
    assert large.self_stress_states == 600
    assert large.rank_gap is None
    least = [np.abs(q).min() / np.abs(q).max() for q in (small.force_densities, large.force_densities)]
    assert least[0] == pytest.approx(least[1], rel=1e-8)
    assert cgff_cli.solve(large.scene).counts["iterations"] == 0
    cut = replace(family("tower", stages=200), groups=family("tower", stages=200).groups[1:])
    assert_proven(cut, cgff_cli.prestress(cut))


def test_what_a_symmetry_cancels_is_no_equation():
    for scene in (family("tower", stages=83), family("tower", stages=760)):
        assert cgff_cli.prestress(scene, by_symmetry=True).feasible
        cut = replace(scene, groups=scene.groups[1:])
        found = cgff_cli.prestress(cut, by_symmetry=True)
        assert found.feasible is False
        assert set(found.idle) == set(found.never)


def test_a_tolerance_is_refused_where_matrices_are_sparse():
    with pytest.raises(cgff_cli.OptionError, match="of at most 1500 elements or free directions"):
        cgff_cli.prestress(family("tower", stages=200), tolerance=1e-3)


def test_loads_on_what_is_held_change_nothing():
    scene = OF_MANY_STATES["net"]
    loaded = replace(scene, loads={0: (0.0, 0.0, -9.0)})
    assert cgff_cli.prestress(loaded).forces.tolist() == cgff_cli.prestress(scene).forces.tolist()


def test_a_shape_held_everywhere_has_a_state_for_every_element():
    scene = replace(x_module(), supports=dict.fromkeys(range(4), "xy"))
    found = cgff_cli.prestress(scene)
    assert (found.feasible, found.self_stress_states, found.mechanisms) == (True, 6, 0)


def beside_a_hanging_cable(load=-0.1):
    """Return an X-module and, apart from it, a cable of two parts that bears a load."""
    X = [[0, 0], [1, 0], [1, 1], [0, 1], [3, 0], [4, -1], [5, 0]]
    groups = {
        "ring": ("cable", [(0, 1), (1, 2), (2, 3), (3, 0)]),
        "struts": ("strut", [(0, 2), (1, 3)]),
        "hung": ("cable", [(4, 5), (5, 6)]),
    }
    return geometry(X, groups, {0: "xy", 1: "y", 4: "xy", 6: "xy"}, {5: (0.0, load)})


@pytest.mark.parametrize("is_sparse", [False, True])
def test_beside_what_loads_fix_a_force_is_still_what_is_asked_for(monkeypatch, is_sparse):
    if is_sparse:
        monkeypatch.setattr("cgff_cli.mechanics.connectivity.DENSE_ENTRIES", 0)
        monkeypatch.setattr("cgff_cli.analysis.self_stress.DENSE", 0)
    found = cgff_cli.prestress(beside_a_hanging_cable(), force={"struts": -2.0})
    assert found.forces[4:] == pytest.approx([-2.0] * 2 + [0.05 * sqrt(2)] * 2, rel=1e-7)
    assert found.stability == "stable"
    found = cgff_cli.prestress(beside_a_hanging_cable(), force={"hung": 2.0})
    assert (found.feasible, "is at most 0.0707107, and no self-stress makes it 2" in found.reason) == (
        False,
        True,
    )


def test_a_force_is_met_also_where_loads_fix_others_of_its_group():
    scene = beside_a_hanging_cable()
    ring, struts, hanging = scene.groups
    both = replace(
        ring,
        pairs=np.concatenate((ring.pairs, hanging.pairs)),
        EA=np.full(6, 1e3),
        rest_length=np.full(6, np.nan),
    )
    found = cgff_cli.prestress(replace(scene, groups=(both, struts)), force={"ring": 2.0})
    assert found.forces[:6] == pytest.approx([2.0] * 4 + [0.05 * sqrt(2)] * 2, rel=1e-6)


def test_a_force_copied_from_a_page_is_the_force_that_loads_fix():
    for digits in (0.0707107, 0.070710):
        assert cgff_cli.prestress(beside_a_hanging_cable(), force={"hung": digits}).feasible


def hung(law="hooke", load=-1.0):
    """Return a cable of two parts at right angles, EA 10: a load of 1 makes its force 1 / sqrt 2."""
    X, pairs = [[0, 0], [1, -1], [2, 0]], [(0, 1), (1, 2)]
    scene = geometry(X, {"hung": ("cable", pairs)}, {0: "xy", 2: "xy"}, {1: (0.0, load)}, law)
    return replace(scene, groups=tuple(replace(own, EA=np.full(2, 10.0)) for own in scene.groups))


@pytest.mark.parametrize(("law", "strain"), [("hooke", sqrt(0.5) / 10), ("paper", 0.05 / 0.95)])
def test_the_strain_that_loads_need_is_the_strain_that_they_get(law, strain):
    found = cgff_cli.prestress(hung(law))
    assert found.groups["hung"]["strain"] == pytest.approx([strain] * 2)
    assert f"the loads alone strain cables by {strain:.3g}," in found.warnings[-1]


def test_a_node_that_is_held_is_not_said_to_move():
    assert cgff_cli.prestress(hung(load=1.0)).reason.endswith("; it moves 'n1' the most")


def test_of_values_that_are_shared_only_sums_are_said_to_lengthen():
    assert "no cable is lengthened" in cgff_cli.prestress(hung(load=1.0)).reason
    reason = cgff_cli.prestress(hung(load=1.0), by_group=True).reason
    assert "no cable is lengthened" not in reason
    assert "all cables that share a value are together not lengthened" in reason


def test_forces_that_rest_lengths_cannot_tell_are_undecided():
    found = cgff_cli.prestress(prism(3), force={"struts": -1e-12})
    assert (found.feasible, found.rest_lengths) == (None, None)
    assert "raise the force" in found.reason


def test_a_soft_shape_in_balance_to_rounding_is_judged():
    found = cgff_cli.prestress(prism(3), force={"struts": -1e-6})
    assert (found.stability, found.super_stable, found.warnings) == ("stable", True, ())


def test_a_load_on_a_held_node_is_not_said_to_be_borne():
    scene = replace(x_module(((0, 0), (1, 0), (0.3, 0.3), (0, 1))), supports={0: "xy"}, loads={0: (1.0, 0.0)})
    assert cgff_cli.prestress(scene).reason.startswith("no self-stress has the right signs in all 6")


def test_a_force_that_loads_fix_decides_no_other_by_rounding():
    found = cgff_cli.prestress(beside_a_hanging_cable())
    assert found.forces[:4] == pytest.approx([0.05] * 4, rel=1e-7)


@pytest.mark.parametrize("tolerance", [0.1, 0.3, 0.99])
def test_no_tolerance_is_too_large_to_look_for_symmetries(tolerance):
    found = cgff_cli.prestress(solid("octahedron"), by_symmetry=True, tolerance=tolerance)
    assert found.feasible is not None
