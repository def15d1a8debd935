"""Critical load factors of columns and arches, where they are known in closed form, dense and sparse."""

from math import cos, pi, sqrt

import pytest

import cgff_cli
from cgff_cli.mechanics import connectivity
from tests.bodies import Bar, scene
from tests.solvers.scenes import pendulum

SPRING, LINK, LENGTH = 3.0, 1000.0, 2.0


def column(links: int, load: float):
    """Return a pinned column of links under a load, its joints held sideways by springs, in equilibrium.

    Foot and head stay in line; every joint between has a level spring of stiffness SPRING without force.
    """
    step = LENGTH - load / LINK
    joints = [(0.0, row * step) for row in range(links + 1)]
    walls = [(1.0, row * step) for row in range(1, links)]
    bars: list[Bar] = [(row, row + 1, "strut", LINK, LENGTH) for row in range(links)]
    bars += [(row, links + row, "strut", SPRING, 1.0) for row in range(1, links)]
    supports = {0: "xy", links: "x", **dict.fromkeys(range(links + 1, 2 * links), "xy")}
    return scene([*joints, *walls], bars, supports, {links: (0.0, -load)})


def arch(load: float):
    """Return a von Mises truss, 1 high and 2 wide to either side, in equilibrium under a load on its top."""
    half, high, k = 2.0, 1.0, 100.0
    length = sqrt(half**2 + high**2)
    q = -load / (2.0 * high)
    struts: list[Bar] = [(row, 2, "strut", k, length - q * length / k) for row in (0, 1)]
    points = [(-half, 0.0), (half, 0.0), (0.0, high)]
    return scene(points, struts, {0: "xy", 1: "xy"}, {2: (0.0, -load)}), half, high, k, length, q


def factor(body, **options):
    found = cgff_cli.analyse(body, **options)
    assert found.balanced
    return found.analysis["critical_load_factor"]


@pytest.mark.parametrize("sparse", [False, True])
@pytest.mark.parametrize(("links", "load"), [(2, 0.5), (5, 1.0), (12, 1.2)])
def test_a_column_on_springs_buckles_where_its_joints_do(links, load, sparse, monkeypatch):
    # At joints K = SPRING I - (load / step) T, T = tridiag(-1, 2, -1): at most 2 + 2 cos(pi / links).
    if sparse:
        monkeypatch.setattr(connectivity, "DENSE_ENTRIES", 0)
    step = LENGTH - load / LINK
    known = SPRING * step / (load * (2.0 + 2.0 * cos(pi / links)))
    assert factor(column(links, load)) == pytest.approx(known, rel=1e-8)


@pytest.mark.parametrize("sparse", [False, True])
def test_a_column_under_more_than_its_critical_load_is_unstable_by_a_factor_below_one(sparse, monkeypatch):
    if sparse:
        monkeypatch.setattr(connectivity, "DENSE_ENTRIES", 0)
    found = cgff_cli.analyse(column(2, 4.0)).analysis
    assert (found["stability"], found["negative_eigenvalues"]) == ("unstable", 1)
    assert found["critical_load_factor"] == pytest.approx(SPRING * (LENGTH - 4.0 / LINK) / 8.0, rel=1e-8)


@pytest.mark.parametrize("load", [0.1, 1.0, 5.0])
def test_an_arch_loses_its_stiffness_where_the_linear_change_of_forces_says(load):
    body, half, high, k, length, q = arch(load)
    upright = 2.0 * ((k - q) * (high / length) ** 2 + q)
    sideways = 2.0 * ((k - q) * (half / length) ** 2 + q)
    rate = 2.0 * k * high * load / (length**2 * upright)
    known = 1.0 + min(upright, sideways) / rate
    assert factor(body) == pytest.approx(known, rel=1e-9)


def beside(body, *, weight=0.0, stay=False):
    """Return a column with a pendulum beside it, or with a slack cable along its first link."""
    X, n = body.coordinates.tolist(), len(body.coordinates)
    bars = [(*g.pairs[0].tolist(), g.kind, float(g.EA[0]), float(g.rest_length[0])) for g in body.groups]
    supports, loads = dict(body.supports), dict(body.loads)
    if weight:
        X += [(9.0, 0.0), (9.0, -1.0 - weight / 100.0)]
        bars.append((n, n + 1, "strut", 100.0, 1.0))
        supports[n], loads[n + 1] = "xy", (0.0, -weight)
    if stay:
        bars.append((0, 1, "cable", 500.0, 50.0))
    return scene(X, bars, supports, loads)


@pytest.fixture(params=[False, True], ids=["dense", "sparse"])
def entries(request, monkeypatch):
    """Let every structure be small, then large."""
    if request.param:
        monkeypatch.setattr(connectivity, "DENSE_ENTRIES", 0)


def test_what_its_load_alone_makes_stiff_does_not_hide_what_buckles(entries):
    alone, hung = column(3, 0.5), beside(column(3, 0.5), weight=1.0)
    assert factor(hung) == pytest.approx(factor(alone), rel=1e-8)


def test_stiff_neither_with_nor_without_loads_has_no_factor(entries):
    told = cgff_cli.analyse(beside(column(2, 4.0), weight=1.0)).analysis
    assert told["stability"] == "unstable"
    assert told["critical_load_factor"] is None
    assert "without the loads" in told["reason"]["critical_load_factor"]


def test_what_no_load_reaches_does_not_buckle(entries):
    # A column without load, a hanging weight beside it: rounding alone would change its stiffness.
    told = cgff_cli.analyse(beside(column(7, 0.0), weight=1.0)).analysis
    assert told["stability"] == "stable"
    assert told["critical_load_factor"] is None
    assert "no multiple of the loads" in told["reason"]["critical_load_factor"]


def test_a_slack_cable_takes_no_part_in_buckling(entries):
    assert factor(beside(column(3, 0.5), stay=True)) == pytest.approx(factor(column(3, 0.5)), rel=1e-9)


def test_doubling_the_load_of_a_stiff_column_halves_the_factor():
    assert factor(column(3, 0.2)) == pytest.approx(2.0 * factor(column(3, 0.4)), rel=1e-3)


@pytest.mark.parametrize(
    ("body", "why"),
    [
        (pendulum(-1.0), "no multiple of the loads"),
        (column(2, 0.0), "there are no loads"),
        (column(2, 3.0 / 1.0015), "some motion has no stiffness"),
    ],
    ids=["hanging", "without loads", "at its critical load"],
)
def test_without_a_factor_there_is_a_reason(body, why):
    found = cgff_cli.analyse(cgff_cli.solve(body, max_iterations=50, objective="residual")).analysis
    assert found["critical_load_factor"] is None
    assert why in found["reason"]["critical_load_factor"]
