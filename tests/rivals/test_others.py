"""Schek, scipy and dynamic relaxation: the same answers as CGFF, or rows that say why not."""

from collections.abc import Callable

import numpy as np
import pytest

import cgff_cli
from cgff_cli.rivals.registry import REGISTRY
from cgff_cli.rivals.task import End
from cgff_cli.study.alignment import SAME_SHAPE, size
from cgff_cli.study.compare import chosen
from cgff_cli.study.record import Comparison, Method
from tests.bodies import scene as body
from tests.shapes import STRUCTURES

SHIPPED = ("x-module", "hexagon", "prism", "octahedron", "bracket", "cable-net")
FIND_ALL = ("cgff-residual", "lm", "dr")
"""Methods that find CGFF's shape of every shipped scene from its own start."""


def of(comparison: Comparison, name: str) -> Method:
    return next(method for method in comparison.methods if method.name == name)


@pytest.fixture(scope="module")
def compared() -> Callable[[str], Comparison]:
    """Return the comparison of a shipped scene by all methods, each made once."""
    made: dict[str, Comparison] = {}

    def get(name: str) -> Comparison:
        if name not in made:
            made[name] = cgff_cli.compare(STRUCTURES / f"{name}.yaml", ["all"], repeat=1, time_limit=2.0)
        return made[name]

    return get


@pytest.mark.parametrize("name", SHIPPED)
def test_two_stable_equilibria_of_one_energy_are_one_shape(compared, name):
    methods = [method for method in compared(name).methods if method.stable]
    assert len(methods) >= 4
    shapes = [np.array(list(method.nodes.values())) for method in methods]
    distances = [np.linalg.norm(X[:, None] - X[None], axis=-1) for X in shapes]
    for one, here in zip(methods, distances, strict=True):
        for other, there in zip(methods, distances, strict=True):
            if abs(one.energy - other.energy) <= 1e-9 * abs(other.energy):
                assert np.abs(here - there).max() <= 1e-8 * here.max(), (one.name, other.name)


@pytest.mark.parametrize("rival", FIND_ALL)
@pytest.mark.parametrize("name", SHIPPED)
def test_methods_that_find_the_shape_of_every_shipped_scene(compared, name, rival):
    method = of(compared(name), rival)
    assert (method.verdict, method.stable) == ("converged", True)
    assert method.residual_relative <= 1e-12
    assert method.distance_matrix_difference <= 1e-10


@pytest.mark.parametrize("name", SHIPPED)
def test_l_bfgs_comes_near_and_stops_where_differences_of_energy_are_rounding(compared, name):
    method = of(compared(name), "lbfgs")
    assert method.distance_matrix_difference <= 1e-6
    assert method.converged == (method.residual_relative <= 1e-12)


@pytest.mark.parametrize("name", SHIPPED)
def test_table_1_ends_without_equilibrium(compared, name):
    method = of(compared(name), "table1")
    assert (method.verdict, method.converged, method.stable) == ("step_vanished", False, None)


@pytest.mark.parametrize("rival", ["fsolve", "fsolve-fd"])
@pytest.mark.parametrize("name", SHIPPED)
def test_fsolve_balances_the_forces_or_says_how_it_ended(compared, name, rival):
    # Which of the two is up to rounding: the Jacobian of a free body is singular.
    method = of(compared(name), rival)
    if method.converged:
        assert method.residual_relative <= 1e-12
    else:
        assert method.verdict == "gave_up"
        assert method.message.startswith("no equilibrium: it ended by itself with out-of-balance force ")


def test_without_its_jacobian_fsolve_evaluates_the_residual_once_more_for_every_unknown(compared):
    with_it, without = (of(compared("bracket"), name) for name in ("fsolve", "fsolve-fd"))
    assert (with_it.verdict, without.verdict) == ("converged", "converged")
    assert without.evaluations >= with_it.evaluations + 2


def test_schek_gives_back_the_coordinates_of_cgff(compared):
    method = of(compared("cable-net"), "schek")
    assert (method.converged, method.stable, method.alignment) == (True, True, "none")
    assert method.max_node_difference <= 1e-12


