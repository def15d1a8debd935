"""The record of a comparison: its fields, alignment, curves and what they are measured by."""

from itertools import pairwise

import numpy as np
import pytest

import cgff_cli
from cgff_cli.rivals.task import TOLERANCES
from cgff_cli.study.alignment import affinely, distance_difference, laid_over, rigidly
from cgff_cli.study.record import Comparison
from tests.shapes import STRUCTURES

PRISM = STRUCTURES / "prism.yaml"

FIELDS = {
    "name",
    "verdict",
    "converged",
    "stable",
    "iterations",
    "evaluations",
    "seconds",
    "residual_relative",
    "energy",
    "alignment",
    "nodes",
    "lengths",
    "force_densities",
    "max_node_difference",
    "max_length_difference",
    "distance_matrix_difference",
    "curve",
}
"""Those of a method, as the schema lists them."""


@pytest.fixture(scope="module")
def prism() -> Comparison:
    return cgff_cli.compare(PRISM, ["fdm", "lm", "lbfgs", "table1"], repeat=2)


def test_the_fields_are_those_of_the_schema(prism: Comparison):
    record = prism.to_dict()
    assert record["schema"] == "cgff-compare/1"
    assert set(record["scene"]) == {"name", "path", "law", "dimension"}
    assert set(record["reference"]) == {"verdict", "residual_relative", "energy", "nodes"}
    for method in record["methods"]:
        assert set(method) >= FIELDS
        assert [set(point) for point in method["curve"]] == [
            {"tolerance", "iterations", "seconds", "shape_error"}
        ] * 11


def test_cgff_comes_first_and_every_method_once(prism: Comparison):
    assert [method.name for method in prism.methods] == ["cgff", "fdm", "lm", "lbfgs", "table1"]
    again = cgff_cli.compare(PRISM, ["lm", "cgff", "lm"], repeat=1)
    assert [method.name for method in again.methods] == ["cgff", "lm"]


def test_cgff_is_what_solve_finds(prism: Comparison):
    result = cgff_cli.solve(PRISM, tolerance=1e-12)
    own = prism.methods[0]
    assert own.nodes == result.nodes
    assert (own.iterations, own.evaluations) == (result.counts["iterations"], result.counts["evaluations"])
    assert own.lengths == pytest.approx(result.lengths.tolist(), rel=1e-15)
    assert own.max_node_difference == own.distance_matrix_difference == 0.0


def test_shapes_lie_over_each_other_though_some_are_turned_or_mirrored(prism: Comparison):
    own, *others = prism.methods
    target = np.array(list(own.nodes.values()))
    for method in others[:3]:
        X = np.array(list(method.nodes.values()))
        assert np.linalg.norm(X - target, axis=1).max() == pytest.approx(
            method.max_node_difference, abs=1e-15
        )
        assert method.max_node_difference < 1e-6
    assert [method.alignment for method in prism.methods] == ["rigid", "affine", "rigid", "rigid", "rigid"]


def test_a_curve_falls_from_1e_2_to_1e_12_and_time_rises_along_it(prism: Comparison):
    curve = prism.methods[0].curve
    assert [point.tolerance for point in curve] == list(TOLERANCES)
    assert TOLERANCES[0] == 1e-2
    assert TOLERANCES[-1] == 1e-12
    for earlier, later in pairwise(curve):
        assert earlier.iterations <= later.iterations
        assert earlier.seconds <= later.seconds
    assert curve[0].shape_error > curve[-1].shape_error
    assert curve[-1].shape_error < 1e-12
    assert curve[-1].iterations == prism.methods[0].iterations


def test_what_was_never_reached_is_none(prism: Comparison):
    lbfgs, table1 = prism.methods[3:]
    assert lbfgs.curve[-1] == (1e-12, None, None, None)
    assert lbfgs.curve[0].seconds is not None
    assert all(point.seconds is None for point in table1.curve)


def test_iterations_to_a_tolerance_are_those_of_a_solve_with_it(prism: Comparison):
    for point in prism.methods[0].curve:
        result = cgff_cli.solve(PRISM, tolerance=point.tolerance)
        assert result.counts["iterations"] == point.iterations


