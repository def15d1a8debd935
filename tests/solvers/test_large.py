"""Large scenes: the sparse preconditioners say what the dense one says, at any size."""

from dataclasses import replace

import numpy as np
import pytest

import cgff_cli
from cgff_cli.analysis.large import stability_of_large
from cgff_cli.mechanics.rigid import all_motions
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.cgff import form_find
from cgff_cli.solvers.preconditioners import choose
from cgff_cli.solvers.preconditioners.dense import DenseTangent
from cgff_cli.solvers.preconditioners.frames import NodeFrames
from cgff_cli.solvers.preconditioners.sparse import SparseTangent
from cgff_cli.structure import from_scene
from tests.bodies import body, random_body
from tests.shapes import distance_matrix

FACTORS = ["superlu", pytest.param("cholmod", marks=pytest.mark.needs_cvxopt)]


def net(**parameters):
    return from_scene(cgff_cli.new("net", **parameters))


def tower(stages, **parameters):
    return from_scene(cgff_cli.new("tower", stages=stages, **parameters))


def test_the_preconditioner_follows_from_the_scene():
    options = SolveOptions()
    assert isinstance(choose(Mechanics(tower(3)), options), DenseTangent)
    assert isinstance(choose(Mechanics(tower(100)), options), SparseTangent)
    assert isinstance(choose(Mechanics(net(side=20)), options), NodeFrames)
    assert isinstance(choose(Mechanics(net(side=20)), replace(options, objective="residual")), SparseTangent)


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize("name", ["x-module", "hexagon", "prism", "octahedron", "bracket", "cable-net"])
def test_small_scenes_solved_as_large_ones_end_in_the_same_shape(every_scene_is_large, name, factor):
    scene = cgff_cli.load(f"structures/{name}.yaml")
    large = form_find(from_scene(scene), SolveOptions(factor=factor, tolerance=1e-11))
    assert large.verdict.converged
    small = cgff_cli.solve(scene, analysis="never")
    assert large.energy == pytest.approx(small.energy, rel=1e-9)
    size = small.lengths.max()
    assert distance_matrix(large.coordinates) == pytest.approx(
        distance_matrix(small.coordinates), abs=1e-7 * size
    )


def test_the_pins_of_a_floating_body_carry_no_force():
    structure = tower(12)
    mechanics = Mechanics(structure)
    state = mechanics.at(mechanics.start)
    M = SparseTangent(mechanics, False, "superlu")
    M.mu = 0.0
    M.refresh(state)
    R, _ = np.linalg.qr(all_motions(state.X))
    g = np.random.default_rng(0).normal(size=state.X.size)
    g -= R @ (R.T @ g)
    z = M.apply(g.reshape(state.X.shape)).reshape(-1)
    assert state.dense_tangent() @ z == pytest.approx(g, abs=1e-6)
    assert R.T @ z == pytest.approx(np.zeros(6), abs=1e-6 * np.abs(z).max())


@pytest.mark.parametrize("factor", FACTORS)
def test_a_tower_of_300_stages_is_found_and_stands_where_it_stood(factor):
    exact = tower(300)
    lengths = np.linalg.norm(exact.coordinates[exact.start] - exact.coordinates[exact.end], axis=1)
    found = form_find(tower(300, noise=0.05, seed=1), SolveOptions(factor=factor))
    assert found.verdict.converged
    assert found.iterations < 30
    assert found.lengths == pytest.approx(lengths, rel=1e-9)
    assert found.coordinates.mean(axis=0) == pytest.approx(exact.coordinates.mean(axis=0), abs=0.1)


def test_an_upright_mast_of_many_struts_falls_over_and_is_then_called_stable(every_scene_is_large):
    points = [[0.0, 0.0, 1.0 * row] for row in range(8)]
    bars = [(row, row + 1, "strut", 100.0, 1.0) for row in range(7)]
    mast = body(points, bars, {0: "xyz"}, {7: (0.0, 0.0, -1.0)})
    found = form_find(mast, SolveOptions(factor="superlu"))
    assert found.verdict.converged
    assert found.coordinates[-1, 2] == pytest.approx(-7.07, abs=1e-6)
    assert stability_of_large(found.state, "superlu", found.balance.floor)["stability"] == "stable"
    upright = form_find(mast, SolveOptions(objective="residual", factor="superlu"))
    assert stability_of_large(upright.state, "superlu", upright.balance.floor)["stability"] == "unstable"


