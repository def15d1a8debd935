"""The record of a bench, schema cgff-bench/1: what measured, how, and the rows; and reading one back."""

import json
import os
from collections.abc import Iterable, Mapping
from typing import Any

from cgff_cli import TOOL
from cgff_cli.errors import OptionError
from cgff_cli.study.digest import machine
from cgff_cli.study.machine import Digested, Row

BENCH_SCHEMA = "cgff-bench/1"


def record(options: Mapping[str, Any], rows: Iterable[Row]) -> dict[str, Any]:
    """Return every field of the JSON, in the order it is written; options are those of the command line."""
    told = {"schema": BENCH_SCHEMA, "tool": dict(TOOL), "machine": machine()}
    return told | {"options": dict(options), "rows": list(rows)}


def kept(path: str, jobs: Iterable[Digested]) -> dict[str, list[Row]]:
    """Return digest -> rows of the jobs that an earlier record at a path holds; none where there is none.

    Raises OptionError where the file is something else, which must not be written over.
    """
    if not os.path.exists(path):
        return {}
    known = {job.digest for job in jobs}
    found: dict[str, list[Row]] = {}
    try:
        with open(path, encoding="utf-8") as file:
            earlier = json.load(file)
        if earlier["schema"] != BENCH_SCHEMA:
            raise KeyError("schema")
        for row in earlier["rows"]:
            if row["digest"] in known:
                found.setdefault(row["digest"], []).append(row)
    except (OSError, ValueError, KeyError, TypeError):
        raise OptionError(
            f"{path} is there and holds no {BENCH_SCHEMA}; name another file, or remove it"
        ) from None
    return found
