"""Tables cut at their commas say what the csv module says, and tables that cannot be cut are left to it."""

import csv
import io

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cgff_cli.scene.csv_text import Table

CELLS = st.text(st.sampled_from('ab1.,"\n\r \t\u00e9\u2003'), max_size=4)


@settings(max_examples=500, deadline=None)
@given(rows=st.lists(st.lists(CELLS, min_size=1, max_size=4), max_size=5), quoted=st.booleans())
def test_whatever_is_cut_is_what_csv_reads(rows, quoted):
    if quoted:
        out = io.StringIO()
        csv.writer(out).writerows(rows)
        text = out.getvalue()
    else:
        text = "\n".join(map(",".join, rows))
    table = Table("table.csv", text)
    if table.cells is not None:
        parsed = list(csv.reader(io.StringIO(text, newline="")))
        assert table.header == [cell.strip() for cell in parsed[0]]
        assert table.cells == [cell for row in parsed[1:] for cell in row]
        assert table.blanks or [cell.strip() for cell in table.cells] == table.cells


def test_what_programs_write_is_cut():
    table = Table("table.csv", "name,x,y\na,0,1\nb,2,3\n")
    assert table.cells == ["a", "0", "1", "b", "2", "3"]
    assert not table.blanks
    assert Table("table.csv", "name,x,y\na,0,1").cells == ["a", "0", "1"]


@pytest.mark.parametrize(
    "text",
    [
        "name,x,y\n",
        "name,x,y",
        "name,x,y\na,0\nb,1,2,3\n",
        "name,x,y\na,0,1\n\nb,2,3\n",
        'name,x,y\n"a",0,1\n',
        "name,x,y\r\na,0,1\r\n",
        "\nname,x,y\na,0,1\n",
        "name\na\n",
        "",
    ],
)
def test_what_is_not_regular_is_left_to_csv(text):
    assert Table("table.csv", text).cells is None
