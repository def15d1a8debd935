"""Suites as data: what a case may say, the scene that comes of it, and where a mistake stands."""

from pathlib import Path

import numpy as np
import pytest

import cgff_cli
from cgff_cli.study.bench import jobs_of
from cgff_cli.study.case import agrees, as_expected, built
from cgff_cli.study.suite import cases_of, standard
from tests.shapes import STRUCTURES, solve_structure

INLINE = """\
- id: strut
  scene: {law: paper, nodes: {1: [0, 0], b: [1, 0.5]},
          elements: {s: {kind: strut, EA: 1e2, rest_length: 1, pairs: [[1, b]]}}, flatten: [1, 0]}
  options: {tolerance: 1e-8, objective: residual, repeat: 2, time_limit: 0.5}
  expect: {outcome: balanced-stable}
  source: closed form
"""


@pytest.fixture
def suite(tmp_path: Path):
    """Write a suite and return its cases."""

    def read(text: str) -> list:
        path = tmp_path / "own.yaml"
        path.write_text(text)
        return cases_of([str(path)])

    return read


def test_a_case_is_a_scene_with_options_and_what_must_come_of_it(suite):
    (case,) = suite(INLINE)
    assert (case.id, case.suite, case.notes) == ("strut", "own", {"source": "closed form"})
    assert case.options == {"tolerance": 1e-8, "objective": "residual", "repeat": 2, "time_limit": 0.5}
    assert case.expect == {"outcome": "balanced-stable"}
    scene = built(case)
    assert scene.name == "strut"
    assert scene.node_names == ("1", "b")
    assert scene.coordinates.tolist() == [[0.0, 0.0], [1.0, 0.0]]


def test_scenes_come_from_the_program_from_families_and_from_files_beside_the_suite(suite, tmp_path: Path):
    (tmp_path / "mine.yaml").write_text((STRUCTURES / "bracket.yaml").read_text())
    shipped, family, file = map(
        built,
        suite(
            "- {id: a, scene: {structure: prism}}\n"
            "- {id: b, scene: {family: tower, parameters: {stages: 2, law: paper}}}\n"
            "- {id: c, scene: {file: mine.yaml}}\n"
        ),
    )
    assert shipped.name == "Triangular prism, Table IV"
    assert (family.coordinates == cgff_cli.new("tower", stages=2, law="paper").coordinates).all()
    assert file.path == str(tmp_path / "mine.yaml")


def test_changes_are_made_in_the_order_written(suite):
    one, other = map(
        built,
        suite(
            "- {id: a, scene: {structure: prism, offset: [1, 0, 0], flatten: [2, 1, 1]}}\n"
            "- {id: b, scene: {structure: prism, flatten: [2, 1, 1], offset: [1, 0, 0]}}\n"
        ),
    )
    assert np.allclose(one.coordinates - other.coordinates, [1.0, 0.0, 0.0])


def test_a_scene_by_itself_is_a_case_of_no_suite():
    (case,) = cases_of([str(STRUCTURES / "prism.yaml")])
    assert (case.id, case.suite) == ("prism", None)
    assert len(built(case).node_names) == 6


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("- {scene: {structure: prism}}", 1, "[0]: missing key 'id'"),
        ("- {id: a}", 1, "[0]: missing key 'scene'"),
        ("- prism", 1, "[0]: must be a mapping with id and scene, got prism"),
        ("- {id: [a], scene: {structure: prism}}", 1, "[0].id: must be a word, got a list of 1"),
        (
            "- {id: a, scene: {structure: prism}, option: {}}",
            1,
            "unknown key 'option'; did you mean 'options'?",
        ),
        ("- id: a\n  scene: {structure: prism, flaten: [1, 1, 0]}", 2, "did you mean 'flatten'?"),
        ("- id: a\n  scene: {structure: prism, family: net}", 2, "one source, here structure and family"),
        (
            "- id: a\n  scene: {structure: prism}\n  options: {tolerance: 2}",
            3,
            "must be a number between 0 and 1",
        ),
        ("- id: a\n  scene: {structure: prism}\n  options: {repeat: 0.5}", 3, "must be a whole number > 0"),
        ("- id: a\n  sceen: {structure: prism}", 2, "did you mean 'scene'?"),
        ("- id: a\n  scene: {structure: prism}\n  options: {toleranc: 1}", 3, "did you mean 'tolerance'?"),
        ("- id: a\n  scene: {structure: prism}\n  expect: {outcome: stable}", 3, "must be one of refused, "),
        ("- {id: a, scene: {structure: prism}, expect: {slack: two}}", 1, "must be a whole number >= 0, got"),
        ("- {id: a, scene: {structure: prism}, expect: {warns: [a]}}", 1, "must be one value, got a list"),
        (
            "- {id: a, scene: {structure: prism}}\n- {id: a, scene: {structure: prism}}",
            2,
            "a is there already",
        ),
        ("- {id: a, scene: {structure: prism}, id: b}", 1, "duplicate key 'id'"),
    ],
)
def test_a_mistake_in_a_suite_is_told_with_its_place(suite, text: str, line: int, words: str):
    with pytest.raises(cgff_cli.SceneError) as caught:
        suite(text)
    (problem,) = caught.value.problems
    assert problem.line == line
    assert words in problem.message


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ("{structure: pyramid}", "case a: no scene pyramid.yaml comes with this installation"),
        ("{family: towr}", "case a: unknown family 'towr'; did you mean 'tower'?"),
        ("{family: tower, parameters: {stages: 0}}", "case a: stages must be a whole number from 1"),
        ("{family: tower, parameters: [3]}", "case a: no family can be made of 'tower' [3]: "),
        ("{chain: {links: 3}}", "case a: no chain can be made of {'links': 3}: "),
        ("{structure: prism, units: [0, 1]}", "case a: units cannot be [0, 1]: "),
        ("{structure: prism, offset: [1e999, 0, 0]}", "makes numbers that no scene may have"),
        ("{structure: prism, flatten: [1, 1]}", "case a: flatten cannot be [1, 1]: "),
        (
            "{structure: prism, stiffen: {strut: 2}}",
            "case a: stiffen cannot be {'strut': 2}: the scene has no",
        ),
        ("{file: nowhere.yaml}", "cannot read the scene: no such file"),
        ("{law: paper, nodes: {a: [0, 0]}}", "missing key 'elements'"),
    ],
)
def test_a_scene_that_cannot_be_built_is_told_before_anything_is_measured(suite, scene: str, words: str):
    cases = suite(f"- id: a\n  scene: {scene}\n- {{id: b, scene: {{family: nothing}}}}")
    with pytest.raises(cgff_cli.SceneError) as caught:
        jobs_of(cases, ["lm"], {})
    assert words in str(caught.value)
    assert "case b: unknown family 'nothing'" in str(caught.value)


