"""Which shapes a symmetry maps to each other, against all renamings tried in turn."""

from itertools import permutations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cgff_cli.mechanics.state import Mechanics
from cgff_cli.structure import from_scene
from cgff_cli.study.sameness import Leeway, laid, leeway_of
from cgff_cli.study.symmetries import Symmetries
from tests.bodies import body, scene
from tests.shapes import distance_matrix

FREE = Leeway("mirrored", np.zeros(0))
NODES = 5


def by_all_renamings(bars: list[tuple[int, int, str, float, float]], X: np.ndarray, Y: np.ndarray) -> bool:
    """Return whether some renaming keeps the multiset of bars and takes all distances of X to those of Y."""
    A, B = distance_matrix(X), distance_matrix(Y)
    named = sorted((*sorted((i, j)), *rest) for i, j, *rest in bars)
    for image in map(list, permutations(range(NODES))):
        renamed = sorted((*sorted((image[i], image[j])), *rest) for i, j, *rest in bars)
        if renamed == named and np.abs(B[np.ix_(image, image)] - A).max() < 1e-9:
            return True
    return False


@st.composite
def bars_and_shapes(
    draw: st.DrawFn,
) -> tuple[list[tuple[int, int, str, float, float]], np.ndarray, np.ndarray]:
    """Draw few sorts of bars, a shape on a small grid, and it again, renamed, or another one."""
    pairs = draw(st.lists(st.sampled_from([(i, j) for i in range(NODES) for j in range(i)]), min_size=4))
    sorts = st.tuples(st.sampled_from(("cable", "strut")), st.sampled_from((1.0, 2.0)), st.just(1.0))
    bars = [(*pair, *draw(sorts)) for pair in pairs]
    spots = st.lists(st.tuples(*[st.integers(0, 1)] * 3), min_size=NODES, max_size=NODES)
    X = np.array(draw(spots), dtype=float)
    Y = X[draw(st.permutations(range(NODES)))] if draw(st.booleans()) else np.array(draw(spots), dtype=float)
    return bars, X, Y[:, [1, 2, 0]] * (-1.0, 1.0, 1.0)


@settings(deadline=None, max_examples=60)
@given(bars_and_shapes())
def test_a_symmetry_is_found_where_trying_all_renamings_finds_one(drawn: tuple):
    bars, X, Y = drawn
    assert Symmetries(body(X, bars), FREE).map(X, Y, 1.0, 1e-9) == by_all_renamings(bars, X, Y)


SQUARE = np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]])
RING = [
    (0, 1, "strut", 1.0, 2.0),
    (1, 2, "strut", 1.0, 2.0),
    (2, 3, "strut", 1.0, 2.0),
    (3, 0, "strut", 1.0, 2.0),
]
NONE = Leeway("none", np.zeros(0))


@pytest.mark.parametrize(
    ("supports", "loads", "images"),
    [
        ({}, {}, 4),
        ({0: "x", 1: "x", 2: "x", 3: "x"}, {}, 4),
        ({0: "x", 1: "x"}, {}, 2),
        ({0: "x", 2: "x"}, {}, 2),
        ({0: "x", 1: "y", 2: "x", 3: "y"}, {}, 4),
        ({0: "x", 1: "x", 2: "x", 3: "y"}, {}, 1),
        ({}, {0: (0.0, 1.0), 1: (0.0, 1.0), 2: (0.0, -1.0), 3: (0.0, -1.0)}, 4),
        ({}, {0: (0.0, 1.0), 1: (0.0, 1.0), 2: (0.0, 2.0), 3: (0.0, 2.0)}, 2),
        ({}, {0: (0.0, 1.0)}, 1),
    ],
)
def test_supports_and_loads_decide_which_corners_of_a_square_are_alike(
    supports: dict[int, str], loads: dict[int, tuple[float, float]], images: int
):
    symmetries = Symmetries(body(SQUARE, RING, supports, loads), NONE)
    corners = [SQUARE * np.where(np.arange(4) == k, 0.5, 1.0)[:, None] for k in range(4)]
    assert sum(symmetries.map(corners[0], corner, 1.0, 1e-9) for corner in corners) == images


@pytest.mark.parametrize(
    ("supports", "loads", "kind"),
    [
        ({}, {}, "mirrored"),
        ({0: "xyz"}, {}, "any"),
        ({0: "xyz", 1: "xyz"}, {}, "axis"),
        ({0: "xyz", 1: "xyz", 2: "xyz"}, {}, "none"),
        ({0: "z", 1: "z", 2: "z"}, {}, "axis"),
        ({0: "xyz"}, {0: (0.0, 0.0, -1.0)}, "any"),
    ],
)
def test_supports_leave_rotations(
    supports: dict[int, str], loads: dict[int, tuple[float, float, float]], kind: str
):
    X = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.3, 0.2, 1.0]])
    rest = distance_matrix(X)
    bars = [(i, j, "strut", 1.0, rest[i, j]) for i in range(4) for j in range(i)]
    mechanics = Mechanics(from_scene(scene(X, bars, supports, loads)))
    state = mechanics.at(mechanics.start)
    leeway = leeway_of(state, 1e-14)
    assert leeway.kind == kind
    if kind == "axis":
        along = X[1] if supports[0] == "xyz" else np.array([0.0, 0.0, 1.0])
        assert abs(leeway.axis @ along) == pytest.approx(1.0)


AXIS = np.array([0.6, 0.0, 0.8])
ABOUT_IT = Leeway("axis", AXIS)
ANY = Leeway("any", np.zeros(0))


@given(st.floats(0.1, 3.1), st.integers(0, 99))
def test_a_shape_is_laid_over_by_the_rotations_left_and_no_others(angle: float, seed: int):
    rng = np.random.default_rng(seed)
    X, K = rng.normal(size=(6, 3)), np.cross(np.eye(3), AXIS)
    about_it = np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K
    about_z = np.eye(3)
    about_z[:2, :2] = [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    moved = {"any": X @ about_z + 1.0, "axis": X @ about_it - 1.0, "mirrored": -X @ about_z, "none": X + 1.0}
    fits = {
        (own.kind, name)
        for own in (FREE, ANY, ABOUT_IT, NONE)
        for name, Y in moved.items()
        if np.abs(laid(Y, X, own) - X).max() < 1e-9
    }
    kinds = ("none", "axis", "any", "mirrored")  # each can do what those before it can
    assert fits == {(own, name) for i, own in enumerate(kinds) for name in kinds[: i + 1]}
