"""`cgff solve --require`: exit code 5 and a sentence where an equilibrium lacks something."""

import json
from pathlib import Path

import pytest

from cgff_cli import pipeline
from cgff_cli.analysis import equilibrium
from cgff_cli.cli import requirements
from tests.cli.conftest import Run

SPRING = """\
law: paper
nodes: {a: [0, 0], b: [1, 0]}
supports: {a: xy, b: xy}
elements:
  spring: {kind: cable, EA: 1.0, rest_length: 0, pairs: [[a, b]]}
"""
SLACK = SPRING + "  stays: {kind: cable, EA: 1.0, rest_length: [2.0, 0.9], pairs: [[a, b], [a, b]]}\n"


def required(run: Run, scene: str, words: str, *flags: str) -> tuple[int, list[str]]:
    """Return the exit code and the sentences that tell what is required."""
    ended = run("solve", scene, "-o", "out.json", "--require", words, *flags)
    return ended.exit_code, [line for line in ended.stderr.splitlines() if "required" in line]


def test_what_is_met_is_0_and_silent(run: Run):
    assert required(run, "prism.yaml", "stable, no-slack,super-stable,max-strain=0.02") == (0, [])


def test_too_much_strain_is_told_with_the_worst_elements(run: Run):
    code, (told,) = required(run, "prism.yaml", "max-strain=0.01")
    assert code == 5
    assert told.startswith(
        "cgff: prism.yaml: max-strain=0.01 is required, but 3 elements are strained by up to 0.010101: 'vert"
    )


def test_slack_elements_are_told_by_group_and_nodes(run: Run):
    Path("slack.yaml").write_text(SLACK)
    assert required(run, "slack.yaml", "no-slack") == (
        5,
        ["cgff: slack.yaml: no-slack is required, but 1 element is slack: 'stays: a-b'"],
    )


def test_every_requirement_has_a_sentence_of_its_own(run: Run, unstable: str):
    residual = ("--objective", "residual", "--tolerance", "1e-8")
    code, told = required(run, unstable, "stable,no-slack,super-stable,max-strain=0.01", *residual)
    assert code == 5
    assert [line.split(": ")[2].split()[0] for line in told] == ["stable", "super-stable", "max-strain=0.01"]
    assert "but the equilibrium is unstable: its softest motion has a stiffness of -" in told[0]


def test_flags_add_up(run: Run):
    assert required(run, "prism.yaml", "stable", "--require", "max-strain=0.001")[0] == 5
    assert required(run, "prism.yaml", "max-strain=0.001", "--require", "stable")[0] == 5


def test_stable_by_stiffness_is_not_super_stable(run: Run):
    code, (told,) = required(run, "bracket.yaml", "super-stable")
    assert code == 5
    assert told.endswith("but it is stable by the stiffness of its elements, not by its stress alone")


def test_what_was_not_computed_is_not_met(run: Run):
    code, (told,) = required(run, "prism.yaml", "stable", "--analysis", "never")
    assert code == 5
    assert told.endswith("but stability was not computed, as analysis never asks")
    assert required(run, "prism.yaml", "no-slack", "--analysis", "never") == (0, [])


def test_a_strain_that_no_element_has_is_not_met(run: Run):
    Path("spring.yaml").write_text(SPRING)
    code, (told,) = required(run, "spring.yaml", "max-strain=1")
    assert code == 5
    assert told.endswith("but no element has a rest length to be strained from")


def test_what_a_large_scene_does_without_is_computed_because_it_is_required(
    run: Run, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr(equilibrium, "MOST", 200)
    run("new", "net", "--side", "12", "-o", "net.yaml")
    assert required(run, "net.yaml", "stable")[0] == 0
    assert json.loads(Path("out.json").read_text())["analysis"]["super_stable"] is None
    assert required(run, "net.yaml", "super-stable")[0] == 0
    found = json.loads(Path("out.json").read_text())
    assert (found["options"]["analysis"], found["analysis"]["super_stable"]) == ("always", True)
    monkeypatch.setattr(requirements, "MOST_DIRECTIONS", 100)
    code, (told,) = required(run, "net.yaml", "super-stable")
    assert code == 5
    assert told.endswith("not computed: more than 3000 free directions; ask with --analysis always")


def test_not_converged_outweighs_what_is_not_met(run: Run):
    assert required(run, "prism.yaml", "max-strain=0.001", "--max-iterations", "1") == (4, [])
    ended = run("solve", "prism.yaml", "bracket.yaml", "--require", "super-stable", "--max-iterations", "3")
    assert ended.exit_code == 4


def test_one_of_many_that_lacks_something_is_5_and_all_are_written(run: Run):
    ended = run("solve", "bracket.yaml", "prism.yaml", "--require", "super-stable", "--out-dir", "out")
    assert ended.exit_code == 5
    assert sorted(path.name for path in Path("out").glob("[!.]*")) == ["bracket.json", "prism.json"]


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (
            "stabel",
            "unknown requirement 'stabel'; did you mean 'stable'? allowed: stable,no-slack,super-st",
        ),
        ("max_strain=1", "did you mean 'max-strain'?"),
        ("stable,", "unknown requirement ''; allowed: stable,no-slack,super-stable,max-strain=X"),
        ("stable=1", "stable takes no value"),
        ("max-strain", "max-strain must be a number >= 0, as in max-strain=0.02, got ''"),
        ("max-strain=2%", "got '2%'"),
        ("max-strain=nan", "got 'nan'"),
        ("max-strain=-1", "got '-1'"),
    ],
)
def test_a_bad_word_is_2_and_nothing_is_solved(
    run: Run, monkeypatch: pytest.MonkeyPatch, words: str, told: str
):
    monkeypatch.setattr(pipeline, "solve", lambda *_, **__: pytest.fail("solved"))
    ended = run("solve", "prism.yaml", "--require", words)
    assert ended.exit_code == 2
    assert told in ended.stderr
