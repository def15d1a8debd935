"""The softest motions: eigenvectors of K without rigid motions, dense and by Lanczos' method alike."""

import numpy as np
import pytest

import cgff_cli
from cgff_cli.analysis.modes import softest_modes
from cgff_cli.mechanics import connectivity
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.structure import from_scene
from tests.bodies import tangent_by_complex_steps
from tests.solvers.scenes import pendulum, shipped, truss


def modes(scene, count, *, sparse=False, monkeypatch=None, **options):
    """Return the modes of a scene's answer, and the answer."""
    solution = cgff_cli.solve(scene, tolerance=1e-13, analysis="never", **options).solution
    if sparse:
        monkeypatch.setattr(connectivity, "DENSE_ENTRIES", 0)
    state = Mechanics(from_scene(scene)).at(solution.state.X)
    return softest_modes(state, solution.balance.floor, count, "superlu"), solution


@pytest.mark.parametrize("name", ["prism", "octahedron", "hexagon", "x-module", "bracket", "cable-net"])
def test_modes_are_the_least_eigenvectors_of_the_tangent_without_rigid_motions(name):
    (stiffnesses, shapes, is_found), solution = modes(shipped(name), 4)
    structure = solution.mechanics.structure
    K = tangent_by_complex_steps(structure, solution.coordinates)
    rigid = 0 if not structure.free.all() else {2: 3, 3: 6}[structure.free.shape[1]]
    largest = np.abs(K).max()
    assert is_found
    assert stiffnesses == pytest.approx(
        np.linalg.eigvalsh(K)[rigid:][: len(stiffnesses)], abs=1e-10 * largest
    )
    free = shapes.reshape(len(shapes), -1)[:, structure.free.reshape(-1)]
    assert free @ free.T == pytest.approx(np.eye(len(free)))
    assert free @ K == pytest.approx(stiffnesses[:, None] * free, abs=1e-9 * largest)
    assert not shapes[:, ~structure.free].any()


@pytest.mark.parametrize(
    ("family", "parameters"),
    [
        ("prism", {}),
        ("tower", {"stages": 20}),
        ("tower", {"stages": 60}),
        ("net", {"side": 9}),
        ("snake", {"modules": 12}),
        ("polyhedron", {"kind": "icosahedron"}),
    ],
)
def test_equally_soft_motions_are_all_found_among_sparse_factors_too(family, parameters, monkeypatch):
    scene = cgff_cli.new(family, **parameters)
    dense, _ = modes(scene, 6)
    sparse, _ = modes(scene, 6, sparse=True, monkeypatch=monkeypatch)
    assert sparse.is_found
    assert sparse.stiffnesses == pytest.approx(dense.stiffnesses, rel=1e-7)


@pytest.mark.parametrize("sparse", [False, True])
def test_an_unstable_motion_comes_first_and_is_negative(sparse, monkeypatch):
    found, _ = modes(truss(0.1), 3, sparse=sparse, monkeypatch=monkeypatch, objective="residual")
    # The level truss: across 2 k (1 - l0 / l), along 2 k.
    assert found.stiffnesses == pytest.approx([-40.0, 200.0])
    assert found.shapes[:, 2] == pytest.approx(np.eye(2)[::-1], abs=1e-7)


def test_a_rigid_motion_that_a_load_resists_is_a_mode():
    found, _ = modes(pendulum(-1.0), 5)
    assert found.stiffnesses[0] == pytest.approx(1.0 / 1.01)


def test_what_cannot_move_has_no_modes():
    scene = cgff_cli.from_dict(
        {
            "law": "paper",
            "nodes": {"a": [0, 0], "b": [1, 0]},
            "elements": {"bar": {"kind": "strut", "EA": 1, "rest_length": 1, "pairs": [["a", "b"]]}},
        }
    )
    found, _ = modes(scene, 3)
    assert found.shapes.shape == (1, 2, 2)
    assert found.stiffnesses == pytest.approx([2.0])
