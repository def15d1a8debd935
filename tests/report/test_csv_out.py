"""CSV: names quoted, numbers exact, empty cells for what is no number."""

import csv
import math
from collections.abc import Iterable

import numpy as np
import pytest

from cgff_cli.report import columns, csv_out
from cgff_cli.result import Result
from tests.report.conftest import MakeResult


def _rows(chunks: Iterable[str]) -> list[list[str]]:
    return list(csv.reader("".join(chunks).splitlines()))


def test_coordinates_read_back_exactly(triangle: Result):
    header, *rows = _rows(csv_out.coordinate_table(triangle))
    assert header == ["name", "x", "y"]
    assert {name: [float(x) for x in position] for name, *position in rows} == triangle.nodes


def test_the_elements_are_the_records_of_the_result(triangle: Result):
    header, *rows = _rows(csv_out.elements(triangle))
    assert header == list(triangle.elements[0])
    expected = [
        [str(value).lower() if value in (True, False) else str(value) for value in element.values()]
        for element in triangle.elements
    ]
    assert rows == expected


def test_the_history_has_a_row_per_iteration_from_0(triangle: Result):
    header, *rows = _rows(csv_out.history(triangle))
    assert header == list(triangle.history)
    assert [int(row[0]) for row in rows] == list(range(triangle.counts["iterations"] + 1))
    assert [float(row[1]) for row in rows] == triangle.history["objective"]


def test_lines_end_as_on_unix(triangle: Result):
    text = "".join(csv_out.elements(triangle))
    assert "\r" not in text
    assert text.endswith("\n")


@pytest.mark.parametrize("odd", [None, math.nan, math.inf, np.float64("nan")])
def test_what_is_no_number_is_an_empty_cell(altered: MakeResult, odd: float | None):
    rows = _rows(csv_out.history(altered(history={"iteration": [0, 1], "alpha": [odd, 0.5]})))
    assert rows == [["iteration", "alpha"], ["0", ""], ["1", "0.5"]]


def test_numpy_scalars_are_numbers(altered: MakeResult):
    history = {"alpha": [np.float64(0.1), np.float64(0.2)], "restarted": [np.bool_(True), False]}
    assert _rows(csv_out.history(altered(history=history)))[1:] == [["0.1", "true"], ["0.2", "false"]]


def test_blocks_join_without_a_seam(triangle: Result, monkeypatch: pytest.MonkeyPatch):
    whole = "".join(csv_out.elements(triangle)), "".join(csv_out.coordinate_table(triangle))
    monkeypatch.setattr(columns, "BLOCK_ROWS", 1)
    assert ("".join(csv_out.elements(triangle)), "".join(csv_out.coordinate_table(triangle))) == whole
