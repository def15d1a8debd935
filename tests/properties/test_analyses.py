"""What must not matter to an analysis: where a shape stands, its numbering, its units, sparse or dense."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cgff_cli
from cgff_cli.scene.read import from_dict
from tests.properties.test_invariances import FREE, HELD, few, moved, read, scaled, seeds

WORDS = ("self_stress_states", "mechanisms", "stability", "super_stable", "prestress_stable", "parts")
COUNTS = ("negative_eigenvalues", "nullity_D", "nullity_U", "rigid_motions", "slack_count")


@pytest.fixture(scope="module")
def at_rest():
    """Return a shipped scene as plain values, its start the answer, and the analysis of it."""
    kept = {}

    def get(name):
        if name not in kept:
            mapping = read(name)
            mapping["nodes"] = cgff_cli.solve(from_dict(mapping), tolerance=1e-13).nodes
            kept[name] = mapping, cgff_cli.analyse(from_dict(mapping)).analysis
        return kept[name]

    return get


def same(found, known, stiffness=1.0):
    """Assert that two analyses tell the same, in units that make stiffnesses so many times larger."""
    assert [found[name] for name in (*WORDS, *COUNTS)] == [known[name] for name in (*WORDS, *COUNTS)]
    size = max(known["tangent_eigenvalues"])
    values = np.array(found["tangent_eigenvalues"]) / stiffness
    assert values == pytest.approx(known["tangent_eigenvalues"], rel=1e-6, abs=1e-9 * size)
    for name in ("critical_load_factor", "first_slack_factor"):
        factors = [own[name] for own in (found, known)]
        assert factors[0] == (None if factors[1] is None else pytest.approx(factors[1], rel=1e-6))
    first, other = (
        [frozenset(cable.split(": ")[1].split("-")) for cable in own["first_slack_cables"] or ()]
        for own in (found, known)
    )
    assert set(first) == set(other)
    assert set(found["reason"]) == set(known["reason"])
    kinds = [[(mode["kind"], mode["stiffness"]) for mode in own["modes"]] for own in (found, known)]
    for (kind, ours), (other, theirs) in zip(*kinds, strict=True):
        assert kind == other
        assert ours / stiffness == pytest.approx(theirs, rel=1e-6, abs=1e-9 * size)


@pytest.mark.parametrize("name", [*FREE, *HELD])
@few
@given(seed=seeds)
def test_turning_and_shifting_a_shape_changes_nothing(name, seed, at_rest):
    mapping, known = at_rest(name)
    rng = np.random.default_rng(seed)
    d = len(next(iter(mapping["nodes"].values())))
    turn = np.linalg.qr(rng.normal(size=(d, d)))[0]
    same(cgff_cli.analyse(from_dict(moved(mapping, turn, 100.0 * rng.normal(size=d)))).analysis, known)


@pytest.mark.parametrize("name", [*FREE, *HELD])
@few
@given(length=st.sampled_from([1e-3, 0.3048, 25.4, 1e3]), force=st.sampled_from([1e-3, 4.448, 1e6]))
def test_units_only_scale_stiffnesses(name, length, force, at_rest):
    mapping, known = at_rest(name)
    same(cgff_cli.analyse(from_dict(scaled(mapping, length, force))).analysis, known, force / length)


@pytest.mark.parametrize("name", [*FREE, *HELD])
@few
@given(seed=seeds)
def test_neither_numbering_nor_direction_matters(name, seed, at_rest):
    mapping, known = at_rest(name)
    rng = np.random.default_rng(seed)
    nodes = list(mapping["nodes"].items())
    shuffled = dict(nodes[row] for row in rng.permutation(len(nodes)))
    elements = {}
    for group, own in mapping["elements"].items():
        order = rng.permutation(len(own["pairs"])).tolist()
        listed = {key: [value[row] for row in order] for key, value in own.items() if isinstance(value, list)}
        listed["pairs"] = [pair[:: rng.choice([1, -1])] for pair in listed["pairs"]]
        elements[group] = own | listed
    same(cgff_cli.analyse(from_dict(mapping | {"nodes": shuffled, "elements": elements})).analysis, known)
