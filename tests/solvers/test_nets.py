"""Anchored nets: the force density start, frames at the nodes, and what takes their place."""

from dataclasses import replace

import numpy as np
import pytest

import cgff_cli
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.cgff import form_find
from cgff_cli.solvers.preconditioners import choose
from cgff_cli.solvers.preconditioners.frames import NodeFrames
from cgff_cli.solvers.preconditioners.sparse import SparseTangent
from cgff_cli.solvers.tightening import fit, tightened
from cgff_cli.structure import from_scene
from tests.bodies import body

FACTORS = ["superlu", pytest.param("cholmod", marks=pytest.mark.needs_cvxopt)]


def net(**parameters):
    return from_scene(cgff_cli.new("net", **parameters))


def test_frames_are_for_nets_of_cables_with_nodes_held_or_free_and_every_part_held():
    structure = net(side=20)
    options = SolveOptions(preconditioner="frames")
    with_a_strut = structure.tension_only.copy()
    with_a_strut[5] = False
    half_held = structure.free.copy()
    half_held[np.flatnonzero(structure.free[:, 0])[0], 2] = False
    adrift = np.ones_like(structure.free)
    for changed in (
        replace(structure, tension_only=with_a_strut),
        replace(structure, free=half_held),
        replace(structure, free=adrift),
    ):
        assert isinstance(choose(Mechanics(changed), options), SparseTangent)


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize(
    "parameters", [{"jitter": 0.01}, {"jitter": 0.05}, {"jitter": 0.05, "snow": 0.05}], ids=str
)
def test_a_net_comes_to_rest_whatever_its_jitter_slack_and_snow(factor, parameters):
    structure = net(side=25, seed=2, **parameters)
    found = form_find(structure, SolveOptions(factor=factor))
    assert found.verdict.converged
    tangent = form_find(structure, SolveOptions(preconditioner="tangent", factor=factor, max_iterations=500))
    assert tangent.verdict.converged
    assert found.energy == pytest.approx(tangent.energy, rel=1e-9)


def test_iterations_of_a_taut_net_do_not_grow_with_its_size():
    counts = [
        form_find(net(side=side, prestress=100.0, jitter=0.02, seed=1), SolveOptions()).iterations
        for side in (15, 30, 60)
    ]
    assert max(counts) <= 2 * min(counts)


def test_frames_precondition_with_a_gauss_seidel_sweep_over_k_in_their_own_axes():
    structure = net(side=12, jitter=0.02, seed=4, start="saddle", prestress=100.0)
    mechanics = Mechanics(structure)
    state = mechanics.at(structure.coordinates)
    M = NodeFrames(mechanics, "superlu")
    M.refresh(state)
    n, d = structure.coordinates.shape
    free = np.flatnonzero(structure.free[:, 0])
    m = len(free)
    Q = np.zeros((d, m, n, d))  # rows: local direction, free node; columns: node, axis
    Q[:, np.arange(m), free] = M.frames
    Q = Q.reshape(d * m, n * d)
    K = np.zeros((n * d, n * d))
    held = structure.free.reshape(-1)
    K[np.ix_(held, held)] = state.dense_tangent()
    local = Q @ K @ Q.T
    direction = np.repeat(np.arange(d), m)
    lower = np.where(direction[:, None] >= direction[None, :], local, 0.0)
    diagonal = np.where(direction[:, None] == direction[None, :], local, 0.0)
    sweep = lower @ np.linalg.solve(diagonal, lower.T)
    g = np.zeros((n, d))
    g[structure.free] = np.random.default_rng(0).normal(size=int(structure.free.sum()))
    x = np.linalg.solve(sweep, Q @ g.reshape(-1))
    assert M.apply(g).reshape(-1) == pytest.approx(Q.T @ x, abs=1e-9 * np.abs(x).max())


