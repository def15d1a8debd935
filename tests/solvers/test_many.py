"""Many sets of numbers of one scene: each row has the answer that it has alone, whatever stands beside it."""

from dataclasses import replace

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.scene import Scene
from cgff_cli.solvers.many import loop as many
from cgff_cli.structure import from_scene
from tests.bodies import scene
from tests.shapes import distance_difference
from tests.solvers.scenes import crossed_struts, pendulum, shipped, truss

FIELDS = ("coordinates", "forces", "energy", "iterations", "residual_relative", "converged")


def held_prism(loads: dict | None = None) -> Scene:
    """The prism on a floor: a node held in all directions, one in two, one in height alone."""
    return replace(shipped("prism"), supports={0: "xyz", 1: "yz", 2: "z"}, loads=loads or {})


def cantilever() -> Scene:
    """Three square bays of bars between a wall and a load at the tip, with crossed cables."""
    points = [(float(x), float(y)) for x in range(4) for y in range(2)]
    bars = [(i, i + 2, "strut", 1000.0, 1.0) for i in range(6)]
    bars += [(2 * i, 2 * i + 1, "strut", 1000.0, 1.0) for i in range(1, 4)]
    bars += [(2 * i, 2 * i + 3, "cable", 300.0, 1.4) for i in range(3)]
    bars += [(2 * i + 1, 2 * i + 2, "cable", 300.0, 1.4) for i in range(3)]
    return scene(points, bars, {0: "xy", 1: "xy"}, {7: (0.0, -1.0)})


SCENES = {
    "prism": shipped("prism"),
    "octahedron under law hooke": replace(shipped("octahedron"), law="hooke"),
    "x-module in the plane": shipped("x-module"),
    "bracket": shipped("bracket"),
    "net between supports": cgff_cli.new("net", side=4),
    "tower": cgff_cli.new("tower", stages=2),
    "cantilever": cantilever(),
    "prism on a floor": held_prism(),
    "prism on rollers": replace(shipped("prism"), supports={0: "z", 1: "z", 2: "z"}),
    "prism under a load": held_prism({3: (0.1, 0.0, -0.5)}),
    "prism under a strong load": replace(
        shipped("prism"), supports=dict.fromkeys(range(3), "xyz"), loads={3: (0.3, 0.0, -1.0)}
    ),
    "prism pulled at both ends": replace(
        shipped("prism"), loads={i: (0.0, 0.0, 0.1 if i > 2 else -0.1) for i in range(6)}
    ),
}


def varied(of: Scene, m: int = 12, seed: int = 0) -> dict[str, np.ndarray]:
    """Return rest lengths up to 4 % off, stiffnesses and loads up to half more, starts moved by 5 %."""
    rng, s = np.random.default_rng(seed), from_scene(of)
    EA = np.concatenate([group.EA for group in of.groups])
    size = np.ptp(s.coordinates, axis=0).max()
    return {
        "rest_lengths": s.rest_lengths * rng.uniform(0.96, 1.04, (m, len(EA))),
        "EA": EA * rng.uniform(1.0, 1.5, (m, len(EA))),
        "loads": s.loads * rng.uniform(1.0, 1.5, (m, 1, 1)),
        "coordinates": s.coordinates + 0.05 * size * rng.uniform(-1.0, 1.0, (m, *s.coordinates.shape)),
    }


def row_of(of: Scene, values: dict[str, np.ndarray], row: int) -> Scene:
    """Return the scene with the numbers of a row."""
    groups, first = [], 0
    for group in of.groups:
        part = slice(first, first + len(group.EA))
        columns = {"EA": "EA", "rest_length": "rest_lengths"}
        changed = {a: values[b][row, part] for a, b in columns.items() if b in values}
        groups.append(replace(group, **changed))
        first = part.stop
    of = replace(of, groups=tuple(groups))
    if "loads" in values:
        of = replace(of, loads={i: tuple(load) for i, load in enumerate(values["loads"][row]) if load.any()})
    return replace(of, coordinates=values["coordinates"][row]) if "coordinates" in values else of


