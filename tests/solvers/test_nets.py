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
from cgff_cli.solvers.preconditioners.planes import local_frames
from cgff_cli.solvers.preconditioners.sparse import SparseTangent
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
    state = mechanics.at(mechanics.start)
    M = NodeFrames(mechanics, "superlu")
    M.refresh(state)
    d, m = state.X.shape
    Q = np.zeros((d, m, d, m))  # rows: local direction, node; columns: axis, node
    Q[:, np.arange(m), :, np.arange(m)] = M.frames.transpose(2, 0, 1)
    Q = Q.reshape(d * m, d * m)
    local = Q @ state.dense_tangent() @ Q.T
    direction = np.repeat(np.arange(d), m)
    lower = np.where(direction[:, None] >= direction[None, :], local, 0.0)
    diagonal = np.where(direction[:, None] == direction[None, :], local, 0.0)
    sweep = lower @ np.linalg.solve(diagonal, lower.T)
    g = np.random.default_rng(0).normal(size=(d, m))
    x = np.linalg.solve(sweep, Q @ g.reshape(-1))
    assert M.apply(g).reshape(-1) == pytest.approx(Q.T @ x, abs=1e-9 * np.abs(x).max())


@pytest.mark.parametrize("shear", [0.0, 0.5])
def test_tangents_of_a_skew_flat_net_stretch_hardly_more_than_one_family_of_cables_each(shear):
    structure = net(side=20, rise=0.0)
    X = structure.coordinates + shear * structure.coordinates[:, [1]] * [1.0, 0.0, 0.0]
    mechanics = Mechanics(replace(structure, coordinates=X))
    state = mechanics.at(mechanics.start)
    pattern = NodeFrames(mechanics, "superlu").pattern
    u = state.V / state.l
    first, second, normal = local_frames(pattern, mechanics.k, u)
    along_x, skew = u[:, 0], u[:, -1]
    assert np.abs(normal[2]) == pytest.approx(np.ones(pattern.size))
    most = 0.3 * abs(skew @ along_x) + 2e-3
    assert skew @ first == pytest.approx(np.zeros(pattern.size), abs=most)
    assert along_x @ second == pytest.approx(np.zeros(pattern.size), abs=most)


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


@pytest.mark.parametrize("EA", [1e4, 1e7])
def test_a_long_stiff_chain_comes_to_rest(EA):
    chain = from_scene(cgff_cli.new("catenary", links=120, EA=EA, law="hooke"))
    found = form_find(chain, SolveOptions())
    assert found.verdict.converged
    assert found.coordinates[60] == pytest.approx([5.0, -2.0], abs=1e-6)


def test_the_tangent_takes_over_from_frames_that_make_no_headway():
    slack = net(side=25, jitter=0.05, prestress=1.0, seed=1)
    relieved = form_find(slack, SolveOptions())
    assert relieved.verdict.converged
    assert relieved.iterations < 60


@pytest.mark.parametrize("jitter", [0.0, 0.01])
@pytest.mark.parametrize("prestress", [100.0, 1.0, 1e-2, 1e-4])
def test_a_net_is_found_however_little_it_is_strained(prestress, jitter):
    structure = net(side=25, prestress=prestress, jitter=jitter, seed=1)
    found = form_find(structure, SolveOptions())
    assert found.verdict.converged
    assert found.iterations < 60
    assert found.slack.any() == (jitter > 0.0 and prestress < 100.0)


def test_ctrl_c_on_the_way_to_a_better_start_leaves_the_start(monkeypatch):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(NodeFrames, "better_start", interrupted)
    structure = net(side=15)
    found = form_find(structure, SolveOptions())
    assert found.verdict == "interrupted"
    assert found.iterations == 0
    assert found.coordinates == pytest.approx(structure.coordinates, abs=1e-12)
