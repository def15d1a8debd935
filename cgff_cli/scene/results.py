"""The JSON of a result, read as the scene that was solved, its coordinates the answer."""

from typing import Any

from cgff_cli.scene.findings import Where

RESULT_SCHEMA = "cgff-result/1"

_COLUMNS = ("EA", "rest_length")
_MOVED = {"name": ("scene", "name"), "law": ("scene", "law"), "solver": ("options",)}


def is_result(value: object) -> bool:
    """Tell whether plain values are those of a result."""
    return isinstance(value, dict) and value.get("schema") == RESULT_SCHEMA


def record_of(value: object) -> str | None:
    """Return the schema of plain values that are another record of cgff's, or one of another version."""
    schema = value.get("schema") if isinstance(value, dict) else None
    return schema if isinstance(schema, str) and schema.startswith("cgff-") else None


class ResultValues:
    """A result's values in the form of a scene's, and where each of those stands in the result.

    value  : what `read_scene` takes; supports and loads as solved, and of the options the tolerance
    answer : how that solve went, its verdict and its history
    case   : the load case that it was solved in, and where that began, by the names of a scene's fields
    """

    def __init__(self, value: dict[str, Any]):
        records = value.get("elements")
        self._rows: dict[str, list[int]] = {}
        if isinstance(records, list) and all(isinstance(record, dict) for record in records):
            for row, record in enumerate(records):
                self._rows.setdefault(str(record.get("group")), []).append(row)
            records = {name: _group([records[row] for row in rows]) for name, rows in self._rows.items()}
        scene, options = _mapping(value, "scene"), _mapping(value, "options")
        told = {
            "name": scene.get("name"),
            "law": scene.get("law"),
            "nodes": value.get("nodes"),
            "elements": records,
            "supports": value.get("supports"),
            "loads": value.get("loads"),
            "solver": {name: options[name] for name in ("tolerance",) if name in options},
        }
        told_of = {name: scene.get(name) for name in ("case", "begins")}
        self.case = {name: own if _is_line(own) else "" for name, own in told_of.items()}
        self.value = {name: own for name, own in told.items() if own is not None}
        self.answer = {name: value.get(name) for name in ("verdict", "history")}

    def where(self, where: Where) -> Where:
        """Return where in the result a value of the scene stands."""
        first, *rest = where or ("",)
        if first != "elements":
            return (*_MOVED.get(str(first), (first,)), *rest)
        if not rest or str(rest[0]) not in self._rows:
            return where
        rows = self._rows[str(rest[0])]
        key, index, *end = (*rest[1:], 0, 0)[:3] if len(rest) > 1 else ("", 0)
        place: Where = ("elements", rows[index] if isinstance(index, int) and index < len(rows) else rows[0])
        if key == "pairs":
            return (*place, "end" if end and end[0] == 1 else "start")
        return (*place, str(key)) if key else place


def _group(records: list[dict[str, Any]]) -> dict[str, Any]:
    return {
        "kind": records[0].get("kind"),
        **{key: [record.get(key) for record in records] for key in _COLUMNS},
        "pairs": [[record.get("start"), record.get("end")] for record in records],
    }


def _mapping(value: dict[str, Any], key: str) -> dict[str, Any]:
    own = value.get(key)
    return own if isinstance(own, dict) else {}


def _is_line(value: object) -> bool:
    return isinstance(value, str) and value.isprintable()
