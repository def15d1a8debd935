"""Coordinates as given: counts and words by theory, and what is told where forces do not balance."""

from dataclasses import replace

import numpy as np
import pytest

import cgff_cli
from cgff_cli.mechanics import connectivity
from tests.analysis.known import KNOWN, Known
from tests.bodies import scene, tangent_by_complex_steps
from tests.closed_forms.references import prism
from tests.solvers.scenes import shipped, truss


@pytest.fixture(params=[False, True], ids=["dense", "sparse"])
def entries(request, monkeypatch):
    """Let every structure be small, then large."""
    if request.param:
        monkeypatch.setattr(connectivity, "DENSE_ENTRIES", 0)
    return request.param


@pytest.mark.parametrize("known", KNOWN, ids=[known.name for known in KNOWN])
def test_states_mechanisms_and_stability_are_those_of_theory(known: Known, entries):
    found = cgff_cli.analyse(known.scene)
    told = found.analysis
    assert found.balanced, found.message
    assert (told["self_stress_states"], told["mechanisms"]) == (known.states, known.mechanisms), known.why
    assert told["stability"] == known.word
    assert told["negative_eigenvalues"] == known.unstable
    if not entries or known.word == "stable":  # mechanisms of large ones are not known one by one
        assert told["prestress_stable"] is known.stiffened
    assert told["parts"] == 1
    factor = told["critical_load_factor"]
    assert factor is None or 1e-6 < factor < 1e6
    assert {name for name, value in told.items() if value is None} == set(told["reason"])


@pytest.mark.parametrize("known", KNOWN, ids=[known.name for known in KNOWN])
def test_a_geometry_has_the_same_states_and_mechanisms(known: Known, entries):
    lengths = np.full(known.scene.element_count, np.nan)
    of = known.scene.groups[0].name
    found = cgff_cli.analyse(known.scene.with_rest_lengths(lengths), sensitivity=of)
    told = found.analysis
    assert "no rest lengths" in found.sensitivity[of].reason
    assert (told["self_stress_states"], told["mechanisms"]) == (known.states, known.mechanisms)
    assert (found.balanced, found.residual, told["stable"]) == (None, None, None)
    assert "no rest lengths" in told["reason"]["stable"]
    assert {mode["stiffness"] for mode in told["modes"]} <= {None}


@pytest.mark.parametrize("known", KNOWN, ids=[known.name for known in KNOWN])
def test_mechanisms_change_no_length_and_are_no_rigid_motion(known: Known):
    X, structure = known.scene.coordinates, cgff_cli.analyse(known.scene).result.structure
    modes = cgff_cli.analyse(known.scene, modes=99).analysis["modes"]
    shapes = [np.array(list(mode["shape"].values())) for mode in modes if mode["kind"] == "mechanism"]
    assert len(shapes) == known.mechanisms
    for shape in shapes:
        ends = structure.start, structure.end
        V, Z = (own[ends[0]] - own[ends[1]] for own in (X, shape))
        assert (V * Z).sum(axis=1) == pytest.approx(np.zeros(len(V)), abs=1e-9)
        every = [(i, j) for i in range(len(X)) for j in range(i)]
        apart = np.array([(X[i] - X[j]) @ (shape[i] - shape[j]) for i, j in every])
        held = ~structure.free.any(axis=1)
        assert np.abs(apart).max() > 1e-3 or held.any() or np.ptp(X, axis=0).min() == 0.0


def test_the_stiffness_of_the_prisms_mechanism_is_its_stress_along_the_twist():
    # n = 3: the mechanism turns top against bottom and lifts it; x' D x over x' x, by hand from q.
    body = prism(3)
    found = cgff_cli.analyse(cgff_cli.from_dict(body.scene("paper"))).analysis["modes"][0]
    shape = np.array(list(found["shape"].values()))
    members = [(pair, own.q) for own in body.groups.values() for pair in own.pairs]
    by_hand = sum(q * ((shape[i] - shape[j]) ** 2).sum() for (i, j), q in members)
    assert found["kind"] == "mechanism"
    assert found["stiffness"] == pytest.approx(by_hand)
    assert found["stiffness"] > 0.1
    assert sorted(found["main_nodes"]) == [f"n{row}" for row in range(6)]
    assert np.linalg.norm(shape) == pytest.approx(1.0)


