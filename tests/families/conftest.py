"""Equality of scenes, as the tests of the reader have it."""

from tests.scene.conftest import assert_same

__all__ = ["assert_same"]
