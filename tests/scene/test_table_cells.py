"""Tables hold the cells that the csv module reads, and know where each of them stands."""

import csv
import io

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cgff_cli.scene.tables import Table

CELLS = st.text(st.sampled_from('ab1.,"\n\r \t\u00e9\u2003'), max_size=4)


def blank(row):
    return not row or (len(row) == 1 and not row[0].strip())


@settings(max_examples=500, deadline=None)
@given(rows=st.lists(st.lists(CELLS, min_size=1, max_size=4), max_size=5), quoted=st.booleans())
def test_whatever_is_read_is_what_csv_reads(rows, quoted):
    if quoted:
        out = io.StringIO()
        csv.writer(out).writerows(rows)
        text = out.getvalue()
    else:
        text = "\n".join(map(",".join, rows))
    table = Table(text)
    if table.findings.none:
        parsed = [row for row in csv.reader(io.StringIO(text, newline="")) if not blank(row)]
        assert table.header == [cell.strip() for cell in (parsed or [[]])[0]]
        assert table.count == max(len(parsed) - 1, 0)
        if not table.ragged:
            assert table.cells == [cell for row in parsed[1:] for cell in row]
            for name in dict.fromkeys(table.header):
                column = table.column(name).values
                assert column == [row[table.header.index(name)].strip() for row in parsed[1:]]


@pytest.mark.parametrize(
    "text",
    [
        "name,x,y\na,0,1\nb,2,3\n",
        "name,x,y\na,0,1\nb,2,3",
        "name,x,y\r\na,0,1\r\nb,2,3\r\n",
        "\n \nname,x,y\n\na,0,1\n\n\nb,2,3\n",
        '"name","x","y"\n"a","0","1"\n"b","2","3"\n',
    ],
)
def test_every_layout_holds_the_same_cells_and_their_places(text):
    table = Table(text)
    assert table.header == ["name", "x", "y"]
    assert table.cells == ["a", "0", "1", "b", "2", "3"]
    for name in table.header:
        column = table.column(name)
        for row, cell in enumerate(column.values):
            line, first = table.place(column.where(row))
            assert text.splitlines()[line - 1][first - 1 :].strip('"').startswith(cell)


def test_a_table_without_rows_has_no_cells():
    for text in ("", "\n", "name,x,y", "name,x,y\n"):
        assert Table(text).cells == []
        assert Table(text).count == 0


def test_a_row_of_another_width_is_evened_out_and_kept_in_mind():
    table = Table("name,x,y\na,0\nb,1,2,3\nc,4,5\n")
    assert table.cells == ["a", "0", "", "b", "1", "2", "c", "4", "5"]
    assert table.ragged == {0: 2, 1: 4}
