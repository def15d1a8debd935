"""Results to write: one solved, and the same with other contents."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from cgff_cli import loads, solve
from cgff_cli.result import Result
from cgff_cli.solvers.solution import Solution

TRIANGLE = """\
name: triangle
law: paper
nodes: {a: [0, 0], "b, \\"c\\"": [1, 0], é: [0, 2]}
elements:
  cables: {kind: cable, EA: [10.0, 11.0], rest_length: 0.9, pairs: [[a, "b, \\"c\\""], ["b, \\"c\\"", é]]}
  struts: {kind: strut, EA: 20.0, rest_length: [1.1], pairs: [[é, a]]}
supports: {a: xy, é: x}
loads: {"b, \\"c\\"": [0.25, 0.125]}
"""

MakeResult = Callable[..., Result]


def _changed(solution: Solution, changes: dict[str, Any]) -> Solution:
    """Return a solution with other fields, or other values of what it works out."""
    own = {name: value for name, value in changes.items() if name in Solution.__dataclass_fields__}
    made = {name: property(lambda self, value=changes[name]: value) for name in changes if name not in own}
    changed = replace(solution, **own)
    object.__setattr__(changed, "__class__", type("Changed", (Solution,), made))
    return changed


@pytest.fixture(scope="session")
def triangle() -> Result:
    """Return a small solved scene whose names need quoting and whose supports carry something."""
    return solve(loads(TRIANGLE))


@pytest.fixture
def altered(triangle: Result) -> MakeResult:
    """Return the same result with other fields of its solution or another analysis."""

    def make(analysis: dict[str, Any] | None = None, name: str = "triangle", **changes: Any) -> Result:
        return replace(
            triangle,
            source=replace(triangle.source, name=name),
            solution=_changed(triangle.solution, changes),
            found=triangle.analysis if analysis is None else analysis,
        )

    return make
