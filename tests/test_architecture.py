"""Data flows one way: a file imports only from earlier rooms, and a room holds no circle."""

import ast
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "cgff_cli"

ROOMS = (
    "errors",
    "hints",
    "values",
    "options",
    "scene",
    "structure",
    "mechanics",
    "solvers",
    "analysis",
    "cautions",
    "result",
    "pipeline",
    "cases",
    "many",
    "as_given",
    "refusals",
    "own_lengths",
    "rest_lengths",
    "rivals",
    "study",
    "formats",
    "report",
    "cli",
    "__main__",
)

FILES = sorted(PACKAGE.rglob("*.py"))


def _module(path: Path) -> str:
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


MODULES = {_module(path): path for path in FILES}
DOOR = "cgff_cli"


def _imports(path: Path) -> Iterator[str]:
    """Yield every module of the package that a file imports, in functions and for types too."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            inside = [f"{node.module}.{alias.name}" for alias in node.names]
            names = [name if name in MODULES else str(node.module) for name in inside]
        else:
            continue
        yield from (name for name in names if name.split(".")[0] == "cgff_cli")


def _room(module: str) -> int:
    return ROOMS.index(module.split(".")[1])


def test_every_file_has_a_room_and_imports_only_from_it_or_earlier_ones():
    assert [
        f"{module} imports {imported}"
        for module, path in MODULES.items()
        for imported in _imports(path)
        if DOOR not in (module, imported) and _room(imported) > _room(module)  # all take __version__
    ] == []


def test_the_package_holds_no_circle_of_imports():
    graph = {
        module: {name for name in _imports(path) if name not in (module, DOOR)}
        for module, path in MODULES.items()
        if module != DOOR
    }
    TopologicalSorter(graph).prepare()


def test_only_the_terminal_files_know_rich_and_only_the_command_line_knows_click():
    for module, path in MODULES.items():
        tree = ast.walk(ast.parse(path.read_text()))
        names = {
            name.split(".")[0]
            for node in tree
            if isinstance(node, (ast.Import, ast.ImportFrom))
            for name in (
                [str(node.module)] if isinstance(node, ast.ImportFrom) else [a.name for a in node.names]
            )
        }
        assert "rich" not in names or module.startswith("cgff_cli.report."), module
        assert "click" not in names or module.startswith("cgff_cli.cli"), module
