"""Weight of elements, and forces asked for at the start: what statics says on paper."""

from dataclasses import replace

import mpmath
import numpy as np
import pytest

import cgff_cli
from cgff_cli.scene.read import from_dict
from cgff_cli.structure import from_scene
from tests.closed_forms.references import LAWS, hypar_net, prism


def chain(law: str, points: list, lengths: float, EA: float, weight: float, **more: object) -> dict:
    """Return cables in a row from n0, held, each of one rest length; EA is Hooke's under either law."""
    pairs = [[f"n{i}", f"n{i + 1}"] for i in range(len(points) - 1)]
    k = EA if law == "hooke" else EA / lengths
    links = {"kind": "cable", "EA": k, "rest_length": lengths, "weight": weight, "pairs": pairs}
    nodes = {f"n{i}": list(point) for i, point in enumerate(points)}
    return {"law": law, "nodes": nodes, "elements": {"links": links}, "supports": {"n0": "xy"}, **more}


def elastic_catenary(span: float, length: float, EA: float, weight: float) -> tuple[float, float, float]:
    """Return sag, and horizontal and vertical pull at a support, of a cable between two level supports.

    Irvine, Cable Structures, eqs. (1.31) and (1.32) at half of the unstrained length, 30 digits deep.
    """
    with mpmath.workdps(30):
        L, W = mpmath.mpf(length), mpmath.mpf(weight) * length

        def unmet(H: mpmath.mpf) -> mpmath.mpf:
            return H * L / EA + 2 * H * L / W * mpmath.asinh(W / (2 * H)) - span

        H = mpmath.findroot(unmet, W / 2)
        sag = W * L / (8 * EA) + H * L / W * (mpmath.sqrt(1 + (W / (2 * H)) ** 2) - 1)
        return float(sag), float(H), float(W / 2)


