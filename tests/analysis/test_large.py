"""Large scenes are judged as small ones are: sparse factors tell what dense matrices tell."""

from dataclasses import replace

import numpy as np
import pytest

import cgff_cli
from cgff_cli.analysis.large import stability_of_large
from cgff_cli.analysis.ranks import Ranks
from cgff_cli.analysis.reasons import ASKED_FOR
from cgff_cli.analysis.stability import stability
from cgff_cli.mechanics import connectivity
from cgff_cli.mechanics.state import Mechanics
from cgff_cli.options import SolveOptions
from cgff_cli.solvers.cgff import form_find
from cgff_cli.structure import from_scene

ASKED = set(ASKED_FOR)

SCENES = [
    ("tower", {"stages": 20, "noise": 0.03}),
    ("drum", {"struts": 6, "stages": 5}),
    ("net", {"side": 9, "jitter": 0.02}),
    ("net", {"side": 9, "rise": 0.0}),
    ("snake", {"modules": 40}),
    ("x-tower", {"stages": 50}),
    ("catenary", {"links": 60}),
    ("polyhedron", {}),
]


def judged(structure, X, floor, entries, monkeypatch):
    """Return ranks and stability of a shape, dense up to so many entries of rho."""
    monkeypatch.setattr(connectivity, "DENSE_ENTRIES", entries)
    state = Mechanics(structure).at(X)
    ranks = Ranks(state, 1e-9)
    signs = stability(state, floor) if entries else stability_of_large(state, "superlu", floor)
    return ranks.conditions() | signs | {"super_stable": ranks.is_super_stable()}


def damaged(structure, kind):
    """Return a structure with every tenth element doubled, slack or missing."""
    every = np.arange(len(structure.start))
    rows = np.concatenate((every, every[::10])) if kind == "doubled" else every[every % 10 != 5]
    columns = ("start", "end", "stiffness", "rest_lengths", "tension_only")
    if kind != "slack":
        return replace(structure, **{name: getattr(structure, name)[rows] for name in columns})
    longer = np.where(structure.tension_only & (every % 10 == 5), 1.05, 1.0)
    return replace(structure, rest_lengths=structure.rest_lengths * longer)


@pytest.mark.parametrize("kind", ["whole", "doubled", "slack", "missing"])
def test_sparse_and_dense_agree(kind, monkeypatch):
    for family, parameters in SCENES:
        whole = from_scene(cgff_cli.new(family, **parameters))
        structure = whole if kind == "whole" else damaged(whole, kind)
        found = form_find(structure, SolveOptions(max_iterations=200))
        if not found.verdict.converged:
            continue
        X, floor = found.state.X, found.balance.floor
        dense, sparse = (judged(structure, X, floor, entries, monkeypatch) for entries in (10**9, 0))
        unit = found.mechanics.frame.stiffness
        softest = pytest.approx(dense.pop("smallest_stiffness"), rel=1e-5, abs=1e-9 * unit)
        assert sparse.pop("smallest_stiffness") == softest, family
        for own in (dense, sparse):
            del own["tangent_eigenvalues"]  # of large ones the least alone, unless more are asked for
        assert (sparse.pop("rank_gap") or 1e9) >= 1e3 <= (dense.pop("rank_gap") or 1e9), family
        assert sparse == dense, family


@pytest.mark.parametrize("stages", [40, 166])
def test_ranks_of_a_long_tower_are_counted(stages):
    found = cgff_cli.solve(cgff_cli.new("tower", stages=stages)).analysis
    counted = [found[name] for name in ("self_stress_states", "mechanisms", "rigid_motions", "nullity_U")]
    assert counted == [3 * stages, 0, 6, 3 * stages]
    assert found["nullity_D"] == stages + 3
    assert (found["stability"], found["super_stable"], set(found["reason"])) == ("stable", False, ASKED)


def test_a_net_of_1500_directions_is_judged_in_full():
    found = cgff_cli.solve(cgff_cli.new("net", side=24)).analysis
    assert (found["self_stress_states"], found["mechanisms"]) == (1, 1452 - 1012 + 1)
    assert (found["super_stable"], set(found["reason"])) == (True, ASKED)


def test_the_same_large_scene_has_the_same_softest_stiffness_to_the_bit():
    scene = cgff_cli.new("tower", stages=60, noise=0.02)
    first, second = (cgff_cli.solve(scene).analysis["smallest_stiffness"] for _ in range(2))
    assert first == second