def test_the_shape_curve_is_judged_by_the_shape(prism: Comparison):
    for point in prism.methods[0].shape_curve:
        assert point.residual_relative is not None
    target = np.array(list(prism.reference["nodes"].values()))
    size = np.linalg.norm(target - target.mean(axis=0), axis=1).max()
    for point in prism.methods[0].shape_curve[::3]:
        stopped = cgff_cli.solve(PRISM, max_iterations=point.iterations, tolerance=1e-15).coordinates
        error = np.linalg.norm(rigidly(stopped, target) - target, axis=1).max() / size
        assert error <= point.tolerance


def test_the_reference_is_solved_to_the_rounding_floor(prism: Comparison):
    assert prism.reference["verdict"] == "rounding_floor"
    assert prism.reference["residual_relative"] < 1e-12


def test_solve_options_and_the_scenes_own_hold_for_all(prism: Comparison):
    found = cgff_cli.compare(PRISM, ["lm"], repeat=1, tolerance=1e-4)
    assert all(1e-8 < method.residual_relative <= 1e-4 for method in found.methods)
    assert found.options["tolerance"] == 1e-4


def test_a_far_away_origin_costs_no_rival_its_digits():
    scene = cgff_cli.load(PRISM)
    far = cgff_cli.from_dict(
        {
            "law": "paper",
            "nodes": {
                name: [x + 1e6 for x in point]
                for name, point in zip(scene.node_names, scene.coordinates.tolist(), strict=True)
            },
            "elements": {
                group.name: {
                    "kind": group.kind,
                    "EA": group.EA.tolist(),
                    "rest_length": group.rest_length.tolist(),
                    "pairs": [[scene.node_names[i] for i in pair] for pair in group.pairs.tolist()],
                }
                for group in scene.groups
            },
        }
    )
    found = cgff_cli.compare(far, ["fdm", "lm", "fsolve"], repeat=1)
    assert all(method.converged for method in found.methods)


@pytest.mark.parametrize(
    ("methods", "changes", "words"),
    [
        (["newton"], {}, "unknown method 'newton'; allowed: cgff, "),
        (["lm"], {"repeat": 0}, "repeat and time_limit must be positive"),
        (["lm"], {"time_limit": 0.0}, "repeat and time_limit must be positive"),
        (["lm"], {"tolerance": 2.0}, "tolerance must be"),
    ],
)
def test_what_makes_no_sense_is_refused(methods: list[str], changes: dict, words: str):
    with pytest.raises(cgff_cli.OptionError, match=words):
        cgff_cli.compare(PRISM, methods, **changes)


def test_the_observer_sees_the_methods_in_turn():
    seen: list[tuple[str, int]] = []
    cgff_cli.compare(PRISM, ["lm"], repeat=2, observer=lambda *run: seen.append(run))
    assert seen == [("cgff", 1), ("lm", 1), ("cgff", 2), ("lm", 2)]


def test_alignments_undo_what_they_should_and_no_more():
    rng = np.random.default_rng(0)
    X = rng.normal(size=(7, 3))
    turned, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    mirrored = X @ turned @ np.diag([1.0, 1.0, -1.0]) + 5.0
    sheared = X @ rng.normal(size=(3, 3)) - 2.0
    assert np.abs(rigidly(mirrored, X) - X).max() < 1e-12
    assert np.abs(affinely(sheared, X) - X).max() < 1e-12
    assert np.abs(rigidly(sheared, X) - X).max() > 0.1
    assert laid_over(mirrored, X, "none") is mirrored
    assert distance_difference(mirrored, X) < 1e-12
    assert distance_difference(sheared, X) > 0.1


def test_distances_of_many_nodes_are_taken_in_blocks_and_of_very_many_not_at_all():
    X = np.random.default_rng(1).normal(size=(1300, 2))
    Y = X.copy()
    Y[1299, 0] += 50.0
    distances = [np.linalg.norm(shape[:, None] - shape[None], axis=-1) for shape in (X, Y)]
    assert distance_difference(X, Y) == pytest.approx(np.abs(distances[0] - distances[1]).max())
    assert distance_difference(np.zeros((5001, 2)), np.zeros((5001, 2))) is None
