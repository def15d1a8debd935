"""How many stable shapes a structure has: closed forms, symmetries, and nothing that chance decides."""

from dataclasses import replace
from itertools import pairwise
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.optimize import brentq

import cgff_cli
from cgff_cli import equilibria
from cgff_cli.report.equilibria_text import equilibria_page, verdict_of
from cgff_cli.report.json_out import pretty
from cgff_cli.report.terminal import rendered
from cgff_cli.structure import from_scene
from cgff_cli.study.levels import levels
from cgff_cli.study.starts import REACHES, along_modes, random_start, size_of_start
from tests.bodies import forces_by_loop
from tests.shapes import STRUCTURES, distance_difference, node_difference
from tests.study.landscapes import as_struts, dome, kresling, row_of_trusses, tetrahedron, truss, unstrained


def shipped(name: str) -> "cgff_cli.Scene":
    return cgff_cli.load(STRUCTURES / f"{name}.yaml")


@pytest.mark.parametrize("name", ["prism", "x-module", "hexagon"])
def test_a_structure_of_cables_that_only_pull_has_one_stable_shape(name: str):
    found = equilibria(shipped(name), starts=300)
    (only,) = found.equilibria
    assert (only["count"], only["stability"], only["first_start"], found.kinds) == (300, "stable", 0, 1)
    assert only["residual_relative"] < 1e-12


def test_the_prism_whose_cables_can_push_has_a_second_kind_three_times():
    found = equilibria(as_struts(shipped("prism")), starts=300)
    assert [own["kind"] for own in found.equilibria] == [1, 2, 2, 2]
    assert found.equilibria[0]["energy"] == pytest.approx(0.7426154273)


def test_a_truss_stands_or_hangs_and_the_mirror_makes_it_one_kind_unless_it_is_loaded():
    free, loaded = equilibria(truss()), equilibria(truss(load=1.0))
    assert sorted(round(own.coordinates[2, 1], 9) for own in free.shapes) == [-0.5, 0.5]
    assert (free.kinds, loaded.kinds) == (1, 2)


@pytest.mark.parametrize("load", [0.5, 2.0, 4.0])
def test_the_heights_of_a_loaded_truss_are_the_roots_of_its_force(load: float):
    rest = np.hypot(1.0, 0.5)

    def force(y: float) -> float:
        l = np.hypot(1.0, y)
        return 2.0 * 100.0 / rest * (l - rest) * y / l + load

    grid = np.linspace(-1.0, 1.0, 401)
    roots = [brentq(force, a, b) for a, b in pairwise(grid) if force(a) * force(b) < 0.0]
    rising = [y for y in roots if force(y + 1e-6) > force(y - 1e-6)]
    found = equilibria(truss(load), starts=100)
    assert sorted(own.coordinates[2, 1] for own in found.shapes) == pytest.approx(sorted(rising), abs=1e-9)
    assert [own["energy"] for own in found.equilibria] == sorted(own["energy"] for own in found.equilibria)


def test_trusses_in_a_row_have_a_shape_for_each_choice_of_up_and_down():
    found = equilibria(row_of_trusses(4), starts=400)
    ups = {tuple(own.coordinates[5:, 1] > 0.0) for own in found.shapes}
    assert (len(found.shapes), len(ups)) == (16, 16)
    assert found.kinds == 8  # a mirror takes all that is up down


def test_two_shapes_may_have_all_lengths_and_the_energy_in_common():
    tower = equilibria(cgff_cli.new("x-tower", stages=2))
    one, other = tower.shapes
    assert one.energy == pytest.approx(other.energy, rel=1e-9)
    assert distance_difference(one.coordinates, other.coordinates) > 0.1
    assert tower.kinds == 2


def test_a_kresling_module_has_both_its_unstrained_shapes():
    twist = 0.4
    found = equilibria(kresling(twist), starts=300)
    height = np.sqrt(1.0 + 2.0 * (np.cos(np.pi / 3.0 - twist) - np.cos(twist)))
    for wanted in (kresling(twist), kresling(np.pi / 3.0 - twist, height)):
        same = [
            own for own in found.shapes if distance_difference(own.coordinates, wanted.coordinates) < 1e-6
        ]
        assert len(same) == 1
        assert same[0].energy < 1e-20


@pytest.mark.parametrize("noise", [0.0, 0.05, 0.1])
def test_shapes_of_one_energy_are_told_together_in_the_order_that_starts_found_them(noise: float):
    found = equilibria(cgff_cli.new("x-tower", stages=3, noise=noise, seed=1), starts=100)
    firsts = {own["kind"]: own["first_start"] for own in reversed(found.equilibria)}
    assert found.least == list(range(len(found.shapes)))  # stages up, or folded into each other
    assert len(firsts) > 2
    assert [firsts[kind] for kind in sorted(firsts)] == sorted(firsts.values())
    words = f"{len(found.shapes)} shapes of {found.kinds} kinds share the least energy, "
    assert words in verdict_of(found)


