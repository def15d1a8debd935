"""The page on the paper's claims: its figures are the committed ones, and what is exact holds here too."""

import re
from pathlib import Path

import numpy as np
import pytest

import cgff_cli
from tests.bodies import forces_by_loop
from tests.pages import ROOT, section
from tests.shapes import STRUCTURES
from tests.studies.claims import convexity, iterations, readme, speed, tables
from tests.studies.claims.cases import NAMES, structure_of

SECTION = "What the paper claims and what we measured"


@pytest.fixture(scope="module")
def committed() -> dict:
    return readme.committed()


def half_squared_residual(structure, X: np.ndarray) -> float:
    """Return f, eq. (10), by a loop over the elements."""
    eta = forces_by_loop(structure, X)
    return 0.5 * float((eta * eta).sum())


def test_the_table_on_the_page_is_made_of_the_committed_figures(committed):
    shown = section(SECTION).partition(readme.BEGIN)[2].partition(readme.END)[0]
    assert shown == readme.text(committed), "made by: python tests/studies/paper_claims.py --readme"


def test_every_command_of_the_table_is_a_part_of_the_study():
    table = readme.TEMPLATE.read_text(encoding="utf-8")
    named = re.findall(r"`\{command\} (\w+)` \|$", table, flags=re.MULTILINE)
    source = (ROOT / readme.COMMAND.removeprefix("python ")).read_text(encoding="utf-8")
    assert len(named) == len(table.splitlines()) - 2
    for part in named:
        assert f'\n    "{part}": (' in source


def test_the_table_is_put_between_its_marks_and_nothing_else_is_touched(tmp_path: Path, committed):
    page = tmp_path / "README.md"
    page.write_text(f"before\n{readme.BEGIN}old\n{readme.END}\nafter {readme.END}\n")
    readme.rewrite(page, committed)
    made = f"before\n{readme.BEGIN}{readme.text(committed)}{readme.END}\nafter {readme.END}\n"
    assert page.read_text() == made


def test_the_figures_of_the_tables_are_measured_again(committed):
    for name, found in tables.measure().items():
        for key, value in found.items():
            assert value == pytest.approx(committed["tables"][name][key], rel=1e-2, abs=1e-11), (name, key)


@pytest.mark.parametrize("name", NAMES)
def test_iterations_from_the_scenes_own_starts_are_measured_again(committed, name):
    assert (
        iterations.ours(name, "energy", 0)["own_start"]
        == (committed["iterations"]["cgff"][name]["energy"]["own_start"])
    )


@pytest.mark.parametrize("name", NAMES)
def test_table_1_stops_uphill_after_failed_trials_without_balance(name):
    run = iterations.false_stop(name)
    assert run["failed_trials"] > 20
    assert run["uphill"]
    assert run["left"] > 0.1


def test_a_larger_eps_ends_table_1_where_the_study_says():
    start = STRUCTURES / "prism.yaml"
    whole = cgff_cli.solve(start, method="table1")
    steps = np.array(whole.history["step_norm"])
    for eps in (1e-1, 1e-2, 1e-4):
        run = cgff_cli.solve(start, method="table1", eps=eps)
        assert run.counts["iterations"] == iterations.stop_at(eps, steps, stopped=True)


@pytest.mark.parametrize("law", ["slack", "push"])
def test_f_is_not_convex_as_two_equilibria_have_none_half_way_between(law):
    structure = structure_of("prism", law)
    X, Y = convexity.turned_prism()
    assert half_squared_residual(structure, X) < 1e-18
    assert half_squared_residual(structure, Y) < 1e-18
    assert half_squared_residual(structure, 0.5 * (X + Y)) > 1e5


def test_f_curves_down_at_the_start_of_the_prism(committed):
    structure, f = structure_of("prism", "push"), half_squared_residual
    values, vectors = np.linalg.eigh(convexity.second_derivatives("prism", "push"))
    assert values[0] == pytest.approx(
        committed["convexity"]["curvature_at_the_start"]["prism"]["push"]["least"], rel=1e-4
    )
    X, v = structure.coordinates, 1e-3 * vectors[:, 0].reshape(structure.coordinates.T.shape).T
    second_difference = f(structure, X + v) - 2.0 * f(structure, X) + f(structure, X - v)
    assert second_difference / 1e-6 == pytest.approx(values[0], rel=1e-2)
    assert second_difference < 0.0


def test_minimising_f_can_end_in_an_unstable_equilibrium_and_the_energy_does_not():
    ends = {kind: convexity.ends("x-module", "push", kind, 5) for kind in ("residual", "energy")}
    assert ends["residual"]["unstable"] > 0
    assert ends["energy"]["stable"] == 5


@pytest.mark.parametrize("by_loop", [False, True])
def test_the_residuals_that_rivals_get_are_those_of_a_loop(by_loop):
    structure = structure_of("hexagon")
    system = speed.System(structure, by_loop=by_loop)
    frame = system.mechanics.frame
    expected = -forces_by_loop(structure, structure.coordinates).T.ravel() / frame.force
    assert system.residual(system.start) == pytest.approx(expected, rel=1e-12, abs=1e-15)


@pytest.mark.parametrize("rival", speed.RIVALS)
def test_every_rival_but_table_1_balances_the_hexagon(rival):
    end = speed.RIVALS[rival](structure_of("hexagon"))
    if rival == "plain residual":  # of eq. (10) the gradient itself is rounding error from 2e-10 on
        assert end.left <= 10.0 * speed.TOLERANCE
    else:
        assert end.reached == (rival != "table1")
    assert (end.left <= speed.TOLERANCE) == end.reached
