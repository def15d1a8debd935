"""House rules for the files of the package: size, documentation, no print, nothing swallowed, no assert."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "cgff_cli"
FILES = sorted(PACKAGE.rglob("*.py"))
MOST_LINES = 250
MOST_LINES_OF_A_FUNCTION = 50

Function = ast.FunctionDef | ast.AsyncFunctionDef
every_file = pytest.mark.parametrize("path", FILES, ids=[str(path.relative_to(PACKAGE)) for path in FILES])


def _nodes(path: Path, *kinds: type[ast.AST]) -> Iterator[ast.AST]:
    return (node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, kinds))


@every_file
def test_a_file_is_short(path: Path):
    assert len(path.read_text().splitlines()) <= MOST_LINES


@every_file
def test_a_function_is_short(path: Path):
    for node in _nodes(path, ast.FunctionDef, ast.AsyncFunctionDef):
        assert isinstance(node, Function)
        assert node.end_lineno is not None
        assert node.end_lineno - node.lineno < MOST_LINES_OF_A_FUNCTION, node.name


@every_file
def test_a_file_and_what_is_public_in_it_have_docstrings_that_begin_with_a_sentence(path: Path):
    tree = ast.parse(path.read_text())
    for node in (tree, *_public(tree)):
        text = ast.get_docstring(node) or ""
        name = getattr(node, "name", "the file")
        assert text.split("\n\n")[0].rstrip().endswith((".", ":", ",", ")")), f"{name}: {text!r}"


def _public(tree: ast.Module | ast.ClassDef) -> Iterator[Function | ast.ClassDef]:
    """Yield the public functions and classes of a file, and the public methods of its public classes."""
    for node in tree.body:
        if isinstance(node, (Function, ast.ClassDef)) and not node.name.startswith("_"):
            yield node
            if isinstance(node, ast.ClassDef):
                yield from _public(node)


@every_file
def test_nothing_is_printed(path: Path):
    calls = [node for node in _nodes(path, ast.Call) if isinstance(node, ast.Call)]
    assert not [call.lineno for call in calls if getattr(call.func, "id", "") in ("print", "input")]


@every_file
def test_nothing_is_caught_unnamed_or_swallowed_whole(path: Path):
    handlers = [node for node in _nodes(path, ast.ExceptHandler) if isinstance(node, ast.ExceptHandler)]
    assert not [handler.lineno for handler in handlers if handler.type is None]
    for handler in handlers:
        if getattr(handler.type, "id", "") == "BaseException":
            assert isinstance(handler.body[-1], ast.Raise), handler.lineno


@every_file
def test_nothing_is_validated_by_assert(path: Path):
    assert not [node.lineno for node in _nodes(path, ast.Assert) if isinstance(node, ast.Assert)]


@every_file
def test_no_warning_of_numpy_is_switched_off_for_the_whole_process(path: Path):
    names = {node.attr for node in _nodes(path, ast.Attribute) if isinstance(node, ast.Attribute)}
    assert not names & {"seterr", "simplefilter", "filterwarnings"}
