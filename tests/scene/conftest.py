"""Equality of scenes: arrays compare by value, and where a scene came from does not count."""

import numpy as np
import pytest


def _assert_same(one, other, but=()):
    more = ("gravity", "load_cases", "combinations", "own")
    for field in ("name", "law", "node_names", "supports", "loads", "solver", *more):
        if field not in but:
            assert getattr(one, field) == getattr(other, field)
    np.testing.assert_array_equal(one.coordinates, other.coordinates)
    assert [(group.name, group.kind) for group in one.groups] == [
        (group.name, group.kind) for group in other.groups
    ]
    for mine, theirs in zip(one.groups, other.groups, strict=True):
        assert mine.own == theirs.own
        for column in ("pairs", "EA", "rest_length", "pretension"):
            np.testing.assert_array_equal(getattr(mine, column), getattr(theirs, column))
        weights = [0.0 if group.weight is None else group.weight for group in (mine, theirs)]
        np.testing.assert_array_equal(*(weight + np.zeros(len(mine.EA)) for weight in weights))


@pytest.fixture(scope="session")
def assert_same():
    return _assert_same
