"""The same answers by other hands: plain loops for equilibrium, scipy's minimisers for the shape."""

from math import sqrt

import numpy as np
import pytest
from scipy.optimize import least_squares, minimize

import cgff_cli
from cgff_cli.scene.read import from_dict
from tests.closed_forms.references import expanded_octahedron, hypar_net, prism
from tests.shapes import distance_difference, solve_structure

SHIPPED = ["x-module", "hexagon", "prism", "octahedron", "bracket", "cable-net"]


def force(record: dict, length: float, law: str) -> float:
    """Return one element's force from its record and a length; a slack cable carries nothing."""
    stretch = length - record["rest_length"]
    if record["kind"] == "cable" and stretch < 0.0:
        return 0.0
    return record["EA"] * stretch / (record["rest_length"] if law == "hooke" else 1.0)


def nodal_forces(result: "cgff_cli.Result", nodes: dict[str, list[float]]) -> dict[str, list[float]]:
    """Return the load plus the pull of every element at each node, one element after the other."""
    d = result.scene["dimension"]
    names = result.source.node_names
    total = {name: [0.0] * d for name in nodes}
    for row, load in result.source.loads.items():
        total[names[row]] = list(load)
    for record in result.elements:
        here, there = nodes[record["start"]], nodes[record["end"]]
        length = sqrt(sum((b - a) ** 2 for a, b in zip(here, there, strict=True)))
        pull = force(record, length, result.scene["law"])
        for axis in range(d):
            component = pull * (there[axis] - here[axis]) / length
            total[record["start"]][axis] += component
            total[record["end"]][axis] -= component
    return total


def energy_and_gradient(result: "cgff_cli.Result", X: np.ndarray) -> tuple[float, np.ndarray]:
    """Return sum 1/2 t (l - l0) - loads.X and its (n, d) gradient, by the loops above."""
    names, law = result.source.node_names, result.scene["law"]
    nodes = dict(zip(names, X.tolist(), strict=True))
    energy = -sum(np.dot(load, X[row]) for row, load in result.source.loads.items())
    for record in result.elements:
        length = float(np.linalg.norm(np.subtract(nodes[record["start"]], nodes[record["end"]])))
        energy += 0.5 * force(record, length, law) * (length - record["rest_length"])
    pulls = nodal_forces(result, nodes)
    return energy, -np.array([pulls[name] for name in names])


def free_directions(result: "cgff_cli.Result") -> np.ndarray:
    """Return (n, d) bool, true where no support holds."""
    free = np.ones(result.coordinates.shape, dtype=bool)
    for row, axes in result.source.supports.items():
        free[row, ["xyz".index(axis) for axis in axes]] = False
    return free


@pytest.fixture(scope="module")
def solved():
    """Return the result of a shipped scene, each solved once."""
    results: dict[str, cgff_cli.Result] = {}

    def get(name: str) -> "cgff_cli.Result":
        if name not in results:
            results[name] = solve_structure(name, tolerance=1e-12)
        return results[name]

    return get


@pytest.mark.parametrize("name", SHIPPED)
def test_every_free_node_is_in_balance_and_every_held_one_is_held_by_its_reaction(solved, name):
    result = solved(name)
    forces = nodal_forces(result, result.nodes)
    strongest = max(abs(record["force"]) for record in result.elements)
    for node, total in forces.items():
        reaction = result.reactions.get(node, [0.0] * len(total))
        for component, held in zip(total, reaction, strict=True):
            assert abs(component + held) <= 1e-11 * strongest


@pytest.mark.parametrize("name", SHIPPED)
def test_records_agree_with_their_coordinates(solved, name):
    result = solved(name)
    for record in result.elements:
        length = np.linalg.norm(np.subtract(result.nodes[record["start"]], result.nodes[record["end"]]))
        assert record["length"] == pytest.approx(length, rel=1e-14)
        assert record["force"] == pytest.approx(force(record, length, result.scene["law"]), abs=1e-11)
        assert record["force_density"] == pytest.approx(record["force"] / length, rel=1e-12)
        assert record["slack"] is (record["kind"] == "cable" and record["length"] < record["rest_length"])


@pytest.mark.parametrize("name", SHIPPED)
def test_residual_and_energy_are_what_a_loop_finds(solved, name):
    result = solved(name)
    energy, gradient = energy_and_gradient(result, result.coordinates)
    assert result.energy == pytest.approx(energy, rel=1e-10)
    assert result.residual["max"] <= 1e-10
    assert np.abs(gradient[free_directions(result)]).max() == pytest.approx(result.residual["max"], abs=1e-11)


@pytest.mark.parametrize("name", SHIPPED)
def test_a_quasi_newton_minimiser_finds_the_same_shape_from_the_same_start(solved, name):
    result = solved(name)
    start, free = result.source.coordinates, free_directions(result)

    def objective(x: np.ndarray) -> tuple[float, np.ndarray]:
        X = start.copy()
        X[free] = x
        energy, gradient = energy_and_gradient(result, X)
        return energy, gradient[free]

    found = minimize(objective, start[free], jac=True, method="BFGS", options={"gtol": 1e-9, "maxiter": 2000})
    X = start.copy()
    X[free] = found.x
    # BFGS stops where differences of energy drown in rounding, some 1e-7 off.
    assert distance_difference(X, result.coordinates) <= 1e-5 * result.lengths.max()
    assert found.fun == pytest.approx(result.energy, rel=1e-9)


@pytest.mark.parametrize("name", SHIPPED)
def test_least_squares_on_the_forces_stays_at_our_answer(solved, name):
    # Zero residual has many solutions; from beside ours, 1 % off, it must come back to ours.
    result = solved(name)
    free = free_directions(result)
    noise = np.random.default_rng(8).uniform(-0.01, 0.01, result.coordinates.shape) * result.lengths.mean()

    def residual(x: np.ndarray) -> np.ndarray:
        X = result.coordinates.copy()
        X[free] = x
        return energy_and_gradient(result, X)[1][free]

    beside = (result.coordinates + noise)[free]
    method = "trf"
    found = least_squares(residual, beside, method=method, x_scale="jac", xtol=1e-15, ftol=1e-15, gtol=1e-15)
    X = result.coordinates.copy()
    X[free] = found.x
    assert np.abs(found.fun).max() <= 1e-8 * np.abs(result.forces).max()
    assert distance_difference(X, result.coordinates) <= 1e-7 * result.lengths.max()


@pytest.mark.parametrize(
    "reference", [prism(5), expanded_octahedron(), hypar_net(4)], ids=["prism", "oct", "net"]
)
def test_no_displacement_of_the_answer_lowers_its_energy(reference):
    result = cgff_cli.solve(from_dict(reference.scene("paper", 0.1, 3)), tolerance=1e-12)
    free, rng = free_directions(result), np.random.default_rng(9)
    lowest = energy_and_gradient(result, result.coordinates)[0]
    for size in (1e-3, 1e-2, 1e-1):
        for _ in range(20):
            step = np.where(free, rng.normal(size=free.shape), 0.0) * size
            assert energy_and_gradient(result, result.coordinates + step)[0] > lowest