@pytest.mark.parametrize("factor", FACTORS)
def test_a_net_that_is_drawn_into_its_one_anchor_comes_to_rest(every_scene_is_large, factor):
    points = [[0.1 * i, 0.1 * j] for i in range(4) for j in range(4)]
    pairs = [(4 * i + j, 4 * i + j + 1) for i in range(4) for j in range(3)]
    pairs += [(4 * i + j, 4 * i + 4 + j) for i in range(3) for j in range(4)]
    loose = body(points, [(i, j, "cable", 1.0, 0.1) for i, j in pairs], {0: "xy"})
    found = form_find(loose, SolveOptions(factor=factor))
    assert found.verdict.converged
    assert found.factorizations < 10


def test_a_long_soft_chain_hangs_near_its_force_density_start():
    chain = from_scene(cgff_cli.new("catenary", links=1000, EA=20.0, law="hooke"))
    found = form_find(chain, SolveOptions())
    assert found.verdict.converged
    assert found.iterations < 15
    assert found.factorizations < 5


def test_a_long_stiff_chain_is_left_to_the_tangent_from_its_own_start():
    chain = from_scene(cgff_cli.new("catenary", links=120, EA=1e7, law="hooke"))
    stiff = form_find(chain, SolveOptions())
    tangent = form_find(chain, SolveOptions(preconditioner="tangent"))
    assert stiff.verdict.converged
    assert stiff.coordinates.tobytes() == tangent.coordinates.tobytes()


def test_the_tangent_takes_over_from_frames_that_make_no_headway():
    slack = net(side=15, jitter=0.05, prestress=1.0, seed=1)
    relieved = form_find(slack, SolveOptions())
    assert relieved.verdict.converged
    assert relieved.iterations < 100
    held_to = form_find(slack, SolveOptions(preconditioner="frames", max_iterations=500))
    assert relieved.energy == pytest.approx(held_to.energy, rel=1e-9)
    assert relieved.iterations < 0.7 * held_to.iterations


@pytest.mark.parametrize("prestress", [100.0, 1.0, 1e-2, 1e-4])
def test_iterations_do_not_grow_as_an_even_net_is_strained_less(prestress):
    found = form_find(net(side=25, prestress=prestress, seed=1), SolveOptions())
    assert found.verdict.converged
    assert found.iterations < 18
    assert not found.state.slack.any()


def test_lengths_fit_where_they_scatter_less_than_cables_are_strained():
    structure = net(side=15, prestress=100.0)
    even = fit(1.09 * structure.rest_lengths, structure)
    assert even.strain == pytest.approx(0.09)
    assert even.scatter == pytest.approx(0.0, abs=1e-12)
    assert even.is_good
    assert not even.can_tighten
    uneven = fit(structure.rest_lengths * np.resize([0.99, 1.02], len(structure.rest_lengths)), structure)
    assert uneven.can_tighten
    hanging = fit(structure.rest_lengths * np.resize([0.7, 0.9], len(structure.rest_lengths)), structure)
    assert hanging.is_loose
    assert not hanging.can_tighten


def test_a_tightened_net_fits_the_lengths_it_was_tightened_for():
    structure = net(side=15)
    l = structure.rest_lengths * np.resize([0.99, 1.02], len(structure.rest_lengths))
    tight = tightened(structure, fit(l, structure))
    assert fit(l, tight).strain == pytest.approx(fit(l, tight).wanted, rel=0.1)


@pytest.mark.parametrize("factor", FACTORS)
def test_by_way_of_tighter_nets_the_shape_is_the_one_that_the_tangent_finds(factor):
    structure = net(side=14, prestress=0.1, jitter=0.002, seed=3)
    found = form_find(structure, SolveOptions(factor=factor))
    tangent = form_find(structure, SolveOptions(preconditioner="tangent", factor=factor, max_iterations=500))
    assert found.verdict.converged
    assert tangent.verdict.converged
    assert found.energy == pytest.approx(tangent.energy, rel=1e-8)
    assert found.iterations < tangent.iterations


def test_ctrl_c_on_the_way_to_a_better_start_leaves_the_start(monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(NodeFrames, "better_start", interrupted)
    structure = net(side=15)
    found = form_find(structure, SolveOptions())
    assert found.verdict == "interrupted"
    assert found.iterations == 0
    assert found.coordinates == pytest.approx(structure.coordinates, abs=1e-12)