def test_forces_left_over_do_not_hide_a_way_down(every_scene_is_large):
    # Two struts in line, pressed; two soft ones across just fail to hold the node between them.
    points = [[-1.0, 0.0], [1e-3, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]
    bars = [(0, 1, "strut", 100.0, 1.01), (1, 2, "strut", 100.0, 1.01)]
    bars += [(1, row, "strut", 0.99, 1.0) for row in (3, 4)]
    mechanics = Mechanics(body(points, bars, dict.fromkeys((0, 2, 3, 4), "xy")))
    state = mechanics.at(mechanics.start)
    d = SparseTangent(mechanics, False, "superlu").steepest_fall(state)
    assert abs(d[1, 0]) == pytest.approx(1.0, abs=1e-3)
    assert -1e-3 < np.vdot(d, state.tangent_times(d)) < 0.0
    assert state.norm > 1e-3


def test_large_and_small_agree_on_what_is_stable(every_scene_is_large):
    triangle = body(
        [[0, 0], [1, 0], [0.5, 0.9]], [(i, j, "strut", 1.0, 1.0) for i, j in ((0, 1), (1, 2), (2, 0))]
    )
    slack = body(
        [[0, 0], [0.2, 0.1], [1, 0]],
        [(0, 1, "cable", 1.0, 1.0), (1, 2, "cable", 1.0, 1.0)],
        {0: "xy", 2: "xy"},
    )
    square = body([[0, 0], [1, 0], [1, 1], [0, 1]], [(i, (i + 1) % 4, "strut", 1.0, 1.0) for i in range(4)])
    kinds = []
    for structure in (triangle, slack, square):
        found = form_find(structure, SolveOptions(factor="superlu"))
        kinds.append(stability_of_large(found.state, "superlu", found.balance.floor)["stability"])
    assert kinds == ["stable", "neutral", "neutral"]


def test_a_large_cable_within_rounding_of_its_rest_length_ties_nothing(every_scene_is_large):
    hanging = body([[0, 0], [0.1 + 0.2, 0]], [(0, 1, "cable", 1.0, 0.3)], {0: "xy"})
    found = form_find(hanging, SolveOptions(factor="superlu"))
    assert found.verdict.converged
    assert stability_of_large(found.state, "superlu", found.balance.floor)["stability"] == "neutral"


def test_a_taut_large_cable_between_rollers_is_stable(every_scene_is_large):
    sliders = body(
        [[0, 1], [1, 0]],
        [(0, 1, "cable", 10.0, 1.2)],
        {0: "x", 1: "y"},
        {0: (0.0, 1.0), 1: (1.0, 0.0)},
    )
    found = form_find(sliders, SolveOptions(factor="superlu"))
    assert found.verdict.converged
    assert stability_of_large(found.state, "superlu", found.balance.floor)["stability"] == "stable"


def test_the_same_large_scene_gives_the_same_bits_twice():
    structure = net(side=25, jitter=0.02, seed=5)
    first, second = (form_find(structure, SolveOptions()).coordinates for _ in range(2))
    assert first.tobytes() == second.tobytes()


def test_parts_that_float_apart_are_all_solved(every_scene_is_large):
    one = random_body(7, held=False, loaded=False, kinds=("strut",))
    n = len(one.coordinates)
    both = replace(
        one,
        coordinates=np.concatenate((one.coordinates, one.coordinates + 5.0)),
        start=np.concatenate((one.start, one.start + n)),
        end=np.concatenate((one.end, one.end + n)),
        stiffness=np.tile(one.stiffness, 2),
        rest_lengths=np.tile(one.rest_lengths, 2),
        tension_only=np.tile(one.tension_only, 2),
        free=np.tile(one.free, (2, 1)),
        loads=np.tile(one.loads, (2, 1)),
    )
    found = form_find(both, SolveOptions(factor="superlu"))
    assert found.verdict.converged


@pytest.mark.parametrize("factor", FACTORS)
def test_a_long_tower_far_off_comes_to_rest_whatever_the_factor(factor):
    # SuperLU factors indefinite matrices too: one that was not looked at led nowhere.
    exact, far = tower(1000), tower(1000, noise=0.2, seed=1)
    found = form_find(far, SolveOptions(factor=factor))
    assert found.verdict.converged
    assert found.iterations < 60
    lengths = np.linalg.norm(exact.coordinates[exact.start] - exact.coordinates[exact.end], axis=1)
    assert found.lengths == pytest.approx(lengths, rel=1e-6)
