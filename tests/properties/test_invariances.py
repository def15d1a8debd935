"""What must not matter: where a structure stands, how it is numbered, which units it is written in."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

import cgff_cli
from cgff_cli.scene.read import from_dict
from tests.shapes import STRUCTURES, distance_matrix

FREE = ["x-module", "hexagon", "prism", "octahedron"]
HELD = ["bracket", "cable-net"]
Scene = Mapping[str, Any]

seeds = st.integers(0, 2**32 - 1)
few = settings(max_examples=8, deadline=None, derandomize=True)


def read(name: str) -> Scene:
    """Return a shipped scene as plain values."""
    return yaml.safe_load((STRUCTURES / f"{name}.yaml").read_text(encoding="utf-8"))


def solve(scene: Scene, **options: object) -> "cgff_cli.Result":
    return cgff_cli.solve(from_dict(scene), **options)


@pytest.fixture(scope="module")
def original():
    """Return the result of a shipped scene, each solved once."""
    results: dict[str, cgff_cli.Result] = {}

    def get(name: str) -> "cgff_cli.Result":
        if name not in results:
            results[name] = solve(read(name))
        return results[name]

    return get


def moved(scene: Scene, turn: np.ndarray, shift: np.ndarray) -> Scene:
    """Return the scene with its start turned by (d, d) and shifted by (d,), and its loads turned."""
    nodes = {name: (turn @ point + shift).tolist() for name, point in scene["nodes"].items()}
    loads = {name: (turn @ load).tolist() for name, load in scene.get("loads", {}).items()}
    return {**scene, "nodes": nodes, **({"loads": loads} if loads else {})}


def scaled(scene: Scene, length: float, force: float) -> Scene:
    """Return the scene in units that make every length `length` and every force `force` times larger."""
    per_length = {"paper": length, "hooke": 1.0}[scene["law"]]  # paper's EA is a force per length
    elements = {
        name: {
            **group,
            "EA": group["EA"] * force / per_length,
            "rest_length": (np.array(group["rest_length"]) * length).tolist(),
        }
        for name, group in scene["elements"].items()
    }
    nodes = {name: (np.array(point) * length).tolist() for name, point in scene["nodes"].items()}
    loads = {name: (np.array(load) * force).tolist() for name, load in scene.get("loads", {}).items()}
    return {**scene, "nodes": nodes, "elements": elements, **({"loads": loads} if loads else {})}


def rotation(seed: int, d: int) -> np.ndarray:
    """Return a random proper rotation (d, d)."""
    Q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(d, d)))
    Q[:, 0] *= np.sign(np.linalg.det(Q))
    return Q


def dimension(scene: Scene) -> int:
    return len(next(iter(scene["nodes"].values())))


def assert_alike(result, reference, length=1.0, force=1.0, order=slice(None), shape=True, iterations=0):
    """Same verdict, same work, same lengths, forces and shape; in the new units and node order."""
    assert result.verdict == reference.verdict
    assert result.converged
    assert abs(result.counts["iterations"] - reference.counts["iterations"]) <= iterations
    size, strongest = reference.lengths.max(), np.abs(reference.forces).max()
    assert result.lengths / length == pytest.approx(reference.lengths, abs=1e-8 * size)
    assert result.forces / force == pytest.approx(reference.forces, abs=1e-8 * strongest)
    if shape:
        distances = distance_matrix(reference.coordinates[order])
        assert distance_matrix(result.coordinates) / length == pytest.approx(distances, abs=1e-7 * size)


@pytest.mark.parametrize("name", FREE + HELD)
@few
@given(seed=seeds)
def test_turning_and_shifting_the_start_changes_nothing(original, name, seed):
    scene = read(name)
    d = dimension(scene)
    shift = np.random.default_rng(seed).uniform(-10.0, 10.0, d)
    # One iteration more or less: rounding decides which side of the tolerance the last one ends on.
    assert_alike(solve(moved(scene, rotation(seed, d), shift)), original(name), iterations=1)


@pytest.mark.parametrize("name", FREE)
@pytest.mark.parametrize("tolerance", [1e-10, 1e-12])
def test_the_answer_moves_with_its_start_and_is_not_pushed_about_by_rounding(name, tolerance):
    # A rigid motion costs no energy, so a step amplified along one by a nearly singular tangent shows
    # in no force and no length; it shows here.
    scene = read(name)
    turn, shift = rotation(5, dimension(scene)), np.full(dimension(scene), 3.0)
    result = solve(scene, tolerance=tolerance)
    expected = result.coordinates @ turn.T + shift
    found = solve(moved(scene, turn, shift), tolerance=tolerance).coordinates
    assert found == pytest.approx(expected, abs=1e-6 * result.lengths.max())


@pytest.mark.parametrize("name", FREE + HELD)
def test_the_last_digits_cost_no_more_than_two_iterations(name):
    # Near the answer every iteration doubles the digits, down to rounding.
    usual, tight = (solve(read(name), tolerance=tolerance) for tolerance in (1e-10, 1e-12))
    assert tight.converged
    assert tight.counts["iterations"] <= usual.counts["iterations"] + 2


@pytest.mark.parametrize("name", FREE)
def test_standing_a_million_away_costs_only_the_digits_of_the_input(name):
    scene = read(name)
    here = solve(scene, tolerance=1e-12)
    far = solve(moved(scene, np.eye(dimension(scene)), np.full(dimension(scene), 1e6)), tolerance=1e-12)
    # The start loses ten digits behind the point; the answer's lengths and forces none.
    assert_alike(far, here, shape=False, iterations=1)
    assert far.lengths == pytest.approx(here.lengths, abs=1e-10 * here.lengths.max())
    assert far.residual["relative"] <= 1e-12


@pytest.mark.parametrize("name", FREE + HELD)
@few
@given(seed=seeds)
def test_reversing_elements_changes_nothing(original, name, seed):
    scene, flip = read(name), np.random.default_rng(seed)
    elements = {
        group: {**body, "pairs": [pair[::-1] if flip.random() < 0.5 else pair for pair in body["pairs"]]}
        for group, body in scene["elements"].items()
    }
    # One iteration: a reversed element's rows are added in another order.
    assert_alike(solve({**scene, "elements": elements}), original(name), iterations=1)


@pytest.mark.parametrize("name", FREE + HELD)
@few
@given(seed=seeds)
def test_renumbering_the_nodes_changes_nothing(original, name, seed):
    scene, names = read(name), list(read(name)["nodes"])
    order = np.random.default_rng(seed).permutation(len(names))
    result = solve({**scene, "nodes": {names[row]: scene["nodes"][names[row]] for row in order}})
    reference = original(name)
    assert list(result.nodes) == [names[row] for row in order]
    # One iteration: sums over nodes are taken in another order.
    assert_alike(result, reference, order=order, iterations=1)


@pytest.mark.parametrize("name", FREE + HELD)
@pytest.mark.parametrize(("length", "force"), [(2.0**10, 1.0), (1.0, 2.0**-10), (2.0**-20, 2.0**10)])
def test_units_that_differ_by_powers_of_two_give_the_same_iterations(original, name, length, force):
    # Such factors cause no rounding: everything but the scale must be the same.
    result = solve(scaled(read(name), length, force))
    assert_alike(result, original(name), length, force, iterations=0)
    assert result.energy / (length * force) == pytest.approx(original(name).energy, rel=1e-12)


@pytest.mark.parametrize("name", FREE + HELD)
@pytest.mark.parametrize(
    ("length", "force"),
    [(1e3, 1.0), (1.0, 1e-3), (1e3, 1e3), (0.0254, 4.448)],
    ids=["mm", "kN", "both", "inch"],
)
def test_other_units_change_only_the_units(original, name, length, force):
    # One iteration: these factors round.
    assert_alike(solve(scaled(read(name), length, force)), original(name), length, force, iterations=1)


@pytest.mark.parametrize("name", FREE)
def test_a_mirrored_start_gives_the_mirrored_answer(original, name):
    scene = read(name)
    mirror = np.diag([-1.0] + [1.0] * (dimension(scene) - 1))
    result = solve(moved(scene, mirror, np.zeros(dimension(scene))))
    size = original(name).lengths.max()
    assert result.coordinates @ mirror == pytest.approx(original(name).coordinates, abs=1e-6 * size)


@pytest.mark.parametrize("name", FREE + HELD)
def test_two_runs_are_the_same_to_the_last_bit(original, name):
    again = solve(read(name))
    assert np.array_equal(again.coordinates, original(name).coordinates)
    assert again.history == original(name).history