def same_as_alone(of: Scene, values: dict[str, np.ndarray], **options: object) -> "cgff_cli.many.Solutions":
    """Check every row against `solve` of its own scene; return the answers."""
    found = cgff_cli.solve_many(of, **values, **options)
    for row in range(len(found.converged)):
        alone = cgff_cli.solve(row_of(of, values, row), **options)
        size, force = np.abs(alone.coordinates).max(), alone.residual["reference_force"]
        assert found.verdicts[row] == alone.verdict
        assert found.converged[row] == alone.converged
        assert found.stability[row] == alone.analysis["stability"]
        assert found.residual_relative[row] <= 1e-10
        if alone.analysis["stability"] == "stable":
            assert distance_difference(found.coordinates[row], alone.coordinates) < 1e-7 * size
        assert found.forces[row] == pytest.approx(alone.forces, abs=1e-9 * force)
        assert found.energy[row] == pytest.approx(alone.energy, rel=1e-8, abs=1e-9 * force * size)
    return found


@pytest.mark.parametrize("name", SCENES)
def test_every_row_has_the_answer_that_it_has_alone(name):
    found = same_as_alone(SCENES[name], varied(SCENES[name]))
    assert found.converged.all()


def test_rows_whose_cables_slacken_are_told_neutral_or_stable_as_alone():
    found = same_as_alone(shipped("prism"), {"rest_lengths": varied(shipped("prism"), 40)["rest_lengths"]})
    assert set(found.stability) == {"stable", "neutral"}
    assert not found.alone.any()


@pytest.mark.parametrize("name", ["octahedron", "prism"])
def test_wild_starts_lead_to_stable_equilibria_in_the_eyes_of_solve(name):
    of, X = shipped(name), shipped(name).coordinates
    starts = X + 0.5 * np.ptp(X) * np.random.default_rng(5).uniform(-1.0, 1.0, (60, *X.shape))
    found = cgff_cli.solve_many(of, coordinates=starts)
    assert set(found.stability) == {"stable"}
    assert found.alone.sum() <= 2
    for row in range(60):
        again = cgff_cli.solve(replace(of, coordinates=found.coordinates[row]))
        assert (again.counts["iterations"], again.analysis["stability"]) == (0, "stable")


def test_no_row_is_stable_by_cables_that_may_be_slack_within_the_tolerance():
    of, s = SCENES["prism under a strong load"], from_scene(SCENES["prism under a strong load"])
    shares = 0.05 * np.random.default_rng(7).uniform(-1.0, 1.0, (60, len(s.start)))
    values = {"rest_lengths": s.rest_lengths * (1.0 + shares)}
    found = cgff_cli.solve_many(of, **values)
    told = [cgff_cli.solve(row_of(of, values, row)).analysis["stability"] for row in range(60)]
    assert not found.alone.any()
    assert ("stable", "neutral") not in zip(found.stability, told, strict=True)
    assert told.count("neutral") > 5


def test_without_arrays_there_is_one_row_the_scene_itself():
    found = cgff_cli.solve_many(shipped("prism"))
    assert found.coordinates.shape == (1, 6, 3)
    assert found.energy[0] == pytest.approx(cgff_cli.solve(shipped("prism")).energy, rel=1e-12)
    assert cgff_cli.solve_many(shipped("prism").path).coordinates.tobytes() == found.coordinates.tobytes()


def test_no_rows_are_no_answers():
    assert cgff_cli.solve_many(shipped("prism"), rest_lengths=np.zeros((0, 12))).forces.shape == (0, 12)


@pytest.mark.parametrize("name", SCENES)
def test_a_row_has_the_same_bytes_whatever_stands_beside_it(name, monkeypatch):
    values, order = varied(SCENES[name], 30, seed=1), np.random.default_rng(2).permutation(30)
    found = cgff_cli.solve_many(SCENES[name], **values)
    monkeypatch.setattr(many, "ENTRIES", 2**12)
    for rows in (order, order[:11], order[:1], order[5:8]):
        some = {key: value[rows] for key, value in values.items()}
        again = cgff_cli.solve_many(SCENES[name], **some)
        for field in FIELDS:
            assert getattr(again, field).tobytes() == getattr(found, field)[rows].tobytes(), field
        assert again.stability.tolist() == found.stability[rows].tolist()


