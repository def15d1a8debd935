"""The zeroing neural network against closed forms, with noise and without."""

from functools import partial

import pytest

import cgff_cli
from cgff_cli.rivals.registry import REGISTRY, Entry
from cgff_cli.rivals.znn import znn
from cgff_cli.scene.read import from_dict
from cgff_cli.study.record import Method
from tests.closed_forms.references import LAWS, crossed_square, expanded_octahedron, prism
from tests.shapes import STRUCTURES


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("reference", [prism(3), crossed_square(), expanded_octahedron()])
def test_near_the_answer_it_comes_to_the_closed_form(reference, law):
    scene = from_dict(reference.scene(law, 0.001, 1))
    method = cgff_cli.compare(scene, ["znn"], repeat=1).methods[1]
    assert (method.verdict, method.stable) == ("converged", True)
    assert method.residual_relative <= 1e-12
    assert method.lengths == pytest.approx(reference.lengths, rel=1e-9)


def test_it_takes_the_bracket_to_an_equilibrium_that_is_not_stable():
    method = cgff_cli.compare(STRUCTURES / "bracket.yaml", ["znn"], repeat=1).methods[1]
    assert (method.verdict, method.stable) == ("converged", False)


def test_the_integral_takes_out_a_constant_noise_and_nothing_else_does(monkeypatch):
    def noisy(**gains: float) -> Method:
        monkeypatch.setitem(REGISTRY, "znn", Entry(partial(znn, noise=1e-3, **gains)))
        options = {"repeat": 1, "time_limit": 5.0}
        return cgff_cli.compare(STRUCTURES / "bracket.yaml", ["znn"], **options).methods[1]

    assert noisy().residual_relative <= 1e-12
    without = noisy(gain=0.0)
    assert not without.converged
    assert without.residual_relative > 1e-3


def test_a_large_scene_is_refused():
    scene = cgff_cli.new("tower", stages=60)
    method = cgff_cli.compare(scene, ["znn"], repeat=1).methods[1]
    assert (method.verdict, method.nodes) == ("failed", None)
    assert "up to 500 unknowns" in method.message