def test_out_of_balance_it_is_told_where_and_what_can_be_is_told():
    found = cgff_cli.analyse(shipped("prism"))
    assert found.balanced is False
    assert found.message.startswith("the forces do not balance: out-of-balance force ")
    assert found.message.endswith("at node 'n6'")
    told = found.analysis
    assert (told["self_stress_states"], told["mechanisms"]) == (0, 2)  # two cables are slack
    X = found.result.coordinates
    K = tangent_by_complex_steps(found.result.structure, X)
    turns = [np.cross(axis, X - X.mean(axis=0)) for axis in np.eye(3)]
    rigid = np.array([*(np.ones((6, 1)) * axis for axis in np.eye(3)), *turns]).reshape(6, -1)
    apart = np.linalg.qr(rigid.T, mode="complete")[0][:, 6:]
    known = np.linalg.eigvalsh(apart.T @ K @ apart)[:6]
    assert told["tangent_eigenvalues"] == pytest.approx(known, rel=1e-9)
    assert [mode["kind"] for mode in told["modes"]] == ["mechanism"] * 2 + ["softest"] * 3
    assert [told[name] for name in ("stable", "prestress_stable", "critical_load_factor")] == [None] * 3


def test_a_result_is_judged_at_its_answer():
    result = cgff_cli.solve(shipped("octahedron"))
    found = cgff_cli.analyse(result)
    assert found.balanced is True
    assert found.analysis["smallest_stiffness"] == pytest.approx(result.analysis["smallest_stiffness"])
    assert found.analysis["tangent_eigenvalues"][0] == found.analysis["modes"][-3]["stiffness"]
    same = ("stable", "super_stable", "self_stress_states", "mechanisms", "nullity_D", "slack_count")
    assert [found.analysis[name] for name in same] == [result.analysis[name] for name in same]


@pytest.mark.parametrize("counts", [0, 1, 50])
def test_so_many_modes_are_told_as_are_asked_for(counts, entries):
    found = cgff_cli.analyse(cgff_cli.solve(shipped("x-module")), modes=counts).analysis["modes"]
    assert len(found) == min(counts, 5)  # four nodes of the plane, three rigid motions, no mechanism


def test_out_of_balance_the_signs_are_those_of_the_shape_as_it_is(entries):
    found = cgff_cli.analyse(shipped("bracket"))
    told = found.analysis
    assert found.message.endswith("at node 'tip'")
    assert told["negative_eigenvalues"] == 1
    assert told["tangent_eigenvalues"][0] < 0.0


def flat_triangles(*sizes):
    """Return triangles apart, nearly flat: of each the least singular value of U is the size given."""
    share = np.linalg.svd(unit_columns(1e-3), compute_uv=False)[-1] / 1e-3
    points, bars = [], []
    for row, size in enumerate(sizes):
        own = [(0.0, 9.0 * row), (1.0, 9.0 * row + size / share), (2.5, 9.0 * row)]
        for i, j in ((0, 1), (1, 2), (2, 0)):
            length = float(np.hypot(*np.subtract(own[i], own[j])))
            bars.append((3 * row + i, 3 * row + j, "strut", 1.0, length))
        points += own
    return scene(points, bars)


def unit_columns(h):
    """Return U of one triangle, its columns of unit vectors at either end."""
    X, U = np.array([(0.0, 0.0), (1.0, h), (2.5, 0.0)]), np.zeros((6, 3))
    for column, (i, j) in enumerate(((0, 1), (1, 2), (2, 0))):
        u = (X[i] - X[j]) / np.linalg.norm(X[i] - X[j])
        U[2 * i : 2 * i + 2, column], U[2 * j : 2 * j + 2, column] = u, -u
    return U


@pytest.mark.parametrize(
    ("sizes", "count"),
    [
        ((1e-3, 1e-3), 6 - 3),
        ((1e-3, 1e-13), 6 - 2),
        ((2e-9,), None),
        ((5e-9, 0.8e-9), None),
        ((5e-8, 5e-10), 4),
    ],
)
def test_a_rank_that_the_tolerance_alone_would_decide_is_null(sizes, count):
    # Two parts are free of each other: three mechanisms of the whole, and one for each that is flat.
    found = cgff_cli.analyse(flat_triangles(*sizes)).analysis
    assert found["rank_tolerance"] == 1e-9
    assert found["mechanisms"] == count
    if count is None:
        assert "rank tolerance" in found["reason"]["mechanisms"]


def test_an_element_without_length_is_refused():
    body = replace(truss(0.5), coordinates=np.zeros((3, 2)))
    with pytest.raises(cgff_cli.SceneError, match="element without length: e0: n0-n2, e1: n1-n2"):
        cgff_cli.analyse(body)


def test_what_is_held_everywhere_has_no_motion(entries):
    bar = scene([(0.0, 0.0), (2.0, 0.0)], [(0, 1, "strut", 10.0, 1.0)], {0: "xy", 1: "xy"})
    told = cgff_cli.analyse(bar, sensitivity="e0").analysis
    assert (told["modes"], told["tangent_eigenvalues"], told["stability"]) == ([], [], "stable")
    assert told["self_stress_states"] == 1


@pytest.mark.parametrize("modes", [-1, 1.5, "3"])
def test_modes_must_be_a_count(modes):
    with pytest.raises(cgff_cli.OptionError, match="modes must be a whole number >= 0"):
        cgff_cli.analyse(shipped("prism"), modes=modes)
