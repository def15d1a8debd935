"""Powers of two change no bit, even where squares leave the doubles; distance costs no digits."""

from dataclasses import replace

import numpy as np
import pytest

import cgff_cli
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.cgff import form_find
from cgff_cli.structure import Structure, from_scene
from tests.solvers.scenes import SHIPPED, shipped


def in_units(structure: Structure, length: float, stiffness: float) -> Structure:
    return replace(
        structure,
        coordinates=structure.coordinates * length,
        rest_lengths=structure.rest_lengths * length,
        stiffness=structure.stiffness * stiffness,
        loads=structure.loads * (length * stiffness),
    )


# Powers of two: of the unit of length, of the unit of stiffness. 2^400 is 1e120, 2^-660 is 1e-199: their
# squares, which l^2, K^2 and eq. (10) hold, are no doubles or lose digits.
@pytest.mark.parametrize("powers", [(1, -1), (-40, 60), (400, 0), (0, -660), (300, -300), (-300, -300)])
@pytest.mark.parametrize("objective", ["energy", "residual"])
@pytest.mark.parametrize("name", SHIPPED)
def test_units_that_differ_by_powers_of_two_give_the_same_bits(name, objective, powers):
    structure, options = from_scene(shipped(name)), SolveOptions(objective=objective)
    length, stiffness = 2.0 ** powers[0], 2.0 ** powers[1]
    usual = form_find(structure, options)
    found = form_find(in_units(structure, length, stiffness), options)
    assert found.verdict == usual.verdict
    assert np.array_equal(found.coordinates / length, usual.coordinates)
    for column in ("alpha", "beta", "evaluations", "restarted"):
        assert found.history[column] == usual.history[column]
    assert found.residual_max / (length * stiffness) == usual.residual_max
    assert np.array(found.history["step_norm"]) / length == pytest.approx(
        np.array(usual.history["step_norm"]), rel=1e-15
    )


@pytest.mark.parametrize(("factor", "units"), [(1.0, 1.0), (1e6, 1e-9), (1e-25, 1e25), (1e25, 1e-25)])
def test_the_frame_brings_size_and_stiffness_to_between_one_and_two(factor, units):
    structure = in_units(from_scene(shipped("prism")), factor, units)
    mechanics = Mechanics(structure)
    frame = mechanics.frame
    assert 1.0 <= max(np.abs(mechanics.start).max(), mechanics.l0.max()) < 2.0
    assert 1.0 <= mechanics.k.max() < 2.0
    assert np.log2([frame.length, frame.stiffness]) % 1.0 == pytest.approx([0.0, 0.0])
    assert mechanics.shape(mechanics.start) + frame.centre == pytest.approx(structure.coordinates)


@pytest.mark.parametrize("offset", [1e6, 1e9])
@pytest.mark.parametrize("name", ["x-module", "hexagon", "prism", "octahedron"])
def test_far_from_the_origin_lengths_keep_their_digits(name, offset):
    here, scene = cgff_cli.solve(shipped(name), tolerance=1e-12), shipped(name)
    far = cgff_cli.solve(replace(scene, coordinates=scene.coordinates + offset), tolerance=1e-12)
    assert far.converged
    assert far.lengths == pytest.approx(here.lengths, rel=1e-11)
    assert far.forces == pytest.approx(here.forces, rel=1e-9)
    assert far.energy == pytest.approx(here.energy, rel=1e-9)
    assert far.residual["relative"] <= 1e-11
    centre = far.coordinates.mean(axis=0)
    assert centre == pytest.approx((scene.coordinates + offset).mean(axis=0), rel=1e-12)


@pytest.mark.parametrize("offset", [1e6, 1e9])
def test_far_from_the_origin_supports_stay_where_they_are_and_loads_do_their_work_from_there(offset):
    scene = shipped("bracket")
    here, far = cgff_cli.solve(scene), cgff_cli.solve(replace(scene, coordinates=scene.coordinates + offset))
    assert far.nodes["foot"] == [offset, offset]
    assert far.nodes["head"] == [offset, offset + 3.0]
    spacing = np.spacing(offset)
    assert far.lengths == pytest.approx(here.lengths, abs=2.0 * spacing)
    assert far.energy == pytest.approx(here.energy + 30.0 * offset, rel=1e-12)