@pytest.mark.parametrize("name", ["prism", "prism under a load"])
@pytest.mark.parametrize(
    ("length", "stiffness"), [(1024.0, 1 / 64.0), (2.0**50, 2.0**40), (2.0**-50, 2.0**-40)]
)
def test_units_change_nothing_but_units(name, length, stiffness):
    of, force = SCENES[name], length * stiffness
    values = varied(of)
    inches = {
        "rest_lengths": length * values["rest_lengths"],
        "coordinates": length * values["coordinates"],
        "EA": stiffness * values["EA"],
        "loads": force * values["loads"],
    }
    one, other = cgff_cli.solve_many(of, **values), cgff_cli.solve_many(of, **inches)
    assert np.array_equal(other.coordinates, length * one.coordinates)
    assert np.array_equal(other.iterations, one.iterations)
    assert np.array_equal(other.forces, force * one.forces)
    assert other.stability.tolist() == one.stability.tolist()
    assert not other.alone.any()


def test_a_truss_that_snaps_through_is_finished_alone():
    starts = np.array([truss(y).coordinates for y in (0.5, 0.0, -0.5)])
    found = same_as_alone(truss(0.5), {"coordinates": starts})
    assert found.alone.tolist() == [False, True, False]  # level, it balances, and must leave
    assert set(found.stability) == {"stable"}


def test_a_pendulum_upright_falls_as_it_does_alone():
    same_as_alone(
        pendulum(1.0), {"coordinates": np.array([pendulum(y).coordinates for y in (-1.0, 0.99, 1.0)])}
    )


def test_struts_of_no_length_at_the_start_open():
    of = crossed_struts((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))
    fallen = [(0.0, 0.0), (1.0, 0.0), (0.0, 0.0), (0.0, 1.0)]
    same_as_alone(of, {"coordinates": np.array([fallen, np.zeros((4, 2)), of.coordinates])})


def test_a_strut_pushed_between_rails_tilts_as_it_does_alone():
    level = scene([(0.0, 0.0), (1.0, 0.0)], [(0, 1, "strut", 10.0, 1.2)], {0: "x", 1: "x"})
    found = same_as_alone(level, {"EA": np.array([[10.0], [20.0]])})
    assert found.forces == pytest.approx(0.0, abs=1e-8)


def test_a_cable_at_its_rest_length_resists_nothing():
    bars = [(0, 1, "strut", 10.0, 1.0), (2, 1, "cable", 10.0, 1.0), (3, 1, "cable", 10.0, 1.0)]
    of = scene([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (1.0, -1.0)], bars, {0: "xy", 2: "xy", 3: "xy"})
    found = same_as_alone(of, {"rest_lengths": np.array([[1.0, 1.0, 1.0], [1.0, 0.9, 0.9]])})
    assert found.stability.tolist() == ["neutral", "stable"]


def test_loads_that_nothing_balances_are_refused_as_in_a_scene():
    loads = np.zeros((2, 6, 3))
    loads[1, 3, 1] = 1.0
    with pytest.raises(
        cgff_cli.OptionError, match=r"^loads of row 1 .*add up along y, .* part with node n1 there"
    ):
        cgff_cli.solve_many(shipped("prism"), loads=loads)
    assert cgff_cli.solve_many(held_prism(), loads=loads).converged.all()


def test_a_limit_of_iterations_is_a_verdict_of_its_own():
    found = cgff_cli.solve_many(
        shipped("prism"), rest_lengths=varied(shipped("prism"))["rest_lengths"], max_iterations=2
    )
    assert set(found.verdicts) == {"max_iterations"}
    assert set(found.iterations) == {2}
    assert not found.converged.any()


