"""House rules for the package: size, documentation, no name twice. ruff holds the others."""

import ast
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "cgff_cli"
FILES = {str(path.relative_to(PACKAGE)): path.read_text() for path in sorted(PACKAGE.rglob("*.py"))}
TREES = {name: ast.parse(text) for name, text in FILES.items()}
MOST_LINES = 250
MOST_LINES_OF_A_FUNCTION = 50

BUDGET = {
    "top": 1942,
    "analysis": 2446,
    "cli": 3047,
    "formats": 1549,
    "mechanics": 966,
    "report": 2631,
    "rivals": 1126,
    "scene": 4690,
    "solvers": 2471,
    "study": 3217,
}
"""Most lines of each room, a folder of the package; `top` is the files beside them. More is a decision."""

EVERY_FILE_OF_ITS_KIND = {"command", "equilibrium", "EXAMPLES", "form_find"}
"""What the commands, the families and the methods each have in a file of their own."""

MOST_TUNED = 25
"""Numbers in the solvers other than these: each is to be chosen, defended and understood."""
PLAIN_NUMBERS = {0, 1, 2, 0.5}

Function = ast.FunctionDef | ast.AsyncFunctionDef


def _nodes(*kinds: type[ast.AST]) -> Iterator[tuple[str, ast.AST]]:
    """Yield the nodes of some kinds in all files, each with its place."""
    for name, tree in TREES.items():
        yield from (
            (f"{name}:{getattr(node, 'lineno', 1)}", node)
            for node in ast.walk(tree)
            if isinstance(node, kinds)
        )


def _public(tree: ast.Module | ast.ClassDef) -> Iterator[Function | ast.ClassDef]:
    """Yield the public functions and classes of a file, and the public methods of its public classes."""
    for node in tree.body:
        if isinstance(node, (Function, ast.ClassDef)) and not node.name.startswith("_"):
            yield node
            if isinstance(node, ast.ClassDef):
                yield from _public(node)


def _top_level_names(tree: ast.Module) -> Iterator[str]:
    for node in tree.body:
        if isinstance(node, (Function, ast.ClassDef)):
            yield node.name
        elif isinstance(node, ast.Assign):
            yield from (target.id for target in node.targets if isinstance(target, ast.Name))
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            yield node.target.id


def test_a_file_is_short():
    lines = {name: len(text.splitlines()) for name, text in FILES.items()}
    assert {name: count for name, count in lines.items() if count > MOST_LINES} == {}


def test_a_room_keeps_its_budget():
    lines: Counter[str] = Counter()
    for name, text in FILES.items():
        lines[name.partition("/")[0] if "/" in name else "top"] += len(text.splitlines())
    assert {room: count for room, count in lines.items() if count > BUDGET.get(room, 0)} == {}


def test_the_solvers_have_few_tuned_numbers():
    numbers = [
        f"{place}: {node.value}"
        for place, node in _nodes(ast.Constant)
        if place.startswith("solvers/")
        and type(node.value) in (int, float)
        and node.value not in PLAIN_NUMBERS
    ]
    assert len(numbers) <= MOST_TUNED, "\n".join(numbers)


def test_a_function_is_short():
    lengths = {
        f"{place} {node.name}": node.end_lineno - node.lineno
        for place, node in _nodes(Function)
        if isinstance(node, Function) and node.end_lineno
    }
    assert {name: length for name, length in lengths.items() if length >= MOST_LINES_OF_A_FUNCTION} == {}


def test_every_docstring_of_a_file_and_of_what_is_public_in_it_begins_with_a_sentence():
    documented = [(name, node) for name, tree in TREES.items() for node in (tree, *_public(tree))]
    firsts = {
        f"{name}: {getattr(node, 'name', 'the file')}": (ast.get_docstring(node) or "").split("\n\n")[0]
        for name, node in documented
    }
    sentences = (".", ":", ",", ")")
    assert {name: text for name, text in firsts.items() if not text.rstrip().endswith(sentences)} == {}


def test_what_catches_everything_raises_it_again():
    assert [
        place
        for place, node in _nodes(ast.ExceptHandler)
        if isinstance(node, ast.ExceptHandler)
        and getattr(node.type, "id", "") == "BaseException"
        and not isinstance(node.body[-1], ast.Raise)
    ] == []


def test_no_warning_of_numpy_is_switched_off_for_the_whole_process():
    switches = {"seterr", "simplefilter", "filterwarnings"}
    assert [place for place, node in _nodes(ast.Attribute) if getattr(node, "attr", "") in switches] == []


def test_a_public_name_is_defined_in_one_file_only():
    homes = defaultdict(list)
    for name, tree in TREES.items():
        for defined in set(_top_level_names(tree)):
            if not defined.startswith("_") and defined not in EVERY_FILE_OF_ITS_KIND:
                homes[defined].append(name)
    assert {defined: files for defined, files in homes.items() if len(files) > 1} == {}
