"""Families of scenes that `cgff new` writes, each with a known equilibrium.

A family is a file here, named like it, with a function `equilibrium` of keyword-only parameters that
returns an Equilibrium, and EXAMPLES of its command; and one line in FAMILIES.
"""

FAMILIES = {
    "prism": "Prism: two rings of cables twisted against each other, held apart by struts.",
    "star-prism": "Star prism: struts between two circles, each tied by a star of cables to its centre.",
    "tower": "Prism tower: stages of one hand that share their rings, braced by diagonal cables.",
    "drum": "Drum: prisms of alternating hand that share their rings.",
    "octahedron": "Expanded octahedron: six struts in three parallel pairs, 24 cables.",
    "polyhedron": "Truncated regular polyhedron: cables on its edges, struts inside.",
    "geodesic": "Geodesic sphere: a strut beside every edge of a truncated geodesic net of cables.",
    "x-tower": "Plane tower: X-modules stacked upon each other.",
    "snake": "Plane snake: X-modules in a row, straight or bent to an arc.",
    "d-bar": "Plane D-bar: a strut replaced by a diamond of struts and a cable across, again and again.",
    "t-bar": "Plane T-bar: a strut braced in its middle by a crosspiece and four cables, again and again.",
    "net": "Cable net: a saddle inside a fixed rim.",
    "geiger": "Geiger dome: rings of struts in radial planes, on hoops, inside a ring of supports.",
    "levy": "Levy dome: a Geiger dome with a triangulated net, each ring turned by half a step.",
    "kresling": "Kresling module: a polygon on creases above a fixed one, at rest in two states.",
    "catenary": "Hanging chain: links between two points, equal weights on its nodes.",
}
"""Family -> what it is, in the words its function's docstring begins with."""