def test_the_shape_of_least_energy_is_one_where_a_load_tells_up_from_down():
    found = equilibria(truss(load=1.0), starts=50)
    best = found.equilibria[0]
    assert found.least == [0]
    assert verdict_of(found).endswith(f"the one of least energy, {best['energy']:.6g}, from {best['count']}")


@pytest.mark.parametrize("scene", [kresling(), truss(), truss(rise=1e-4), row_of_trusses(2)])
def test_an_energy_of_nothing_but_rounding_is_told_as_0_and_written_as_it_is(scene: "cgff_cli.Scene"):
    found = equilibria(scene, starts=60)
    assert len(found.least) == len(found.shapes) > 1
    assert {own.energy_told for own in (*found.landscape.shapes, *found.shapes)} == {0.0}
    assert [own["energy"] for own in found.equilibria] == [own.energy for own in found.shapes]
    assert "share the least energy, 0, from 60" in verdict_of(found)
    page = rendered(equilibria_page(found), terminal=False)
    assert {line.split()[1] for line in page.splitlines()[-len(found.shapes) :]} == {"0"}


def test_a_small_energy_that_is_none_of_rounding_is_told():
    nodes = {"left": [-1.0, 0.0], "middle": [0.0, 0.0], "right": [1.0, 0.0]}
    cable = unstrained(
        nodes, [["left", "middle"], ["middle", "right"]], supports={"left": "xy", "right": "xy"}
    )
    (group,) = cable.groups
    short = replace(cable, groups=(replace(group, rest_length=group.rest_length - 1e-9),))
    best = equilibria(short, starts=1).shapes[0]
    assert best.energy_told == pytest.approx(2 * 0.5 * 100.0 * 1e-18, rel=1e-5)


def test_what_rounding_parts_from_the_least_of_a_level_is_in_it_and_nothing_chains():
    shapes = [SimpleNamespace(energy=energy, energy_floor=0.5) for energy in (3.7, 0.9, 0.0, 1.8, 2.7, 1e3)]
    assert levels(shapes) == [2, 0, 0, 1, 1, 3]


def test_the_octahedron_has_24_shapes_of_six_kinds():
    found = equilibria(shipped("octahedron"), starts=2000)
    kinds = [own["kind"] for own in found.equilibria]
    assert [kinds.count(kind) for kind in range(1, 7)] == [1, 12, 3, 4, 3, 1]
    assert len({own["energy"] for own in found.equilibria}) == 6


def test_what_supports_and_loads_leave_free_makes_no_new_shape():
    counts = {
        "free": equilibria(tetrahedron(), starts=60),
        "hinged in one node": equilibria(tetrahedron(supports={"a": "xyz"}), starts=60),
        "on an axle": equilibria(tetrahedron(supports={"a": "xyz", "b": "xyz"}), starts=60),
        "hanging": equilibria(tetrahedron(supports={"a": "xyz"}, loads={"d": [0, 0, -1]}), starts=60),
        "pulled apart": equilibria(tetrahedron(loads={"a": [0, 0, -1], "d": [0, 0, 1]}), starts=60),
        "held here and there": equilibria(tetrahedron(supports={"a": "x", "b": "y", "c": "z"}), starts=60),
    }
    shapes = {name: len(found.shapes) for name, found in counts.items()}
    assert shapes == {"free": 1, **dict.fromkeys(list(counts)[1:], 2)}  # mirror images apart from free ones
    assert {found.kinds for found in counts.values()} == {1}


def test_every_shape_told_is_balanced_where_it_stands_and_held_where_supports_are():
    hung = tetrahedron(supports={"a": "xyz", "b": "z"}, loads={"d": [0.3, 0, -1]})
    for scene in (truss(load=1.0), hung, tetrahedron(loads={"a": [0, 0, -1], "d": [0, 0, 1]}), kresling()):
        structure = from_scene(scene)
        for own in equilibria(scene, starts=20).shapes:
            left = forces_by_loop(structure, own.coordinates)[structure.free]
            assert np.abs(left).max() < 1e-11
            held = ~structure.free
            assert (own.coordinates[held] == structure.coordinates[held]).all()


def test_a_load_breaks_the_symmetry_of_a_dome():
    free, loaded = equilibria(dome(), starts=600), equilibria(dome(load=0.1), starts=600)
    assert free.kinds < loaded.kinds
    through = loaded.shapes[0].coordinates
    assert (through[1:13:2, 2] < 0.0).all()  # what a load on its top would have is all of it snapped through


