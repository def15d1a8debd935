"""The Python door: light to open, and the fields of a JSON result as attributes of the same names."""

import os
import subprocess
import sys

import numpy as np
import pytest

import cgff_cli
from tests.shapes import STRUCTURES

PRISM = STRUCTURES / "prism.yaml"
FIELDS = {
    "schema": str,
    "tool": {"name", "version"},
    "scene": {"name", "path", "law", "dimension"},
    "options": set(cgff_cli.SolveOptions().to_dict()),
    "verdict": str,
    "converged": bool,
    "message": str,
    "residual": {"max", "norm", "relative", "rounding_floor"},
    "energy": float,
    "max_strain": float,
    "max_displacement": float,
    "counts": {"iterations", "evaluations", "factorizations", "restarts"},
    "timing": {"seconds"},
    "supports": dict,
    "loads": dict,
    "groups": {"triangles", "verticals", "struts"},
    "nodes": {"n1", "n2", "n3", "n4", "n5", "n6"},
    "elements": list,
    "analysis": {
        "nullity_D",
        "nullity_U",
        "self_stress_states",
        "mechanisms",
        "stable",
        "super_stable",
    },
    "history": {
        "iteration",
        "objective",
        "residual_max",
        "gradient_norm",
        "step_norm",
        "alpha",
        "beta",
        "evaluations",
    },
}


def modules_after(code: str) -> set[str]:
    """Return the names of all modules loaded once a fresh interpreter has run the code."""
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    run = subprocess.run(
        [sys.executable, "-c", f"{code}\nimport sys; print(*sys.modules)"],
        cwd=PRISM.parent.parent,
        env=environment,
        capture_output=True,
        check=True,
        text=True,
    )
    return set(run.stdout.split())


@pytest.fixture(scope="module")
def prism():
    return cgff_cli.solve(cgff_cli.load(PRISM))


def test_importing_the_package_loads_neither_numpy_nor_anything_heavier():
    loaded = modules_after("import cgff_cli")
    assert "cgff_cli" in loaded
    assert not loaded & {"numpy", "scipy", "yaml", "click", "rich"}
    assert not any(name.startswith("cgff_cli.") for name in loaded)


def test_solving_a_small_scene_loads_numpy_but_not_scipy_and_nothing_of_the_command_line():
    loaded = modules_after("import cgff_cli; cgff_cli.solve('structures/prism.yaml')")
    assert "numpy" in loaded
    assert not loaded & {"scipy", "rich", "click", "numpy.random"}


def test_every_name_on_the_door_opens():
    for name in cgff_cli.__all__:
        assert getattr(cgff_cli, name) is not None
    assert set(cgff_cli.__all__) <= set(dir(cgff_cli))


def test_a_name_that_is_not_there_is_an_attribute_error():
    with pytest.raises(AttributeError, match="module 'cgff_cli' has no attribute 'slove'"):
        cgff_cli.slove  # noqa: B018


@pytest.mark.parametrize("field", list(FIELDS))
def test_a_result_has_every_field_of_the_json_as_an_attribute(prism, field):
    value, expected = getattr(prism, field), FIELDS[field]
    if isinstance(expected, set):
        assert expected <= set(value)
    else:
        assert type(value) is expected
    assert prism.to_dict()[field] == value


def test_elements_hold_what_the_contract_lists(prism):
    keys = ["group", "start", "end", "kind", "EA", "rest_length", "length", "force", "force_density", "slack"]
    keys.append("strain")
    for element in prism.elements:
        assert list(element) == keys
        stretch = element["length"] - element["rest_length"]
        assert element["force"] == pytest.approx(element["EA"] * stretch, rel=1e-12)  # law paper
        assert element["force_density"] == pytest.approx(element["force"] / element["length"], rel=1e-14)
        assert element["slack"] is False
        assert element["strain"] == pytest.approx(stretch / element["rest_length"], rel=1e-12)
    assert [element["group"] for element in prism.elements] == ["triangles"] * 6 + ["verticals"] * 3 + [
        "struts"
    ] * 3


def test_reactions_are_there_where_there_are_supports_and_hold_the_loads(prism):
    bracket = cgff_cli.solve(cgff_cli.load(STRUCTURES / "bracket.yaml"))
    assert set(bracket.to_dict()["reactions"]) == {"foot", "head"}
    assert np.sum(list(bracket.reactions.values()), axis=0) == pytest.approx([0.0, 30.0], abs=1e-8)
    assert prism.reactions == {}
    assert "reactions" not in prism.to_dict()


def test_a_scene_may_be_given_by_its_path(prism):
    by_path = cgff_cli.solve(str(PRISM))
    assert np.array_equal(by_path.coordinates, prism.coordinates)
    assert by_path.scene["path"] == str(PRISM)


def test_keywords_win_over_the_scenes_own_options_and_those_over_the_defaults():
    text = PRISM.read_text(encoding="utf-8") + "solver: {tolerance: 1e-4, seed: 7}\n"
    result = cgff_cli.solve(cgff_cli.loads(text), tolerance=1e-6)
    assert result.options == {**cgff_cli.SolveOptions().to_dict(), "tolerance": 1e-6, "seed": 7}
    assert cgff_cli.solve(cgff_cli.loads(text)).options["tolerance"] == 1e-4


def test_a_bad_option_is_refused_before_anything_is_solved():
    rows: list[dict] = []
    refusal = "cg_beta must be one of FR, PR\\+, HS, DY, TT, SP, HZ, got 'fr'"
    with pytest.raises(cgff_cli.OptionError, match=refusal):
        cgff_cli.solve(str(PRISM), cg_beta="fr", observer=rows.append)
    with pytest.raises(cgff_cli.OptionError, match="unknown solve option 'tol'"):
        cgff_cli.solve(str(PRISM), tol=1e-8, observer=rows.append)
    assert rows == []


def test_a_bad_scene_is_an_error_with_its_problems():
    with pytest.raises(cgff_cli.SceneError) as error:
        cgff_cli.solve("no-such-file.yaml")
    assert [problem.path for problem in error.value.problems] == ["no-such-file.yaml"]
    assert isinstance(error.value, cgff_cli.CgffError)


def test_arrays_and_records_hold_the_same_numbers(prism):
    assert prism.coordinates.tolist() == list(prism.nodes.values())
    columns = {"length": prism.lengths, "force": prism.forces, "strain": prism.strains, "slack": prism.slack}
    for name, column in columns.items():
        assert [element[name] for element in prism.elements] == column.tolist()
    assert prism.timing["seconds"] == prism.seconds > 0.0
