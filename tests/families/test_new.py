"""The door to the families: same parameters, same scene; noise, jitter, laws; what is refused."""

import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.families import FAMILIES
from cgff_cli.scene.new import find, make
from cgff_cli.scene.write import to_yaml
from tests.families.cases import CASES, IDS


@pytest.mark.parametrize("name", FAMILIES)
def test_the_registry_says_what_the_family_says(name):
    assert find(name).equilibrium.__doc__.splitlines()[0] == FAMILIES[name]


@pytest.mark.parametrize("name", FAMILIES)
def test_every_parameter_has_a_default_that_its_own_rule_allows(name):
    family = find(name)
    for parameter in (family.own | family.common).values():
        assert parameter.checked(parameter.default) == parameter.default
        assert parameter.rule.help


@pytest.mark.parametrize(("name", "given"), CASES, ids=IDS)
def test_a_written_scene_reads_back_without_a_warning(name, given, assert_same):
    scene, header = make(name, {**given, "noise": 0.1})
    read = cgff_cli.loads(to_yaml(scene, header))
    assert_same(read, scene)
    assert read.warnings == ()


@pytest.mark.parametrize("name", FAMILIES)
def test_the_same_parameters_give_the_same_bytes_and_another_seed_others(name):
    texts = [to_yaml(cgff_cli.new(name, noise=0.1, jitter=0.01, seed=seed)) for seed in (1, 1, 2)]
    assert texts[0] == texts[1] != texts[2]


def test_random_numbers_are_the_same_on_every_machine():
    X = cgff_cli.new("prism", noise=0.1, seed=1).coordinates
    assert X[0].tolist() == [0.8787519965071227, -0.07632566827706602, 0.1362992237237124]


@pytest.mark.parametrize("name", FAMILIES)
def test_noise_moves_nodes_by_a_part_of_the_mean_length_and_supports_never(name):
    plain, noisy = cgff_cli.new(name), cgff_cli.new(name, noise=0.1, seed=4)
    target = find(name).equilibrium()
    reach = 0.1 * np.concatenate([target.lengths(own) for own in target.members]).mean()
    moved = np.abs(noisy.coordinates - plain.coordinates)
    assert 0.5 * reach < moved.max() <= reach * (1.0 + 1e-12)
    for row, axes in plain.supports.items():
        assert not moved[row, ["xyz".index(axis) for axis in axes]].any()


def test_jitter_changes_rest_lengths_by_at_most_its_fraction():
    plain, jittered = cgff_cli.new("net"), cgff_cli.new("net", jitter=0.02, seed=1)
    for one, other in zip(plain.groups, jittered.groups, strict=True):
        change = np.abs(other.rest_length / one.rest_length - 1.0)
        assert 0.015 < change.max() <= 0.02 * (1.0 + 1e-12)


def test_rest_lengths_follow_from_forces_by_either_law():
    target = find("octahedron").equilibrium()
    for own, group in zip(target.members, cgff_cli.new("octahedron", law="paper").groups, strict=True):
        assert group.EA * (target.lengths(own) - group.rest_length) == pytest.approx(target.forces(own))
    for own, group in zip(target.members, cgff_cli.new("octahedron").groups, strict=True):
        strain = target.lengths(own) / group.rest_length - 1.0
        assert group.EA * strain == pytest.approx(target.forces(own))


def test_struts_are_ten_times_as_stiff_as_cables_unless_asked():
    assert [group.EA[0] for group in cgff_cli.new("octahedron", EA=7.0, prestress=0.1).groups] == [7.0, 70.0]
    stiff = cgff_cli.new("octahedron", EA=7.0, strut_EA=9.0, prestress=0.1)
    assert [group.EA[0] for group in stiff.groups] == [7.0, 9.0]


def test_the_header_tells_what_made_the_scene_and_its_answer():
    _, header = make("prism", {"sides": 4, "seed": 3, "noise": 0.1, "radius": 1.0, "name": "a b"})
    lines = header.splitlines()
    assert lines[1] == "Made by: cgff new prism --sides 4 --name 'a b' --noise 0.1 --seed 3"
    assert "twist 45 degrees" in header
    assert lines[-2].split() == ["verticals", "2.141444942", "10"]


def test_the_header_of_a_net_tells_how_much_of_the_plan_has_snow():
    scene, header = make("net", {"side": 12, "span": 12.0, "snow": 2.0})
    assert -sum(load[2] for load in scene.loads.values()) == pytest.approx(2.0 * 119.008, rel=1e-5)
    assert "Snow: at nodes inside, for 119.008 of 144 of plan area; the rim takes the rest." in header
    assert "Snow" not in make("net", {})[1]


def test_the_header_promises_no_answer_where_none_is_known():
    for given in ({"jitter": 0.01}, {"snow": 1.0}):
        assert "Answer" not in make("net", given)[1]
    assert "Answer" in make("net", {})[1]


@pytest.mark.parametrize(
    ("name", "given", "message"),
    [
        ("prysm", {}, "unknown family 'prysm'; did you mean 'prism'?"),
        ("prism", {"side": 4}, "unknown parameter 'side' of prism; did you mean 'sides'?"),
        ("prism", {"sides": 2}, "sides must be a whole number from 3 to 1000000, got 2"),
        ("prism", {"sides": 3.5}, "sides must be a whole number from 3 to 1000000, got 3.5"),
        ("prism", {"sides": True}, "sides must be a whole number from 3 to 1000000, got True"),
        ("prism", {"radius": float("nan")}, "radius must be a number > 0, got nan"),
        ("prism", {"radius": "wide"}, "radius must be a number > 0, got 'wide'"),
        ("prism", {"law": "hook"}, "law must be one of paper, hooke, got 'hook'"),
        ("prism", {"height": 1, "strut": 3}, "give height or strut, not both"),
        ("prism", {"strut": 1}, "strut must be longer than 1.93185 for a radius of 1, got 1"),
        ("tower", {"twist": 30}, "twist must be between 30 and 90 for 3 sides, got 30"),
        (
            "snake",
            {"bend": 300, "modules": 1},
            "modules of length 1 and width 1 cannot be bent by 300 degrees",
        ),
        ("star-prism", {"struts": 4}, "struts must be odd, got 4: with an even number none is super-stable"),
        (
            "kresling",
            {"height": 2.0},
            "folded must be between 1 and 2, the height, with 6 sides and a radius of 1, got 0.5",
        ),
        ("levy", {"sides": 6, "rings": 7}, "rings must be at most 6 with 6 sides, got 7"),
        ("snake", {"noise": -1}, "noise must be a number from 0 to 1000000, got -1"),
        (
            "octahedron",
            {"EA": 1.0, "prestress": 9.0},
            "no rest length gives struts a force of -22.0454 with EA 10; lower the force or raise EA",
        ),
    ],
)
def test_bad_parameters_are_refused_in_words(name, given, message):
    with pytest.raises(cgff_cli.OptionError) as caught:
        cgff_cli.new(name, **given)
    assert str(caught.value) == message


def test_numbers_of_numpy_are_numbers():
    assert len(cgff_cli.new("prism", sides=np.int64(5), radius=np.float32(2)).node_names) == 10