def test_a_heap_of_slack_cables_is_neutral_and_only_counted():
    scene = tetrahedron()
    heap = replace(scene, groups=tuple(replace(group, kind="cable") for group in scene.groups))
    found = equilibria(heap, starts=20)
    assert (found.equilibria, found.led_to("neutral"), found.kinds) == ([], 20, 0)
    listed = equilibria(heap, starts=20, everything=True)
    assert {own["stability"] for own in listed.equilibria} == {"neutral"}


def test_what_does_not_converge_is_counted_and_is_no_shape():
    found = equilibria(shipped("prism"), starts=20, max_iterations=1)
    assert (found.landscape.not_converged, found.equilibria) == (20, [])


def test_unstable_equilibria_are_left_along_their_modes_and_listed_when_asked_for():
    found = equilibria(shipped("prism"), starts=40, objective="residual", everything=True)
    words = [own["stability"] for own in found.equilibria]
    assert {"stable", "unstable"} <= set(words)
    assert sum(own["count"] for own in found.equilibria) == 40
    assert found.led_to("unstable") == sum(
        own["count"] for own in found.equilibria if own["stability"] == "unstable"
    )


def test_only_stable_ones_are_listed_unless_asked_for_more():
    found = equilibria(shipped("prism"), starts=40, objective="residual")
    assert {own["stability"] for own in found.equilibria} == {"stable"}
    assert found.led_to("unstable") > 0


def test_shapes_that_are_near_each_other_are_two_all_the_same():
    found = equilibria(truss(rise=1e-4), starts=20)
    assert sorted(own.coordinates[2, 1] for own in found.shapes) == pytest.approx([-1e-4, 1e-4])


def test_the_first_start_of_a_shape_leads_to_it_again():
    scene = shipped("octahedron")
    structure, found = from_scene(scene), equilibria(scene, starts=1000)
    late = [own for own in found.shapes if 200 < own.first_start < 500]
    assert late
    for own in late:
        start = random_start(structure, 0, own.first_start)
        again = cgff_cli.solve_many(scene, coordinates=[start]).coordinates[0]
        assert distance_difference(again, own.coordinates) < 1e-6


def test_starts_along_a_mode_stand_to_either_side_of_the_shape():
    up = equilibria(truss(load=1.0), starts=50).shapes[0]
    starts = list(along_modes(from_scene(truss(load=1.0)), [up]))
    assert len(starts) == 2 * len(REACHES) * len(up.modes)
    assert len(up.modes) == 2  # the top has two directions
    middle = 0.5 * (np.array(starts[::2]) + np.array(starts[1::2]))
    assert np.abs(middle - up.coordinates).max() < 1e-12
    moved = np.linalg.norm(starts - up.coordinates, axis=2).max(axis=1)
    assert moved == pytest.approx(2 * [r * size_of_start(from_scene(truss())) for r in REACHES for _ in "+-"])


def test_every_start_is_counted_once():
    found = equilibria(shipped("octahedron"), starts=333, seed=3)
    assert found.starts == 333
    assert sum(own["count"] for own in found.equilibria) == 333


def test_the_same_seed_gives_the_same_bytes_whoever_does_the_work_and_another_seed_others():
    told = [
        "".join(
            pretty(equilibria(shipped("octahedron"), starts=1700, seed=seed, jobs=jobs).to_dict().items())
        )
        for seed, jobs in ((0, 1), (0, 2), (1, 1))
    ]
    assert told[0] == told[1] != told[2]


def test_an_interrupt_keeps_what_was_found():
    def interrupt(done: int, total: int, words: str) -> None:
        assert (done, total, words) == (200, 5000, "starts, distinct equilibria: 1")
        raise KeyboardInterrupt

    found = equilibria(shipped("prism"), starts=5000, watcher=interrupt)
    assert found.is_interrupted
    assert (found.starts, len(found.shapes)) == (200, 1)


def test_starts_are_a_whole_number_of_at_least_one():
    with pytest.raises(cgff_cli.OptionError, match="starts must be a whole number"):
        equilibria(shipped("prism"), starts=0)


def test_shapes_lie_over_the_start_and_over_each_other():
    scene = shipped("prism")
    (own,) = equilibria(scene, starts=20).shapes
    assert node_difference(own.coordinates, scene.coordinates) == pytest.approx(
        np.abs(own.coordinates - scene.coordinates).max()
    )
    assert node_difference(own.coordinates, cgff_cli.solve(scene).coordinates) < 1e-9