def hanging(law: str, links: int, EA: float = 300.0) -> "cgff_cli.Result":
    """Return a cable of length 12 and weight 2 per length between supports 10 apart."""
    x = np.linspace(0.0, 10.0, links + 1)
    points = np.column_stack([x, -0.3 * x * (10.0 - x) / 10.0]).tolist()
    scene = chain(law, points, 12.0 / links, EA, 2.0)
    scene["supports"][f"n{links}"] = "xy"
    return cgff_cli.solve(from_dict(scene), tolerance=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_a_cable_hangs_as_the_elastic_catenary_to_the_second_order_of_its_links(law):
    sag, pull, _ = elastic_catenary(10.0, 12.0, 300.0, 2.0)
    errors = []
    for links in (8, 16, 32):
        result = hanging(law, links)
        assert result.converged
        at_end = np.array(result.reactions["n0"])
        assert at_end[1] == pytest.approx(12.0, rel=1e-11)  # half of the weight
        errors.append((-result.coordinates[links // 2, 1] / sag - 1.0, -at_end[0] / pull - 1.0))
    assert np.abs(errors[2]).max() < 2e-3
    assert np.divide(errors[:-1], errors[1:]) == pytest.approx(np.full((2, 2), 4.0), rel=0.05)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("links", [1, 2, 7])
def test_a_hanging_rod_lengthens_by_half_its_weight_over_its_stiffness(law, links):
    # With half of each link's weight at either end this is exact for any number of links.
    points = [[0.0, -3.0 * i / links] for i in range(links + 1)]
    result = cgff_cli.solve(from_dict(chain(law, points, 3.0 / links, 50.0, 4.0)), tolerance=1e-13)
    assert -result.nodes[f"n{links}"][1] - 3.0 == pytest.approx(4.0 * 3.0**2 / (2.0 * 50.0), rel=1e-10)
    below = 12.0 / links * (np.arange(links, 0, -1) - 0.5)
    assert result.forces == pytest.approx(below, rel=1e-10)
    assert result.reactions["n0"] == pytest.approx([0.0, 12.0], abs=1e-10)


def heavy_net(law: str, **more: object) -> "cgff_cli.Scene":
    """Return a hypar net of heavy cables, some heavier than others."""
    scene = hypar_net(4).scene(law, 0.05, 1) | more
    scene["elements"]["sagging"]["weight"] = 0.7
    scene["elements"]["hogging"]["weight"] = np.linspace(0.0, 1.0, 12).tolist()
    return from_dict(scene)


@pytest.mark.parametrize("law", LAWS)
def test_supports_carry_loads_and_the_weight_of_rest_lengths_at_supports_too(law):
    scene = heavy_net(law)
    result = cgff_cli.solve(scene, tolerance=1e-12)
    total = scene.weights @ result.structure.rest_lengths
    loads = np.sum(list(scene.loads.values()), axis=0)
    assert np.sum(list(result.reactions.values()), axis=0) == pytest.approx(
        [0.0, 0.0, total - loads[2]], abs=1e-9
    )


@pytest.mark.parametrize("law", LAWS)
def test_gravity_turned_with_the_structure_turns_the_answer(law):
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    scene = heavy_net(law)
    turned = replace(
        scene,
        coordinates=scene.coordinates @ turn.T,
        loads={row: tuple(turn @ load) for row, load in scene.loads.items()},
        gravity=tuple(7.0 * turn @ [0.0, 0.0, -1.0]),
    )
    one, other = (cgff_cli.solve(own, tolerance=1e-12) for own in (scene, turned))
    assert other.coordinates == pytest.approx(one.coordinates @ turn.T, abs=1e-9)
    assert other.forces == pytest.approx(one.forces, rel=1e-9)


@pytest.mark.parametrize("law", LAWS)
def test_other_units_change_no_iterate(law):
    scene, mm, kN = heavy_net(law), 1024.0, 1.0 / 1024.0
    groups = tuple(
        replace(
            group,
            EA=group.EA * (kN if law == "hooke" else kN / mm),
            rest_length=group.rest_length * mm,
            weight=group.weight * kN / mm,
        )
        for group in scene.groups
    )
    loads = {row: tuple(kN * np.array(load)) for row, load in scene.loads.items()}
    other = replace(scene, coordinates=scene.coordinates * mm, groups=groups, loads=loads)
    one, same = (cgff_cli.solve(own, tolerance=1e-12) for own in (scene, other))
    assert same.counts == one.counts
    assert (same.coordinates / mm).tolist() == one.coordinates.tolist()


@pytest.mark.parametrize("law", LAWS)
def test_many_weights_are_solved_as_each_alone(law):
    scene = heavy_net(law)
    weights = np.random.default_rng(5).uniform(0.0, 2.0, (4, scene.element_count))
    answers = cgff_cli.solve_many(scene, weights=weights, tolerance=1e-12)
    for own, shape, forces in zip(weights, answers.coordinates, answers.forces, strict=True):
        alone = cgff_cli.solve(scene.with_weights(own), tolerance=1e-12)
        assert shape == pytest.approx(alone.coordinates, abs=1e-9)
        assert forces == pytest.approx(alone.forces, abs=1e-9)


def pulled(law: str, **pretension: object) -> "cgff_cli.Scene":
    """Return the prism at its answer, its groups under forces that are asked for."""
    scene = prism(3).scene(law)
    for name, group in scene["elements"].items():
        del group["rest_length"]
        group["pretension"] = pretension[name]
    return from_dict(scene)


@pytest.mark.parametrize("law", LAWS)
def test_elements_begin_with_the_forces_asked_for(law):
    asked = np.linspace(0.5, 6.0, 6)
    scene = pulled(law, sides=asked.tolist(), verticals=0.0, struts=[-3.0, 4.0, -0.25])
    structure = from_scene(scene)
    forces = structure.stiffness * (scene_lengths(scene) - structure.rest_lengths)
    assert forces == pytest.approx([*asked, 0.0, 0.0, 0.0, -3.0, 4.0, -0.25], rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("law", LAWS)
def test_where_the_forces_asked_for_balance_nothing_moves(law):
    reference = prism(3)
    sides, verticals, struts = np.split(reference.forces, [6, 9])
    scene = pulled(law, sides=sides.tolist(), verticals=verticals.tolist(), struts=struts.tolist())
    result = cgff_cli.solve(scene, tolerance=1e-12)
    assert result.counts["iterations"] == 0
    assert result.coordinates.tolist() == scene.coordinates.tolist()
    assert result.forces == pytest.approx(reference.forces, rel=1e-12)


SWEPT = """\
law: {law}
nodes: {{a: [0, 0], b: [2, -0.2], c: [4, 0]}}
elements:
  rope: {{kind: cable, EA: 1000, pretension: {pretension}, weight: {weight}, pairs: [[a, b], [b, c]]}}
supports: {{a: xy, c: xy}}
"""


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize(("key", "values"), [("pretension", [5.0, 20.0, 80.0]), ("weight", [0.0, 0.1, 3.0])])
def test_a_sweep_is_so_many_scenes(law, key, values):
    asked = {"pretension": 10.0, "weight": 0.5}
    scene = cgff_cli.loads(SWEPT.format(law=law, **asked))
    rows = list(cgff_cli.sweep(scene, set={f"rope.{key}": values}, out=["force:rope", "node:b"]))
    for value, row in zip(values, rows, strict=True):
        alone = cgff_cli.solve(cgff_cli.loads(SWEPT.format(law=law, **asked | {key: value})))
        assert row["verdict"] == alone.verdict
        assert row["node:b.y"] == pytest.approx(alone.nodes["b"][1], rel=1e-7, abs=1e-8)
        assert row["force:rope.max"] == pytest.approx(alone.forces.max(), rel=1e-7)


@pytest.mark.parametrize("law", LAWS)
@pytest.mark.parametrize("shared", [{}, {"by_symmetry": True}])
@pytest.mark.parametrize("family", ["net", "geiger"])
def test_prestress_holds_a_shape_with_its_own_weight(family, shared, law):
    held = cgff_cli.prestress(heavy(family, law), **shared)
    assert held.feasible, held.reason
    given = cgff_cli.analyse(held.scene)
    assert given.residual["relative"] < 1e-13
    result = cgff_cli.solve(held.scene)
    below = held.scene.weights @ held.rest_lengths - sum(load[2] for load in held.scene.loads.values())
    assert sum(own[2] for own in result.reactions.values()) == pytest.approx(below, rel=1e-10)
    assert result.counts["iterations"] == 0
    assert result.coordinates.tolist() == held.scene.coordinates.tolist()


def test_what_the_weight_of_no_rest_lengths_found_is_borne_by_is_not_proven_impossible():
    scene = heavy_net("hooke")  # under this weight cables go slack
    shape = scene.with_coordinates(cgff_cli.solve(scene, tolerance=1e-14).coordinates)
    held = cgff_cli.prestress(shape)
    assert held.feasible is None
    assert held.reason.startswith("rest lengths decide the weight")
    light = cgff_cli.prestress(shape.with_weights(np.zeros(shape.element_count)))
    assert light.feasible is False


def heavy(family: str, law: str) -> "cgff_cli.Scene":
    """Return a dome, or the shape that a net has found, all elements of which have weight."""
    if family == "net":  # few shapes of a net can be held: there are more directions than cables
        scene = heavy_net(law)
        scene = scene.with_weights(0.1 * scene.weights)  # so that no cable is slack
        return scene.with_coordinates(cgff_cli.solve(scene, tolerance=1e-14).coordinates)
    scene = replace(cgff_cli.new(family), law=law)
    return scene.with_weights(np.full(scene.element_count, 0.01))


def scene_lengths(scene: "cgff_cli.Scene") -> np.ndarray:
    """Return (b,) the lengths of elements at the start."""
    X, pairs = scene.coordinates, np.concatenate([group.pairs for group in scene.groups])
    return np.linalg.norm(X[pairs[:, 0]] - X[pairs[:, 1]], axis=1)
