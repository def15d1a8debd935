"""The doors into a scene: from a file, from text, from Python objects."""

import gc
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from cgff_cli.errors import CgffError, Problem, SceneError
from cgff_cli.scene.fields import is_table
from cgff_cli.scene.findings import NOWHERE, Findings, Placing, Where, quoted
from cgff_cli.scene.keys import is_own
from cgff_cli.scene.located import DEPTH, Document, mark_of
from cgff_cli.scene.results import RESULT_SCHEMA, ResultValues, record_of
from cgff_cli.scene.scene import Scene
from cgff_cli.scene.schema import read_scene
from cgff_cli.scene.text import decoded, read_text, reason
from cgff_cli.scene.yaml_text import yaml_events

if TYPE_CHECKING:
    from cgff_cli.scene.json_text import JsonDocument

STDIN = "<stdin>"

NO_SCENE = (
    "this is the result of a solve, not a scene; make it one: cgff convert {} -o scene.yaml; as it is, "
    "`cgff analyse` judges it, and `cgff solve SCENE --start` begins at its shape"
)

PAPER = ("x-module", "hexagon", "prism")
"""The paper's structures, in the order of its Tables II, III and IV."""


def load(path: str | os.PathLike[str], *, results: bool = False) -> Scene:
    """Read a scene file, YAML or JSON; `-` reads standard input.

    Raises SceneError with every problem found. A file named .json must be JSON. CSV tables are
    looked for beside the scene file. results: the JSON of a result is taken too, as the scene it is of, with
    the coordinates that were found.
    """
    shown = os.fspath(path)
    try:
        if shown == "-":
            return loads(decoded(sys.stdin.buffer.read(), STDIN), STDIN, results=results)
        text = read_text(shown)
    except (OSError, ValueError) as error:
        name = STDIN if shown == "-" else shown
        raise SceneError([Problem(name, *NOWHERE, f"cannot read the scene: {reason(error)}")]) from None
    scene = loads(text, shown, os.path.dirname(shown), results=results)
    return replace(scene, files=(shown, *scene.files))


def tables_of(path: str) -> list[str]:
    """Return the CSV files that a scene names, reading none of them; none where it cannot be read itself."""
    try:
        text = read_text(path)
    except (OSError, ValueError, SceneError):
        return []
    if ".csv" not in text.lower():
        return []
    named = _named((_json(text, "") or Document(yaml_events(text))).value)
    return [os.path.join(os.path.dirname(path), name) for name in named]


def _named(value: object) -> Iterator[str]:
    """Yield the tables named in a mapping by any key but `name`, or in a mapping inside it."""
    for key, entry in value.items() if isinstance(value, dict) else ():
        if is_table(entry) and key != "name" and not is_own(key):
            yield str(entry)
        yield from _named(entry)


@contextmanager
def _collection_paused() -> Iterator[None]:
    """Pause garbage collection: a large scene makes millions of objects, none of them garbage yet."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def loads(
    text: str, path: str = "<text>", base: str | os.PathLike[str] | None = None, *, results: bool = False
) -> Scene:
    """Read a scene from text. `path` names it in messages; CSV tables are relative to `base`; see `load`.

    Raises SceneError with every problem found; `base` is the current directory unless given.
    """
    text = text.removeprefix("\ufeff")
    directory = os.fspath(base) if base is not None else ""
    with _collection_paused():
        return _read(text, path, directory, results)


def _read(text: str, path: str, base: str, results: bool) -> Scene:
    """Return the scene of a text; it is read again where what was found wrong is then seen more sharply."""
    document = _json(text, path) or Document(yaml_events(text))
    if not isinstance(document.value, dict):
        from cgff_cli.scene.foreign import how_to_use

        stranger = how_to_use(text, path)
        if stranger is not None:
            raise SceneError([Problem(path, 1, 1, stranger)])
    while True:
        findings, value, moved, answer = Findings(document.faults), document.value, _unmoved, None
        case: dict[str, Any] = {}
        schema = record_of(value)
        if schema == RESULT_SCHEMA and results:
            found = ResultValues(value)
            value, moved, answer, case = found.value, found.where, found.answer, found.case
        elif schema is not None:
            raise SceneError([Problem(path, *document.place((), False), _no_scene(schema, path))])
        scene = read_scene(findings, value, path, base) if document.whole else None
        if scene is not None and findings.none:
            place = document.place(("elements",), True)
            return replace(scene, elements_at=place, answer=answer, **case)
        if not document.sharpened(map(moved, findings.wheres)):
            raise SceneError(findings.problems(path, _placing(document.place, moved)))


def _no_scene(schema: str, path: str) -> str:
    """Return what to do with a record of cgff's where a scene is wanted."""
    if schema == RESULT_SCHEMA:
        return NO_SCENE.format("-" if path.startswith("<") else path)
    return f"this is a record of cgff, of schema {schema!r}, not a scene"


def _placing(place: Placing, moved: Callable[[Where], Where]) -> Placing:
    """Return what finds values whose place in the text is another than in the scene."""
    return lambda where, at_key: place(moved(where), at_key)


def _unmoved(where: Where) -> Where:
    return where


def from_dict(mapping: Mapping[str, Any]) -> Scene:
    """Read a scene from Python objects of the same form; numpy numbers and arrays are welcome.

    Raises SceneError with every problem found, each without a line.
    """
    findings = Findings()
    scene = read_scene(findings, _plain_values(findings, mapping), "<python>", "")
    if scene is None or not findings.none:
        raise SceneError(findings.problems("<python>", lambda where, at_key: NOWHERE))
    return scene


def _plain_values(findings: Findings, value: object, where: Where = ()) -> Any:
    """Return mappings as dicts with text keys, arrays and tuples as lists, numpy numbers as Python's.

    Raises SceneError where they are nested too deep, as a list that holds itself is.
    """
    if len(where) > DEPTH:
        raise SceneError([Problem("<python>", *NOWHERE, f"nested deeper than {DEPTH} levels")])
    if isinstance(value, np.ndarray):
        return value.tolist()
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, (list, tuple)):
        return [_plain_values(findings, item, (*where, i)) for i, item in enumerate(value)]
    if not isinstance(value, Mapping):
        return value
    result: dict[str, Any] = {}
    for key, item in value.items():
        name = str(key)
        if name in result:
            findings.add(where, f"duplicate key {quoted(name)}")
        result[name] = _plain_values(findings, item, (*where, name))
    return result


def shipped(name: str) -> str:
    """Return the path of a scene that comes with the program, such as "prism"; raises CgffError.

    An installed package holds them in its own folder `structures`, a checkout beside the package.
    """
    package = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
    folders = [os.path.join(place, "structures") for place in (package, os.path.dirname(package))]
    for folder in folders:
        path = os.path.join(folder, f"{name}.yaml")
        if os.path.isfile(path):
            return path
    raise CgffError(f"no scene {name}.yaml comes with this installation; looked in {' and '.join(folders)}")


def _json(text: str, path: str) -> "JsonDocument | None":
    """Return a text as JSON, None where it is left to the YAML reader; raises SceneError in a .json file."""
    named_so = path.lower().endswith(".json") and bool(text.strip())
    if not named_so and text.lstrip()[:1] != "{":
        return None
    from json import JSONDecodeError

    from cgff_cli.scene.json_text import JsonDocument, fault

    try:
        return JsonDocument(text)
    except JSONDecodeError as error:
        if not named_so:
            return None
        offset, message = fault(text, error)
        raise SceneError([Problem(path, *mark_of(text, offset), f"not valid JSON: {message}")]) from None
