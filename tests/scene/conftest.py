"""Equality of scenes: arrays compare by value, and where a scene came from does not count."""

import numpy as np
import pytest


def _assert_same(one, other, but=()):
    for field in ("name", "law", "node_names", "supports", "loads", "solver"):
        if field not in but:
            assert getattr(one, field) == getattr(other, field)
    np.testing.assert_array_equal(one.coordinates, other.coordinates)
    assert [(group.name, group.kind) for group in one.groups] == [
        (group.name, group.kind) for group in other.groups
    ]
    for mine, theirs in zip(one.groups, other.groups, strict=True):
        for column in ("pairs", "EA", "rest_length"):
            np.testing.assert_array_equal(getattr(mine, column), getattr(theirs, column))


@pytest.fixture(scope="session")
def assert_same():
    return _assert_same