@pytest.mark.parametrize(
    "options",
    [
        {"objective": "residual"},
        {"cg_beta": "PR+"},
        {"preconditioner": "none"},
        {"tolerance": 1e-16},
        {"analysis": "never"},
        {"method": "table1", "alpha": 1e-3, "max_iterations": 20000},
    ],
    ids=str,
)
def test_any_option_gives_what_it_gives_alone(options):
    of, values = shipped("x-module"), {"rest_lengths": varied(shipped("x-module"), 3)["rest_lengths"]}
    found = cgff_cli.solve_many(of, **values, **options)
    for row in range(3):
        alone = cgff_cli.solve(row_of(of, values, row), **options)
        assert (found.converged[row], found.stability[row]) == (alone.converged, alone.analysis["stability"])
        assert found.forces[row] == pytest.approx(alone.forces, abs=1e-6 * alone.residual["reference_force"])


def test_a_scene_in_which_nothing_can_move_is_answered():
    of = scene([(0.0, 0.0), (1.0, 0.0)], [(0, 1, "strut", 10.0, 0.9)], {0: "xy", 1: "xy"})
    found = cgff_cli.solve_many(of, EA=[[10.0], [20.0]])
    assert found.forces[:, 0] == pytest.approx([1.0, 2.0])
    assert found.alone.all()


PRISM = {"coordinates": (6, 3), "loads": (6, 3), "rest_lengths": (12,), "EA": (12,)}


@pytest.mark.parametrize("name", PRISM)
def test_an_array_of_another_shape_is_refused(name):
    wanted = ", ".join(map(str, PRISM[name]))
    for wrong in (np.ones(PRISM[name]), np.ones((2, 5, 3)), np.ones((2, 11)), 1.0):
        with pytest.raises(cgff_cli.OptionError, match=rf"^{name} must have the shape \(m, {wanted}\)"):
            cgff_cli.solve_many(shipped("prism"), **{name: wrong})


@pytest.mark.parametrize("name", PRISM)
@pytest.mark.parametrize("wrong", [np.nan, np.inf, 1e31])
def test_numbers_that_are_not_finite_or_beyond_reason_are_refused(name, wrong):
    values = np.ones((2, *PRISM[name]))
    values[1, 0] = wrong
    with pytest.raises(cgff_cli.OptionError, match=f"^{name} must be .*finite numbers"):
        cgff_cli.solve_many(shipped("prism"), **{name: values})


@pytest.mark.parametrize(
    ("law", "name", "wrong", "allowed"),
    [
        ("paper", "EA", 0.0, "finite numbers from 1e-30 to 1e30"),
        ("paper", "EA", -1.0, "finite numbers from 1e-30 to 1e30"),
        ("paper", "rest_lengths", -1.0, "0 or finite numbers from 1e-30 to 1e30"),
        ("hooke", "rest_lengths", 0.0, "finite numbers from 1e-30 to 1e30"),
        ("paper", "loads", 1e31, "finite numbers of at most 1e30 in size"),
    ],
)
def test_numbers_out_of_range_are_refused(law, name, wrong, allowed):
    with pytest.raises(cgff_cli.OptionError, match=f"^{name} must be {allowed}$"):
        cgff_cli.solve_many(replace(shipped("prism"), law=law), **{name: np.full((1, *PRISM[name]), wrong)})


def test_arrays_of_different_lengths_are_refused():
    with pytest.raises(cgff_cli.OptionError, match=r"as many rows.*; rest_lengths has 2, EA has 3$"):
        cgff_cli.solve_many(shipped("prism"), rest_lengths=np.ones((2, 12)), EA=np.ones((3, 12)))


def test_what_is_no_array_of_numbers_is_refused():
    for wrong in ("many", [[1.0], [1.0, 2.0]], [["a"] * 12]):
        with pytest.raises(cgff_cli.OptionError, match=r"^EA must be an array of numbers$"):
            cgff_cli.solve_many(shipped("prism"), EA=wrong)


def test_cables_without_rest_length_are_solved_under_law_paper():
    of = replace(SCENES["net between supports"], law="paper")
    found = same_as_alone(of, {"rest_lengths": np.zeros((2, of.element_count))})
    assert not found.alone.any()
