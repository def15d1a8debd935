"""Digests: a word for all that a row depends on, the program, the machine and the scene among it."""

import hashlib
import json
import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import cache
from typing import Any

import numpy as np

import cgff_cli
from cgff_cli.scene.scene import Scene

ONLY_TELLING = ("report", "cli")
"""Rooms that only tell what others found: their text changes no row."""


def digest_of(told: Any, parts: Iterable[bytes] = ()) -> str:
    """Return a digest of plain values, of long parts, and of the program."""
    found = hashlib.sha256(json.dumps([told, program()], sort_keys=True).encode())
    for part in parts:
        found.update(part)
    return found.hexdigest()[:16]


def file_digest(path: str) -> str | None:
    """Return a digest of a file's bytes; None where it cannot be read."""
    try:
        with open(path, "rb") as file:
            return hashlib.file_digest(file, "sha256").hexdigest()[:16]
    except OSError:
        return None


def contents(scene: Scene) -> Iterator[bytes]:
    """Yield all of a scene that an answer depends on."""
    words = (scene.name, scene.law, scene.node_names, scene.supports, scene.loads, scene.solver)
    cases = (scene.gravity, scene.load_cases, scene.combinations, scene.case)
    yield repr((words, cases)).encode()
    yield scene.coordinates.tobytes()
    for group in scene.groups:
        yield repr((group.name, group.kind, len(group.EA))).encode()
        yield group.pairs.tobytes() + group.EA.tobytes() + group.rest_length.tobytes()
        yield b"" if group.weight is None else group.weight.tobytes()


@cache
def machine() -> dict[str, Any]:
    """Return what times depend on besides the program."""
    import platform
    from importlib.metadata import version

    return {
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": version("scipy"),
        "processor": _processor(),
        "cores": os.cpu_count(),
    }


def _processor() -> str:
    """Return the processor's name; Linux tells it in a file alone."""
    import platform

    lines: list[str] = []
    with suppress(OSError), open("/proc/cpuinfo", errors="replace") as file:
        lines = file.readlines()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


@cache
def program() -> str:
    """Return version and digest of the sources that work: between versions they change."""
    found = hashlib.sha256()
    for folder, folders, names in os.walk(os.path.dirname(cgff_cli.__file__)):
        folders[:] = sorted(set(folders) - set(ONLY_TELLING))
        for name in sorted(names):
            if name.endswith(".py"):
                with open(os.path.join(folder, name), "rb") as file:
                    found.update(file.read())
    return f"{cgff_cli.__version__} {found.hexdigest()}"
