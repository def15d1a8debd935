"""Python objects -> the plain values a scene file would hold."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from cgff_cli.errors import Problem, SceneError
from cgff_cli.scene.findings import NOWHERE, Findings, Where, quoted
from cgff_cli.scene.located import DEPTH


def plain_values(findings: Findings, value: object, where: Where = ()) -> Any:
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
        return [plain_values(findings, item, (*where, i)) for i, item in enumerate(value)]
    if not isinstance(value, Mapping):
        return value
    result: dict[str, Any] = {}
    for key, item in value.items():
        name = str(key)
        if name in result:
            findings.add(where, f"duplicate key {quoted(name)}")
        result[name] = plain_values(findings, item, (*where, name))
    return result