def test_schek_gives_back_a_stiff_mast_whose_forces_its_rounding_unbalances():
    method = cgff_cli.compare(STRUCTURES / "mast.yaml", ["schek"], repeat=1).methods[1]
    assert (method.verdict, method.converged, method.stable) == ("same_shape", False, None)
    assert method.shape_error <= SAME_SHAPE
    assert method.residual_relative > 1e-12
    assert method.message.startswith("cgff's shape to ")


@pytest.mark.parametrize(
    ("apart", "verdict"),
    [(0.0, "rounding_floor"), (SAME_SHAPE / 4, "same_shape"), (4 * SAME_SHAPE, "other_equilibrium")],
)
def test_a_form_is_cgffs_shape_as_far_as_one_shape_goes_and_then_another(
    monkeypatch: pytest.MonkeyPatch, apart: float, verdict: str
):
    def shifted(task, trace):
        trace.start()
        X = task.best.shape.copy()
        X[1, 2] += apart * size(X)
        return End(X, "form_found", "by a shift of the top")

    monkeypatch.setitem(REGISTRY, "schek", REGISTRY["schek"]._replace(run=shifted))
    method = cgff_cli.compare(STRUCTURES / "mast.yaml", ["schek"], repeat=1, tolerance=1e-15).methods[1]
    assert (method.verdict, method.converged) == (verdict, apart == 0.0)
    assert method.shape_error == pytest.approx(apart, rel=1e-3)
    assert ("do not hold" in method.message) is (verdict == "other_equilibrium")


def test_schek_holds_each_axis_by_its_own_supports():
    made = body(
        [[0, 0], [1, 0.3], [2, 0]],
        [(0, 1, "cable", 10, 0.8), (1, 2, "cable", 10, 0.8)],
        {0: "xy", 2: "y"},
        {2: (1.0, 0.0), 1: (0.0, -1.0)},
    )
    method = cgff_cli.compare(made, ["schek"], repeat=1).methods[1]
    assert method.max_node_difference <= 1e-9


def test_schek_on_a_large_net_solves_sparse_matrices():
    net = cgff_cli.new("net", side=14, jitter=0.01, seed=1)
    assert of(cgff_cli.compare(net, ["schek"], repeat=1), "schek").max_node_difference <= 1e-10


def test_force_densities_that_cancel_hold_nothing(compared):
    method = of(compared("bracket"), "schek")
    assert method.verdict == "failed"
    assert "D_ff is singular" in method.message


def test_schek_needs_supports():
    method = cgff_cli.compare(STRUCTURES / "prism.yaml", ["schek"], repeat=1).methods[1]
    assert (method.verdict, method.nodes) == ("failed", None)
    assert method.message == "no supports: the force density method needs held nodes"


def test_with_supports_fdm_means_schek():
    assert chosen(["fdm", "lm"], True) == ["cgff", "schek", "lm"]
    assert chosen(["fdm", "lm"], False) == ["cgff", "fdm", "lm"]
    assert chosen(["all"], True) == [name for name in REGISTRY if name not in ("fdm", "afdm", "dsvd")]
    assert chosen(["all"], False) == [name for name in REGISTRY if name != "schek"]


def test_large_scenes_have_a_sparse_jacobian_for_lm_and_none_for_fsolve():
    net = cgff_cli.new("net", side=30)
    compared = cgff_cli.compare(net, ["fsolve", "fsolve-fd", "lm"], repeat=1, time_limit=2.0)
    for name in ("fsolve", "fsolve-fd"):
        assert of(compared, name).verdict == "failed"
        assert "2000 unknowns" in of(compared, name).message
    assert of(compared, "lm").residual_relative is not None


def test_a_time_limit_ends_a_run_where_it_is():
    method = cgff_cli.compare(STRUCTURES / "prism.yaml", ["dr"], repeat=1, time_limit=1e-3).methods[1]
    assert method.verdict == "time_limit"
    assert method.nodes is not None


def test_a_rival_that_breaks_is_a_row(monkeypatch: pytest.MonkeyPatch):
    def broken(task, trace):
        raise ZeroDivisionError("by nothing")

    monkeypatch.setitem(REGISTRY, "lm", REGISTRY["lm"]._replace(run=broken))
    method = cgff_cli.compare(STRUCTURES / "prism.yaml", ["lm"], repeat=2).methods[1]
    assert (method.verdict, method.converged, method.nodes) == ("failed", False, None)
    assert method.message == "ZeroDivisionError: by nothing"