def test_mistakes_inside_a_scene_written_out_have_their_own_place(suite):
    (case,) = suite(INLINE.replace("EA: 1e2", "EA: -1"))
    with pytest.raises(cgff_cli.SceneError, match=r"own.yaml:3:\d+: elements.s.EA: must be > 0, got -1"):
        built(case)


def test_two_suites_of_one_name_may_not_share_a_case(tmp_path: Path):
    for folder in ("one", "other"):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "own.yaml").write_text(INLINE)
    paths = [str(tmp_path / folder / "own.yaml") for folder in ("one", "other")]
    with pytest.raises(cgff_cli.SceneError, match=r"case strut: there is one of this name in .*one/own.yaml"):
        cases_of(paths)


def test_the_digest_changes_with_all_that_is_measured_and_with_nothing_else(suite):
    def digest(text: str, methods: tuple[str, ...] = ("lm",), **options: object) -> str:
        return jobs_of(suite(text), methods, options)[0].digest

    own = digest(INLINE)
    assert digest(INLINE.replace("source: closed form", "source: on paper")) == own
    assert digest(INLINE, ("lm", "cgff")) == own
    changed = [
        digest(INLINE.replace("EA: 1e2", "EA: 2e2")),
        digest(INLINE.replace("flatten: [1, 0]", "flatten: [2, 0]")),
        digest(INLINE.replace("repeat: 2", "repeat: 3")),
        digest(INLINE.replace("balanced-stable", "converged-stable")),
        digest(INLINE, ("lm", "dr")),
        digest(INLINE, tolerance=1e-9),
    ]
    assert len({own, *changed}) == 7


def test_the_suite_that_comes_with_the_program_can_be_built_in_full():
    cases = cases_of([standard()])
    jobs = jobs_of(cases, ["all"], {})
    sizes = {job.case.id: len(job.scene.node_names) for job in jobs if job.scene}
    own = [nodes for name, nodes in sizes.items() if name.startswith("structures/")]
    assert own == [6, 12, 45, 93, 896, 3003]
    families = {name.split("/")[0] for name in sizes} - {"structures"}
    assert all(sum(name.startswith(f"{family}/") for name in sizes) == 3 for family in families)


@pytest.mark.parametrize(
    ("word", "expected", "fits"),
    [
        ("converged-stable", "balanced-stable", True),
        ("floor-stable", "balanced-stable", True),
        ("floor-stable", "converged-stable", False),
        ("converged-neutral", "balanced-stable", False),
        ("max_iterations", "max_iterations", True),
    ],
)
def test_an_outcome_is_that_expected_or_not(word: str, expected: str, fits: bool):
    assert agrees(word, expected) is fits


def test_slack_cables_and_warnings_are_part_of_what_is_expected():
    result = solve_structure("prism")
    assert as_expected(result, {}) is None
    assert as_expected(result, {"outcome": "balanced-stable", "slack": 0}) is True
    assert as_expected(result, {"outcome": "balanced-stable", "slack": 1}) is False
    assert as_expected(result, {"outcome": "balanced-stable", "warns": "zero length"}) is False
    assert as_expected(result, {"outcome": "balanced-neutral"}) is False
