"""Whatever a file holds, it becomes a scene, or one of our errors says why not."""

from contextlib import suppress

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import cgff_cli
from cgff_cli.errors import CgffError
from tests.formats.folder import FILES

OBJ = "v 0 0 0\nv 1 0 0\nv 1 1 0.5\ng a\nl 1 2 3\no b\nl -1 1\nf 1 2 3\n"
EDGES = "start,end,group,kind,EA,rest_length\na,b,g,cable,1,2\nb,c,h,strut,1,1\n"
TEXTS = {
    "ntrt": (FILES / "3prism.yaml").read_text(),
    "ntrt, nested": (FILES / "spine.yaml").read_text(),
    "byu": (FILES / "xframe.yaml").read_text(),
    "obj": OBJ,
    "csv": EDGES,
}
BITS = [
    "",
    "-",
    "[",
    "]",
    "{",
    "}",
    ":",
    ",",
    "\n",
    " ",
    "/",
    "0",
    "-1",
    "1e999",
    "nan",
    "a",
    "*x",
    "&x ",
    "#",
    '"',
]
BITS += [
    "node_node",
    "path: 3prism.yaml",
    "null",
    "~",
    "\\",
    "\t",
    "é",
    "\x00",
    "9" * 30,
    "[a, a]",
    "l 1",
    "v",
]
CUTS = st.tuples(st.integers(0, 2000), st.integers(0, 12), st.sampled_from(BITS))


@pytest.mark.parametrize("form", TEXTS)
@given(cuts=st.lists(CUTS, min_size=1, max_size=4))
@settings(max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_a_mangled_file_is_read_or_refused_in_words(tmp_path, form, cuts):
    text = TEXTS[form]
    for place, length, bit in cuts:
        start = place % (len(text) + 1)
        text = text[:start] + bit + text[start + length :]
    read_or_refused(tmp_path, form.partition(",")[0], text.encode())


@pytest.mark.parametrize("form", ["ntrt", "byu", "obj", "csv"])
@given(data=st.one_of(st.binary(max_size=60), st.text(max_size=60).map(str.encode)))
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_bytes_are_read_or_refused_in_words(tmp_path, form, data):
    read_or_refused(tmp_path, form, data)


def read_or_refused(tmp_path, form, data):
    (tmp_path / "own").write_bytes(data)
    (tmp_path / "3prism.yaml").write_text(TEXTS["ntrt"])
    (tmp_path / "nodes.csv").write_text("name,x,y\na,0,0\nb,1,0\nc,0,1\n")
    asked = {
        "ntrt": {"strut_EA": 5.0},
        "byu": {},
        "obj": {"law": "hooke", "EA": 1.0, "kind": "cable"},
        "csv": {"law": "paper", "EA": 1.0, "kind": "cable", "nodes": str(tmp_path / "nodes.csv")},
    }
    with suppress(CgffError):
        found = cgff_cli.convert(str(tmp_path / "own"), source=form, **asked[form])
        again = cgff_cli.loads(found.written("scene"))
        assert again.coordinates.tolist() == found.scene.coordinates.tolist()
