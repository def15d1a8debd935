"""Monte Carlo form-finding against closed forms; its seed, and what its moves rest on."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cgff_cli
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.rivals.monte_carlo import _batches, _rises
from cgff_cli.scene.read import from_dict
from cgff_cli.structure import from_scene
from cgff_cli.study.record import Method
from tests.closed_forms.references import crossed_square, expanded_octahedron, prism
from tests.shapes import STRUCTURES


def _found(scene: object, **options: object) -> Method:
    return cgff_cli.compare(scene, ["mc"], repeat=1, **options).methods[1]


@pytest.mark.parametrize(
    ("reference", "law"), [(prism(3), "hooke"), (crossed_square(), "paper"), (expanded_octahedron(), "hooke")]
)
def test_from_a_tenth_of_a_length_off_it_comes_to_the_closed_form(reference, law):
    method = _found(from_dict(reference.scene(law, 0.1, 1)))
    assert (method.verdict, method.stable) == ("converged", True)
    assert method.lengths == pytest.approx(reference.lengths, rel=1e-9)


def test_heat_carries_it_over_an_unstable_equilibrium():
    # There the zeroing neural network ends, from the same start.
    method = _found(STRUCTURES / "bracket.yaml")
    assert (method.verdict, method.stable) == ("converged", True)


def test_a_seed_gives_the_same_bytes_and_another_seed_another_path():
    first, again, other = (_found(STRUCTURES / "bracket.yaml", seed=seed) for seed in (1, 1, 2))
    assert first.X.tobytes() == again.X.tobytes()
    assert first.iterations == again.iterations
    assert first.X.tobytes() != other.X.tobytes()
    assert other.energy == pytest.approx(first.energy, rel=1e-12)


def test_what_is_held_stays_and_what_may_slide_slides():
    # A cable of rest length 1 from a pin to a ring on the x axis, pulled along it: t = k (l - 1) = 3.
    scene = {
        "law": "paper",
        "nodes": {"pin": [0, 0], "ring": [0.9, 0]},
        "supports": {"pin": "xy", "ring": "y"},
        "loads": {"ring": [3, 2]},
        "elements": {"cable": {"kind": "cable", "EA": 10, "rest_length": 1, "pairs": [["pin", "ring"]]}},
    }
    method = _found(from_dict(scene))
    assert np.abs(method.X - [[0.0, 0.0], [1.3, 0.0]]).max() <= 1e-11


def test_every_node_that_can_move_is_in_one_batch_and_none_with_its_neighbour():
    structure = from_scene(cgff_cli.new("net", side=6))
    batches = [batch.nodes for batch in _batches(Mechanics(structure))]
    assert sorted(np.concatenate(batches)) == list(np.flatnonzero(structure.free.any(axis=1)))
    for nodes in batches:
        assert not (np.isin(structure.start, nodes) & np.isin(structure.end, nodes)).any()


@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-3, 0.3, 2.0]))
def test_the_rises_of_a_batch_are_what_the_energy_rises_by(seed, reach):
    rng = np.random.default_rng(seed)
    scene = cgff_cli.load(STRUCTURES / "prism.yaml")
    mechanics = Mechanics(from_scene(replace(scene, coordinates=rng.normal(size=scene.coordinates.shape))))
    for batch in _batches(mechanics):
        moves = np.zeros_like(mechanics.all)
        moves[:, batch.nodes] = reach * rng.normal(size=(3, len(batch.nodes)))
        rise = _rises(batch, mechanics.all, moves[:, batch.nodes]).sum()
        before, after = mechanics.at(mechanics.all), mechanics.at(mechanics.all + moves)
        assert rise == pytest.approx(after.energy - before.energy, abs=1e-12 * (before.energy + after.energy))
