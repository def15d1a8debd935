"""JSON: reads back equal, never holds NaN, one row of a table per line."""

import json
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from cgff_cli.report import columns, json_out
from cgff_cli.result import FIELDS, Result
from tests.report.conftest import MakeResult

values = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**70), 2**70) | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner, max_size=6) | st.dictionaries(st.text(), inner, max_size=6),
    max_leaves=30,
)


def _pretty(result: Result) -> str:
    return "".join(json_out.pretty(json_out.result_fields(result)))


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


@pytest.mark.parametrize("layout", [json_out.pretty, json_out.line])
def test_a_result_reads_back_equal(triangle: Result, layout: Any):
    text = "".join(layout(json_out.result_fields(triangle)))
    assert json.loads(text) == _finite(triangle.to_dict())


def test_fields_stand_in_the_order_of_the_result(triangle: Result):
    assert list(json.loads(_pretty(triangle))) == list(FIELDS)


@given(st.dictionaries(st.text(), values))
def test_any_record_reads_back_equal_in_both_layouts(record: dict[str, Any]):
    for layout in (json_out.pretty, json_out.line):
        assert json.loads("".join(layout(record.items()))) == _finite(record)


def test_one_line_is_one_line(triangle: Result):
    text = "".join(json_out.line(json_out.result_fields(triangle)))
    assert text.count("\n") == 1
    assert text.endswith("}\n")


def test_tables_have_one_row_per_line(triangle: Result):
    lines = _pretty(triangle).splitlines()
    for row in (
        *(f'"{name}": {json.dumps(column)}' for name, column in triangle.history.items()),
        *(json.dumps(element, ensure_ascii=False) for element in triangle.elements),
    ):
        assert lines.count(f"    {row},") + lines.count(f"    {row}") >= 1
    assert '    "é": ' in "\n".join(lines)


def test_numbers_read_back_as_the_same_double(altered: MakeResult):
    numbers = [0.1, 1 / 3, -0.0, 5e-324, 1.7976931348623157e308, 2.0**53 + 1]
    history = json.loads(_pretty(altered(history={"alpha": numbers})))["history"]["alpha"]
    assert [x.hex() for x in history] == [x.hex() for x in numbers]


def test_zeros_of_one_column_keep_their_signs(altered: MakeResult, triangle: Result):
    shape = np.array([[0.0, 1.0], [-0.0, 2.0], [0.0, 3.0]])
    nodes = json.loads(_pretty(altered(coordinates=shape)))["nodes"]
    assert [math.copysign(1.0, x) for x, _ in nodes.values()] == [1.0, -1.0, 1.0]


@pytest.mark.parametrize("odd", [math.nan, math.inf, -math.inf, np.float64("nan"), np.float32("inf")])
def test_what_is_no_number_is_null_anywhere(altered: MakeResult, odd: float):
    result = altered(
        analysis={"condition": odd, "modes": [1.0, odd]}, history={"alpha": [odd, odd]}, residual_max=odd
    )
    read = json.loads(_pretty(result), parse_constant=pytest.fail)
    assert read["analysis"] == {"condition": None, "modes": [1.0, None]}
    assert read["history"]["alpha"] == [None, None]
    assert read["residual"]["max"] is None


def test_what_is_no_number_is_null_in_the_long_tables(altered: MakeResult, triangle: Result):
    state = triangle.solution.mechanics.at(np.full_like(triangle.solution.state.X, math.nan))
    read = json.loads(_pretty(altered(state=state)), parse_constant=pytest.fail)
    free = triangle.structure.free[:, 0]  # what is held is a number all the same
    assert [position[0] is None for position in read["nodes"].values()] == free.tolist()
    assert [element["length"] for element in read["elements"]] == [None] * 3
    assert read["elements"][0]["rest_length"] == 0.9


def test_numpy_scalars_and_arrays_are_written_as_numbers():
    record = {
        "a": np.int64(3),
        "b": np.float64(0.5),
        "c": np.bool_(True),
        "d": np.arange(2),
        "e": np.float32(0.5),
    }
    assert "".join(json_out.line(record.items())) == '{"a": 3, "b": 0.5, "c": true, "d": [0, 1], "e": 0.5}\n'


def test_what_has_no_json_form_is_refused():
    with pytest.raises(TypeError, match="no JSON form"):
        json_out.encode({"a": object()})


def test_blocks_join_without_a_seam(triangle: Result, monkeypatch: pytest.MonkeyPatch):
    whole = _pretty(triangle)
    monkeypatch.setattr(columns, "BLOCK_ROWS", 1)
    assert _pretty(triangle) == whole


def test_the_long_tables_are_made_as_they_are_written(triangle: Result, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Result, "elements", property(lambda self: pytest.fail("built at once")))
    monkeypatch.setattr(Result, "nodes", property(lambda self: pytest.fail("built at once")))
    assert len(json.loads(_pretty(triangle))["elements"]) == 3


def test_a_table_of_elements_alone(triangle: Result):
    assert json.loads("".join(json_out.array(json_out.element_rows(triangle)))) == triangle.elements
