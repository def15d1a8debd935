"""Problems as lines: with a place, or without one."""

from cgff_cli.errors import Problem, SceneError


def test_a_problem_without_a_place_is_told_first_and_without_one():
    error = SceneError(
        [Problem("a.yaml", 3, 1, "odd"), Problem("b.yaml", 1, 1, "odd"), Problem("a.yaml", 0, 0, "gone")]
    )
    assert str(error).splitlines() == ["a.yaml: gone", "a.yaml:3:1: odd", "b.yaml:1:1: odd"]
