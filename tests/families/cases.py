"""Scenes of every family: those whose answer is on paper, small enough to solve in a test."""

CASES = [
    ("prism", {}),
    ("prism", {"sides": 5, "strut": 3.0}),
    ("prism", {"sides": 8, "radius": 2.0, "height": 1.5}),
    ("tower", {}),
    ("tower", {"sides": 4, "stages": 2}),
    ("tower", {"stages": 5, "twist": 50.0}),
    ("drum", {}),
    ("drum", {"struts": 3, "stages": 3, "height": 1.5}),
    ("octahedron", {"strut": 7.0}),
    ("polyhedron", {"kind": "tetrahedron"}),
    ("polyhedron", {"kind": "tetrahedron", "ratio": 3.0}),
    ("polyhedron", {"kind": "cube"}),
    ("polyhedron", {"kind": "octahedron", "radius": 5.0}),
    ("polyhedron", {"kind": "dodecahedron"}),
    ("polyhedron", {"kind": "icosahedron"}),
    ("x-tower", {"stages": 4, "width": 2.0}),
    ("snake", {}),
    ("snake", {"modules": 7, "bend": 150.0}),
    ("net", {}),
    ("net", {"side": 7, "span": 3.0, "rise": 0.5, "prestress": 2.0}),
    ("catenary", {}),
    ("catenary", {"links": 21, "drop": 2.0, "sag": 4.0}),
]
IDS = [" ".join([name, *(f"{key}={value}" for key, value in given.items())]) for name, given in CASES]
